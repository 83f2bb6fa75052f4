"""Read Stage's world files as Stage does: the robots, their poses, and the pose of the floor plan.

All files that a world names are looked for from the folder of the world's own file, then in those of STAGEPATH. Of
several definitions of a name the first one counts. A number ends where C's atof ends it.
"""
import itertools
import math
import os
import re
from typing import NamedTuple

from . import neighbours

_OF_NUMBERS = re.compile(r'[-+.0-9eE]+')
_NUMBER = re.compile(r'[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?')
_TOKEN = re.compile(r'#[^\n]*|"([^"\n]*)"|([()\[\]])|([A-Za-z][\w.-]*(?:\[\d+\][\w.-]*)+|[^\s()\[\]"#]+)')
_LARGEST = 1 << 22  # characters
_MOST_INCLUDED = 50
_MOST_ROBOTS = 1000
_DEEPEST = 50  # parts within parts
_MOST_PARTS = 100000
_LENGTHS = {'cm': 0.01, 'mm': 0.001}  # m; other words mean m
#: Stage's own models that are not robots. Another model that no file defines may be of a file that is not here
_BUILT_IN = ('model', 'window', 'speech_bubble', 'ranger', 'laser', 'fiducial', 'blobfinder', 'gripper', 'actuator',
             'camera', 'bumper', 'wifi', 'lightindicator', 'blinkenlight', 'block', 'sensor', 'loadcell', 'indicator')

_EXACT = 1e-9  # of a quarter turn


class Unknown(Exception):
    """It cannot be known where the map's frame lies. The text says why."""


class World(NamedTuple):
    """The content of a world file.

    ``robots``: ((name, (x, y, yaw)), ...) [m, m, rad], in Stage's world, in the order in which stage_ros numbers them;
    None in the place of a pose that no numbers give.
    ``floor``: the Floor of the floor plan, or None. ``bodies``: the Body of each robot. ``interval``: of Stage's steps
    [s].
    """

    robots: tuple
    floor: object
    bodies: tuple = ()
    interval: float = 0.1


class Body(NamedTuple):
    """What a world file says of a robot besides its place, with Stage's values where it says nothing.

    ``size``: (length, width) [m], with its centre at ``centre`` (x, y) [m]; ``is_omni``: whether it drives sideways.
    ``bounds``: (least, largest) of x, y [m/s] and of turning [rad/s]. ``origin``: that of its odometry, a pose in
    Stage's world, or None: its start. ``odom_error``: Stage's [x, y, z, a], or None. ``lasers``: a Laser each.
    """

    size: tuple = (0.4, 0.4)
    centre: tuple = (0.0, 0.0)
    is_omni: bool = False
    bounds: tuple = ((-1.0, 1.0), (-1.0, 1.0), (-math.pi / 2, math.pi / 2))
    origin: object = None
    odom_error: object = None
    lasers: tuple = ()


class Laser(NamedTuple):
    """A laser: its pose on the robot [m, m, rad], angles [rad], number of beams, ranges [m], height [m] in tf."""

    pose: tuple
    first: float
    last: float
    beams: int
    nearest: float
    farthest: float
    height: float


class Floor(NamedTuple):
    """A model with an image: its centre [m], yaw [rad], size [m] and the path of the image."""

    x: float
    y: float
    yaw: float
    width: float
    height: float
    image: str


class _Model:
    """A model as it is written: the name on which it is based, {key: words}, and the models within it."""

    def __init__(self, base):
        self.base = base
        self.values = {}
        self.parts = []


def is_world(path):
    """Return whether a file is one of Stage's worlds, by its name."""
    return path.endswith('.world')


def read(path):
    """Return the World of a world file. :raises OSError, ValueError: if it cannot be read."""
    words = _words(path, os.path.dirname(os.path.abspath(path)), [0])
    world, defined, at = _Model(''), {}, 0
    while at < len(words):
        if words[at].group() == 'define' and at + 3 < len(words):
            model, after = _model(words, at + 2)
            defined.setdefault(_text(words[at + 1]), model)
            at = after
        else:
            at = _entry(world, words, at, 0)
    stage = _Stage(defined, world.values)
    robots = tuple(itertools.islice((robot for model in world.parts for robot in stage.robots(model)),
                                    _MOST_ROBOTS + 1))
    if len(robots) > _MOST_ROBOTS:
        raise ValueError('{}: got more than {} robots; allowed: up to {}'.format(path, _MOST_ROBOTS, _MOST_ROBOTS))
    interval = _finite(_first(world.values, 'interval_sim'), 100.0) / 1000.0
    return World(tuple(robot[:2] for robot in robots), stage.floor(world.parts, os.path.dirname(os.path.abspath(path))),
                 tuple(body for _name, _pose, body in robots), interval if interval > 0.0 else 0.1)


