"""Find the places of robots in a launch file, whichever program they are meant for. Each is a Hint."""
import math
import os
import re
import shlex
from typing import NamedTuple

from rosgraph.names import ns_join

from move_base_abstract.common.kinds import as_number

from . import kinds, neighbours, worlds

LOCALIZER, STAGE, SPAWNED, FRAME, DRIVER = 'localizer', 'Stage', 'spawned', 'frame', 'driver'
_AXES = {'x': 0, 'y': 1, 'yaw': 2, 'a': 2, 'theta': 2, 'th': 2}
_BESIDE_AXES = {'initial', 'init', 'pose', 'pos', 'position', 'start', 'robot', 'spawn', 'origin', 'coord', 'model',
                'location', 'point', 'loc', ''}
_NAMES = ('robot_namespace', 'robot_name', 'ns', 'namespace', 'tf_prefix', 'name', 'model_name', 'robot', 'prefix',
          'model', 'robot_id')
_INITIAL = re.compile(r'(.*/)([^/]*?)initial_pose[_/](x|y|a|yaw)')
_DELTAS = ('delta_x', 'delta_y', 'delta_yaw')
_FLAGS = {'-x': 0, '-y': 1, '-Y': 2}


class Hint(NamedTuple):
    """One place of a robot that a launch file gives.

    ``source``: LOCALIZER (a pose in the map's frame), STAGE (in Stage's world), SPAWNED (in Gazebo's world), FRAME (the
    pose of the odometry frame in the map's frame), DRIVER (no place: a driver of a robot). ``pose``: (x, y, yaw) [m, m,
    rad]. ``names``: possible names of the robot. ``is_robot``: whether it is certainly a robot, and not a thing.
    ``who``: the part of the file that gives the
    place; ``place``: where that part is in the file. ``in_world``: whether it is a pose in a simulator's world, and not
    in a robot's map, if these differ. ``node``: the spawner or driver, a roslaunch Node; ``body``: the worlds.Body of a
    robot of Stage.
    """

    source: str
    pose: tuple
    namespace: str
    names: frozenset
    who: str
    place: str = ''
    is_robot: bool = True
    in_world: bool = False
    node: object = None
    body: object = None

    @property
    def shown(self):
        """The hint in words."""
        place = ' ({})'.format(self.place) if self.place else ''
        return '({:g}, {:g}, {:g}) of {}{}'.format(*self.pose, self.who, place)


class Stage(NamedTuple):
    """A node that is Stage, with the path of its ``world`` file.

    ``offset``: (x, y, yaw) [m, m, rad] of the map's frame in its world, or None if it is not known. ``why``: the source
    of the offset, or the reason why it is not known. ``interval``: of its steps [s].
    """

    node: object
    world: str
    offset: object
    why: str
    interval: float = 0.1


def hints(config):
    """Return (Hints, Stages) of a roslaunch configuration, in the order of its files."""
    found = [*_of_parameters(config)]
    stages = []
    for node in config.nodes:
        kind = kinds.kind_of(node.package, node.type)
        if kind.word == kinds.FRAME:
            found += _of_frame(node)
        elif node.package in ('stage_ros', 'stage') or node.type == 'stageros':
            more, stage = _of_stage(config, node)
            found += more
            stages.append(stage)
        elif (node.package, node.type) in kinds.DRIVERS:
            found.append(Hint(DRIVER, (0.0, 0.0, 0.0), absolute(node.namespace), tokens(node.namespace),
                              'the driver {}'.format(name_of(node)), node.filename or '', node=node))
        elif kind.word == kinds.LEFT_OUT and (not kind.is_guess or 'spawn' in node.type):
            found += _of_spawner(node)
    for one in getattr(config, 'missing', ()):
        if one.kind == 'include':
            found += _of_include(one)
    return found, stages


def is_of_place(key):
    """Return whether a parameter with this full name is part of a Hint."""
    return _INITIAL.fullmatch(key) is not None or key.rpartition('/')[2] in _DELTAS


