"""Read Stage's world files: the robots, their poses, and the pose of the floor plan."""
import math
import os
import re
from typing import NamedTuple

from move_base_abstract.common.kinds import as_number

_TOKEN = re.compile(r'#[^\n]*|"([^"\n]*)"|([()\[\]])|([^\s()\[\]"#]+)')
_LARGEST = 1 << 22  # characters
_MOST_INCLUDED = 50
_MOST_ROBOTS = 1000
_DEEPEST = 50  # parts within parts
#: Stage's own models that are not robots. Another model that no file defines may be of a file that is not here
_BUILT_IN = ('model', 'window', 'speech_bubble', 'ranger', 'laser', 'fiducial', 'blobfinder', 'gripper', 'actuator',
             'camera', 'bumper', 'wifi', 'lightindicator', 'blinkenlight', 'block', 'sensor', 'loadcell', 'indicator')

_EXACT = 1e-9  # of a quarter turn


class Unknown(Exception):
    """It cannot be known where the map's frame lies. The text says why."""


class World(NamedTuple):
    """The content of a world file.

    ``robots``: ((name, (x, y, yaw)), ...) [m, m, rad], in Stage's world, in the order in which stage_ros numbers them.
    ``floor``: the Floor of the floor plan, or None.
    """

    robots: tuple
    floor: object


class Floor(NamedTuple):
    """A model with an image: its centre [m], yaw [rad], size [m] and the path of the image."""

    x: float
    y: float
    yaw: float
    width: float
    height: float
    image: str


class _Model:
    def __init__(self, base):
        self.base = base
        self.values = {}
        self.folder = ''


def read(path):
    """Return the World of a world file. :raises OSError, ValueError: if it cannot be read."""
    defined, models = {}, []
    _parse(path, defined, models, [0])
    robots, floor = [], None
    for model in models:
        kind, values, folder = _resolved(model, defined)
        if kind == 'position' or kind not in _BUILT_IN and 'pose' in values and 'bitmap' not in values:
            robots.append((_first(values, 'name'), _pose(values)))
        elif floor is None and values.get('bitmap') and 'size' in values:
            floor = _floor(values, folder)
    if len(robots) > _MOST_ROBOTS:
        raise ValueError('{}: got {} robots; allowed: up to {}'.format(path, len(robots), _MOST_ROBOTS))
    return World(tuple(robots), floor)


def turned(x, y, yaw):
    """Return (x, y) turned by yaw [rad]. Quarter turns are exact."""
    quarters = yaw / (math.pi / 2)
    if abs(quarters - round(quarters)) < _EXACT:
        cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[round(quarters) % 4]
    else:
        cosine, sine = math.cos(yaw), math.sin(yaw)
    return cosine * x - sine * y, sine * x + cosine * y


def _floor(values, folder):
    """Return the Floor of a model. Stage's ``origin`` is the position of the model's centre, as seen from its pose."""
    x, y, yaw = _pose(values)
    in_x, in_y, turn = _pose({'pose': values.get('origin', [])})
    in_x, in_y = turned(in_x, in_y, yaw)
    width, height = (*_numbers(values['size']), 0.0, 0.0)[:2]
    return Floor(x + in_x, y + in_y, yaw + turn, width, height, os.path.join(folder, values['bitmap'][0]))


def _parse(path, defined, models, count):
    count[0] += 1
    if count[0] > _MOST_INCLUDED:
        raise ValueError('{}: more than {} files are included'.format(path, _MOST_INCLUDED))
    words = [found for found in _TOKEN.finditer(_text_of(path)) if not found.group().startswith('#')]
    folder, at = os.path.dirname(os.path.abspath(path)), 0
    while at < len(words):
        word = words[at].group()
        after = _text(words[at + 1]) if at + 1 < len(words) else ''
        if word == 'include':
            included = os.path.join(folder, after)
            if os.path.isfile(included):
                _parse(included, defined, models, count)
            at += 2
        elif word == 'define' and at + 3 < len(words):
            model, at = _model(words, at + 2, folder)
            defined[after] = model
        elif after == '(':
            model, at = _model(words, at, folder)
            models.append(model)
        else:
            at += 1


def _text_of(path):
    if os.path.exists(path) and not os.path.isfile(path):  # a pipe would never end
        raise ValueError('{}: is not a regular file'.format(path))
    with open(path, encoding='utf-8', errors='replace') as stream:
        text = stream.read(_LARGEST + 1)
    if len(text) > _LARGEST:
        raise ValueError('{}: allowed: up to {} characters'.format(path, _LARGEST))
    return text


def _model(words, at, folder, depth=0):
    """Return (the model that begins at the word number ``at``, the number of the word after it)."""
    if depth > _DEEPEST:
        raise ValueError('parts lie within one another more than {} times'.format(_DEEPEST))
    model = _Model(words[at].group())
    model.folder = folder
    at += 2
    while at < len(words) and words[at].group() != ')':
        key = words[at].group()
        following = words[at + 1].group() if at + 1 < len(words) else ''
        if following == '(':
            _child, at = _model(words, at, folder, depth + 1)  # a part of it: a ranger, a gripper
        elif following == '[':
            end = next((k for k in range(at, len(words)) if words[k].group() == ']'), len(words))
            model.values[key] = [_text(one) for one in words[at + 2:end]]
            at = end + 1
        else:
            model.values[key] = [_text(words[at + 1])] if following else []
            at += 2
    return model, at + 1


def _text(found):
    return found.group() if found.group(1) is None else found.group(1)


def _resolved(model, defined):
    """Return (the model of Stage on which a model is based, its values, the folder of its image)."""
    chain = [model]
    while chain[-1].base in defined and defined[chain[-1].base] not in chain:
        chain.append(defined[chain[-1].base])
    values, folder = {}, model.folder
    for one in reversed(chain):
        values.update(one.values)
        folder = one.folder if 'bitmap' in one.values else folder
    return chain[-1].base, values, folder


def _pose(values):
    """Return (x [m], y [m], yaw [rad]). Stage gives the yaw in degrees, as the last of three or four numbers."""
    found = _numbers(values.get('pose', []))
    found = [*found, *[0.0] * (4 - len(found))] if len(found) != 3 else [*found[:2], 0.0, found[2]]
    return found[0], found[1], math.radians(found[3])


def _first(values, key):
    return next(iter(values.get(key, [])), '')


def _numbers(words):
    try:
        found = [as_number(word) for word in words]
    except ValueError:
        found = [math.nan]
    if not all(map(math.isfinite, found)):
        raise ValueError('got {}; allowed: finite numbers'.format(' '.join(words)))
    return found