class _Stage:
    """What Stage makes of the models of a world. ``defined``: {name: _Model}; ``values``: those of the world itself."""

    def __init__(self, defined, values):
        self._defined = defined
        self._metre = _LENGTHS.get(_first(values, 'unit_length'), 1.0)
        self._radians = float if _first(values, 'unit_angle') == 'radians' else math.radians
        self._left = _MOST_PARTS

    def robots(self, model, around=(0.0, 0.0, 0.0), depth=0):
        """Yield (name, pose, Body) of a model that is a robot and of those in it. ``around``: the pose around it."""
        self._left -= 1
        if depth > _DEEPEST or not self._left:
            raise ValueError('parts lie within one another more than {} times, or are more than {}'.format(
                _DEEPEST, _MOST_PARTS))
        kind, values, parts = self._resolved(model)
        pose = around and self._pose(values)
        if pose:
            x, y = turned(*pose[:2], around[2])
            pose = around[0] + x, around[1] + y, around[2] + pose[2]
        if kind == 'position' or not depth and kind not in _BUILT_IN and 'pose' in values and 'bitmap' not in values:
            yield _first(values, 'name'), pose, self._body(values, parts)
        for part in parts:
            yield from self.robots(part, pose, depth + 1)

    def _body(self, values, parts):
        length, width, height = self._numbers(values, 'size', (0.4, 0.4, 1.0))
        centre = self._numbers(values, 'origin', (0.0, 0.0))
        bounds = self._numbers(values, 'velocity_bounds', (-1.0, 1.0) * 3)
        turning = tuple(self._angle(word, one) for word, one in zip(
            [*values.get('velocity_bounds', [])[6:], '', ''], Body().bounds[2]))
        errors = tuple(_finite(word, one) for word, one in zip(
            [*values.get('odom_error', []), *[''] * 4], (0.03, 0.03, 0.0, 0.05)))
        is_wrong = _first(values, 'localization') == 'odom' and any(errors)
        rangers = [found for found in map(self._resolved, parts) if found[0] in ('ranger', 'laser')]
        return Body((length, width), centre, _first(values, 'drive') == 'omni', (bounds[:2], bounds[2:4], turning),
                    self._pose(values, 'localization_origin') if values.get('localization_origin') else None,
                    errors if is_wrong else None,
                    tuple(self._laser(height, values, parts) for _kind, values, parts in rangers))

    def _laser(self, height, values, parts):
        """Return the Laser of a ranger's values and parts; it stands on the robot, ``height`` [m] above its base."""
        x, y, yaw = self._pose(values) or (0.0, 0.0, 0.0)
        sensor = next((found[1] for found in map(self._resolved, parts) if found[0] == 'sensor'), values)
        within = sensor is not values and self._pose(sensor) or (0.0, 0.0, 0.0)
        dx, dy = turned(*within[:2], yaw)
        fov = self._angle(_first(sensor, 'fov'), 0.1)
        beams = max(1, int(_finite(_first(sensor, 'samples'), 1.0)))
        farthest, = self._numbers(sensor, 'range_max', (5.0,))
        nearest, farthest = self._numbers(sensor, 'range', (0.0, farthest))
        height += self._metre * _finite(_four(values.get('pose', []))[2], 0.0)
        return Laser((x + dx, y + dy, yaw + within[2]), -fov / 2 if beams > 1 else 0.0, fov / 2 if beams > 1 else 0.0,
                     beams, max(0.0, nearest), farthest, height)

    def _angle(self, word, default):
        found = _number(word)
        return self._radians(found) if math.isfinite(found) else default

    def _numbers(self, values, key, default):
        """Return as many lengths [m] as the ``default`` has, which stands for those that no numbers give."""
        words = values.get(key, [])
        return tuple(self._metre * _finite(word, one / self._metre) for word, one in zip(
            [*words, *[''] * len(default)], default))

    def floor(self, models, folder):
        """Return the Floor of the first model with an image and a size, or None."""
        for kind, values, _parts in map(self._resolved, models):
            if kind != 'position' and values.get('bitmap') and 'size' in values:
                pose, inner, size = self._pose(values), self._pose(values, 'origin'), self._pose(values, 'size')
                if pose and inner and size:
                    # Stage's ``origin`` is the position of the model's centre, as seen from its pose
                    x, y = turned(*inner[:2], pose[2])
                    return Floor(pose[0] + x, pose[1] + y, pose[2] + inner[2], *size[:2],
                                 neighbours.elsewhere(os.path.join(folder, values['bitmap'][0])))
        return None

    def _resolved(self, model):
        """Return (Stage's own model on which a model is based, its values, its parts)."""
        chain = [model]
        while self._defined.get(chain[-1].base, model) not in chain:
            chain.append(self._defined[chain[-1].base])
        values, parts = {}, []
        for one in reversed(chain):
            values.update(one.values)
            parts += one.parts
        return chain[-1].base, values, parts

    def _pose(self, values, key='pose'):
        """Return (x [m], y [m], yaw [rad]), or None. The yaw is the last of three or four numbers."""
        words = _four(values.get(key, []))
        pose = self._metre * _number(words[0]), self._metre * _number(words[1]), self._radians(_number(words[3]))
        return pose if all(map(math.isfinite, pose)) else None