def _of_parameters(config):
    """Yield the Hints for localizers: parameters whose names end in initial_pose_x, _y, _a, in any namespace."""
    nodes = {name_of(node): node for node in config.nodes}
    found = {}
    for key, param in config.params.items():
        parts = _INITIAL.fullmatch(key)
        value = number_of(param.value)
        if parts and value is not None:
            found.setdefault((parts.group(1), parts.group(2)), [0.0] * 3)[_AXES[parts.group(3)]] = value
    for (above, prefix), pose in found.items():
        owner = above.rstrip('/') or '/'
        node = nodes.get(owner)
        namespace = owner.rpartition('/')[0] + '/' if node else owner
        names = tokens(owner, prefix, owner.rpartition('/')[2].replace('amcl', '').strip('_'))
        yield Hint(LOCALIZER, tuple(pose), absolute(namespace), names, '{}{}initial_pose_*'.format(above, prefix),
                   node and node.filename or '', in_world=node is not None and not kinds.is_localizer(node.package))


def _of_spawner(node):
    words = words_of(node.args)
    pose, is_there = _flags(words)
    if not is_there and not re.search('spawn', node.type):
        return
    named = [after for word, after in zip(words, words[1:]) if word in ('-model', '-robot_namespace', '-entity')]
    namespace = next((after for word, after in zip(words, words[1:]) if word == '-robot_namespace'), node.namespace)
    yield Hint(SPAWNED, pose, absolute(namespace), tokens(node.namespace, *named, node.name or ''),
               'the spawner {}'.format(name_of(node)), node.filename or '',
               _is_robot(words) and not any(map(kinds.is_thing, [*named, node.name or ''])), in_world=True, node=node)


def _is_robot(words):
    """Return whether a spawner's arguments are for a robot: its model is a parameter, in URDF, or has a namespace."""
    return '-robot_namespace' in words or (
        '-param' in words and '-sdf' not in words and any('robot' in word for word in words))


def frame_of(node):
    """Return (parent, child, (x, y, yaw) of the child in the parent [m, m, rad]) of a static publisher, or None."""
    words = words_of(node.args)
    numbers = [number_of(word) for word in words[:7]]
    if len(words) < 8 or None in numbers[:6]:
        return None
    is_quaternion = numbers[6] is not None and len(words) >= 9
    yaw = 2 * math.atan2(numbers[5], numbers[6]) if is_quaternion else numbers[3]
    parent, child = (words[7:9] if is_quaternion else words[6:8])
    return parent.strip('/'), child.strip('/'), (numbers[0], numbers[1], yaw)


def static_frames(config):
    """Return {child: (parent, pose of the child in the parent)} of the file's static publishers of frames."""
    found = [frame_of(node) for node in config.nodes if kinds.kind_of(node.package, node.type).word == kinds.FRAME]
    return {child: (parent, pose) for parent, child, pose in filter(None, found)}


def _of_frame(node):
    parent, child, pose = frame_of(node) or ('', '', ())
    if parent.endswith('map') and 'odom' in child:
        yield Hint(FRAME, pose, node.namespace, tokens(node.namespace, child, node.name),
                   'the frame {} of {}'.format(child, name_of(node)), node.filename or '')


def _of_stage(config, node):
    words = words_of(node.args)
    path = neighbours.elsewhere(next((word for word in reversed(words) if not word.startswith('-')), ''))
    place = node.filename or ''
    try:
        world = worlds.read(path)
    except (OSError, ValueError) as error:
        why = '{}: {}'.format(path, error.strerror) if isinstance(error, OSError) and error.strerror else error
        return [], Stage(node, path, None, 'the world file cannot be read: {}'.format(why))
    by_names = '-u' in words
    offset, why = _offset(config, world)
    if offset is None and _delta(config) is not None:
        offset, why = _delta(config), 'by delta_* of fake_localization'
    found = []
    for number, ((name, pose), body) in enumerate(zip(world.robots, world.bodies)):
        if pose is None:
            continue
        called = name if by_names and name else 'robot_{}'.format(number)
        is_alone = len(world.robots) == 1 and not by_names
        namespace = node.namespace if is_alone else ns_join(node.namespace, called)
        names = tokens(node.namespace, called, name) if not is_alone else tokens(node.namespace, name)
        found.append(Hint(STAGE, pose, absolute(namespace), names,
                          "{} in Stage's world {}".format(called, os.path.basename(path)), place, node=node, body=body))
    return found, Stage(node, path, offset, why, world.interval)