def turned(x, y, yaw):
    """Return (x, y) turned by yaw [rad]. Quarter turns are exact."""
    quarters = yaw / (math.pi / 2)
    if abs(quarters - round(quarters)) < _EXACT:
        cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[round(quarters) % 4]
    else:
        cosine, sine = math.cos(yaw), math.sin(yaw)
    return cosine * x - sine * y, sine * x + cosine * y


def _words(path, folder, count):
    """Return the matches of _TOKEN in a file, with those of the files that it includes in the place of their names."""
    count[0] += 1
    if count[0] > _MOST_INCLUDED:
        raise ValueError('{}: more than {} files are included'.format(path, _MOST_INCLUDED))
    found = []
    for one in _TOKEN.finditer(_text_of(path)):
        if one.group().startswith('#'):
            continue
        if found and found[-1].group() == 'include':
            del found[-1]
            others = filter(None, os.environ.get('STAGEPATH', '').split(':'))
            names = [neighbours.elsewhere(os.path.join(folder, _text(one))),
                     *(os.path.join(other, os.path.basename(_text(one))) for other in others)]
            included = next(filter(os.path.isfile, names), None)
            found += _words(included, folder, count) if included else []
        else:
            found.append(one)
    return found


def _text_of(path):
    if os.path.exists(path) and not os.path.isfile(path):  # a pipe would never end
        raise ValueError('{}: is not a regular file'.format(path))
    with open(path, encoding='utf-8', errors='replace') as stream:
        text = stream.read(_LARGEST + 1)
    if len(text) > _LARGEST:
        raise ValueError('{}: allowed: up to {} characters'.format(path, _LARGEST))
    return text


def _model(words, at, depth=0):
    """Return (the model that begins at the word number ``at``, the number of the word after it)."""
    if depth > _DEEPEST:
        raise ValueError('parts lie within one another more than {} times'.format(_DEEPEST))
    model = _Model(words[at].group())
    at += 2
    while at < len(words) and words[at].group() != ')':
        at = _entry(model, words, at, depth)
    return model, at + 1


def _entry(model, words, at, depth):
    """Add the part or the value that begins at the word number ``at`` to a model; return the number after it."""
    key = words[at].group()
    following = words[at + 1].group() if at + 1 < len(words) else ''
    if following == '(':
        part, at = _model(words, at, depth + 1)
        model.parts.append(part)
        return at
    if following == '[':
        end = next((k for k in range(at, len(words)) if words[k].group() == ']'), len(words))
        model.values[key] = [_text(one) for one in words[at + 2:end]]
        return end + 1
    model.values[key] = [_text(words[at + 1])] if following else []
    return at + 2


def _text(found):
    return found.group() if found.group(1) is None else found.group(1)


def _four(words):
    """Return the words of a pose: x, y, z, yaw."""
    return [*words[:2], '0', words[2]] if len(words) == 3 else [*words, *'0000'][:4]


def _first(values, key):
    return next(iter(values.get(key, [])), '')


def _finite(word, default):
    found = _number(word)
    return found if math.isfinite(found) else default


def _number(word):
    """Return the number with which a word of digits begins, as C's atof does; nan for words that are no number."""
    if not _OF_NUMBERS.fullmatch(word):
        return math.nan
    found = _NUMBER.match(word)
    return float(found.group()) if found else 0.0