def _offset(config, world):
    maps = [words_of(node.args) for node in config.nodes if kinds.kind_of(node.package, node.type).word == kinds.MAP]
    if not any(maps):
        return None, 'the launch file serves no map'
    from . import floors  # it needs numpy and Pillow, and few launch files need it
    try:
        return floors.offset(world.floor, next(filter(None, maps))), 'by floor plan and map'
    except worlds.Unknown as error:
        return None, str(error)


def _delta(config):
    """Return (x, y, yaw) of the map's frame in Stage's world by the parameters of fake_localization, or None."""
    for node in config.nodes:
        if node.package == 'fake_localization':
            values = [config.params.get('{}/{}'.format(name_of(node), delta)) for delta in _DELTAS]
            x, y, yaw = (0.0 if value is None else number_of(value.value) or 0.0 for value in values)
            if x or y or yaw:
                return (*worlds.turned(x, y, yaw), yaw)
    return None


def _of_include(one):
    """Yield the Hint in the arguments of an include whose file is not here, if there is one."""
    pose, is_there = [0.0] * 3, False
    for name, text in one.arguments:
        words = name.lower().split('_')
        axis = [word for word in words if word in _AXES]
        if len(axis) == 1 and number_of(text) is not None and {re.sub(r'\d+$', '', word) for word in words
                                                             if word not in _AXES} <= _BESIDE_AXES:
            pose[_AXES[axis[0]]], is_there = number_of(text), True
        elif '-x' in text.split() or '-y' in text.split():
            flags, is_there = _flags(words_of(text))
            pose[:] = flags
    if is_there:
        base = os.path.basename(one.name)
        named = [text for name, text in one.arguments if name in _NAMES]
        source = LOCALIZER if 'amcl' in base or any('initial' in name for name, _ in one.arguments) else SPAWNED
        namespace = absolute(named[0]) if named and one.namespace == '/' else one.namespace
        yield Hint(source, tuple(pose), absolute(namespace), tokens(one.namespace, *named),
                   'the arguments for {}'.format(base), one.place, in_world=source == SPAWNED)


def _flags(words):
    """Return (pose, whether there is one) of a spawner's arguments -x, -y and -Y."""
    pose, is_there = [0.0] * 3, False
    for word, after in zip(words, words[1:]):
        if word in _FLAGS and number_of(after) is not None:
            pose[_FLAGS[word]], is_there = number_of(after), True
    return tuple(pose), is_there


def words_of(text):
    """Return the words of a node's arguments as a shell splits them. If a shell could not, split at white space."""
    try:
        return shlex.split(text or '')
    except ValueError:
        return (text or '').split()


def number_of(value):
    """Return the finite number that a value is, or None."""
    if isinstance(value, bool):
        return None
    try:
        found = as_number(value)
    except (TypeError, ValueError, OverflowError):
        return None
    return found if math.isfinite(found) else None


def tokens(*texts):
    """Return possible names of a robot in ``texts``, in lower case: each text, and its parts between slashes."""
    found = set()
    for text in texts:
        whole = (text or '').strip('/ ').lower()
        found |= {whole, *whole.split('/')}
    return frozenset(found - {'', 'map', 'odom', 'amcl', 'robot', 'base_link', 'base_footprint'})


def absolute(namespace):
    """Return a namespace with a slash before and after it."""
    return '/' + '{}/'.format((namespace or '').strip('/')).lstrip('/')


def name_of(node):
    """Return the full name of a roslaunch Node."""
    return ns_join(node.namespace, node.name or node.type)
