"""Find the robots of a launch file, and which of its places belongs to which robot."""
import math
import os
import re
from typing import NamedTuple

from rosgraph.names import ns_join

from ..loopback import PACKAGE
from . import drivers, kinds, poses, worlds

OWN = ('move_base', 'move_base_abstract_actionserver', drivers.NODE)
_FAR = 0.05  # m: the user is told of places that differ by more
_NAME = re.compile('(?:/[A-Za-z0-9_]+)+')


class Robot(NamedTuple):
    """A robot: the full ``name`` of its move_base, its ``namespace``, and its possible ``names``.

    ``added``: why it gets a move_base although the file starts none, or ''. ``place``: where it is in the file.
    ``frame``: its map's frame, if robots have different ones; ``map_pose``: the pose of that frame in Gazebo's world,
    (x, y, yaw) [m, m, rad], by the static frames of the file. ``hint``: of the robot that a velocity robot stands for.
    """

    name: str
    namespace: str
    names: frozenset
    added: str = ''
    place: str = ''
    frame: str = ''
    map_pose: tuple = ()
    hint: object = None

    @property
    def has_name(self):
        """Whether ROS accepts the name."""
        return _NAME.fullmatch(self.name) is not None

    @property
    def is_driven(self):
        """Whether it is added as a robot that is driven by velocities."""
        return bool(self.added) and self.name.endswith('/' + drivers.NODE)


class Start(NamedTuple):
    """The start of a robot: its ``pose``, (x, y, yaw) [m, m, rad] in the map's frame, and the ``hint`` that gives it.

    ``hint`` is None if the file gives no place. ``others``: ((hint, pose), ...) of hints that give another place.
    ``by_order``: whether the hint belongs to this robot only by the order in the file.
    """

    robot: Robot
    hint: object
    pose: tuple
    others: tuple
    by_order: bool


def robots_of(config, hints, asked=(), keeps_navigation=False):
    """Return the Robots of a configuration, in the order of its nodes, and those that need a move_base.

    A robot needs one if a launch file that is not here would start it, by its name. If no robot is found so, each robot
    of the ``hints`` is driven by velocities. ``asked``: full names of robots that are added, since the user asks for
    it. ``keeps_navigation``: the file's own move_base stays, and all robots are driven by velocities.
    """
    if keeps_navigation:
        return _with_maps(config, _told_apart(_driven(hints) or [
            _new(node.namespace, 'it is driven by {}'.format(poses.name_of(node)), node.filename or '', drivers.NODE)
            for node in config.nodes if _is_robot(node)]))
    nodes = [node for node in config.nodes if _is_robot(node)]
    found = [Robot(poses.name_of(node), node.namespace, _names(config, node), place=node.filename or '')
             for node in nodes] + [_new(poses.absolute(name.rpartition('/')[0]), '', '--add')._replace(name=name)
                                   for name in asked]
    known = {one.namespace for one in found}
    for one in getattr(config, 'missing', ()):
        if one.kind == 'include' and kinds.stands_for_a_robot(one.name):
            namespace = _namespace_of(one)
            if namespace not in known:
                known.add(namespace)
                found.append(_new(namespace, '{} is not here, and by its name it starts one'.format(
                    os.path.basename(one.name)), one.place))
    found = found or _driven(hints)
    return _with_maps(config, _told_apart(found))


def _driven(hints):
    """Return a velocity robot for each robot that a simulator would have had, or else a driver, or a localizer."""
    found = _of_robots(hints)
    simulated = [hint for hint in found if hint.source != poses.LOCALIZER]
    robots = {}
    for hint in sorted(simulated or found, key=lambda hint: hint.source == poses.DRIVER):
        robots.setdefault(hint.namespace, _new(
            hint.namespace, 'it is driven by velocities: {}'.format(hint.who), hint.place,
            drivers.NODE)._replace(hint=hint))
    return list(robots.values())


def _with_maps(config, robots):
    """Return the robots with the places of their maps, if they have different ones: each SLAM begins its own."""
    keys = ['{}/global_costmap/global_frame'.format(robot.name) for robot in robots]
    frames = [str(config.params[key].value).strip('/') if key in config.params else 'map' for key in keys]
    if len(set(frames)) < 2:
        return robots
    known = poses.static_frames(config)
    return [robot._replace(frame=frame, map_pose=_in_outermost(frame, known)) for robot, frame in zip(robots, frames)]


def _in_outermost(frame, known):
    """Return the pose of a frame in the outermost one above it. ``known``: {child: (parent, pose)}."""
    x, y, yaw = 0.0, 0.0, 0.0
    for _count in range(len(known)):  # frames may be above one another in a circle
        if frame not in known:
            break
        frame, of_frame = known[frame]
        x, y = worlds.turned(x, y, of_frame[2])
        x, y, yaw = x + of_frame[0], y + of_frame[1], yaw + of_frame[2]
    return x, y, yaw


def _of_robots(hints):
    """Return the hints that stand for robots. A localizer without a namespace does not, if robots have namespaces."""
    found = [hint for hint in hints if hint.is_robot and hint.source != poses.FRAME]
    are_apart = any(hint.namespace != '/' and hint.source != poses.LOCALIZER for hint in found)
    return [hint for hint in found if hint.source != poses.LOCALIZER or hint.namespace != '/' or not are_apart]


def _is_robot(node):
    return kinds.kind_of(node.package, node.type).word == kinds.ROBOT or node.package == PACKAGE and node.type in OWN


def _new(namespace, why, place, kind=OWN[0]):
    return Robot(ns_join(namespace, kind), namespace, poses.tokens(namespace), why, place)


def _namespace_of(include):
    named = [text for name, text in include.arguments if name in ('robot_namespace', 'ns', 'namespace', 'robot_name')]
    return poses.absolute(named[0] if include.namespace == '/' and named else include.namespace)


def _names(config, node):
    name = poses.name_of(node)
    values = [config.params[key].value for key in (name + '/tf_prefix', node.namespace + 'tf_prefix')
              if key in config.params]
    frames = [config.params[key].value for costmap in ('global_costmap', 'local_costmap')
              for key in ['{}/{}/robot_base_frame'.format(name, costmap)] if key in config.params]
    prefixes = [str(frame).rpartition('/')[0] for frame in frames]
    targets = [new.strip('/').partition('/')[0] for _old, new in node.remap_args if '/' in new.strip('/')]
    own = (node.name or '').replace('move_base', '').strip('_')
    return poses.tokens(node.namespace, own, *map(str, values), *prefixes, *targets)


def _told_apart(robots):
    """Return the robots without the names that several of them have."""
    names = [name for robot in robots for name in robot.names]
    return [robot._replace(names=frozenset(name for name in robot.names if names.count(name) == 1))
            for robot in robots]


def starts_of(robots, hints, stages):
    """Return ([Start of each robot], [hints that belong to no robot])."""
    whose, by_order = {}, set()
    for source in (poses.LOCALIZER, poses.STAGE, poses.SPAWNED, poses.FRAME):
        of_source = [hint for hint in hints if hint.source == source]
        known, guessed = _assigned(robots, of_source)
        whose.update({**known, **guessed})
        by_order |= set(guessed)
    seconds = [hint for hint in hints if hint not in whose and hint.is_robot and hint.source not in (
        poses.FRAME, poses.DRIVER)]
    whose.update((hint, robot.name) for hint in seconds for robot in reversed(robots) if _is_named(robot, hint))
    in_order = [*(hint for hint in hints if hint not in seconds), *seconds]
    found = [_start(robot, [hint for hint in in_order if whose.get(hint) == robot.name], stages, by_order)
             for robot in robots]
    offset = _offset(stages)
    return found, [hint for hint in seconds if hint not in whose and not any(
        start.hint is not None and not _differ(in_map(hint, offset, start.robot), start.pose) for start in found)]


def _is_named(robot, hint):
    """Return whether a hint says which robot it is for."""
    return robot.namespace == hint.namespace != '/' or bool(robot.names & hint.names)


def _assigned(robots, hints):
    """Assign the hints of one source; return ({hint: name of its robot} by namespace or name, the same by order)."""
    found = {}
    for robot in robots:
        best = max((_score(robot, hint, len(robots)) for hint in hints), default=0)
        fitting = [hint for hint in hints if _score(robot, hint, len(robots)) == best and hint not in found]
        if best and (len(fitting) == 1 or best > 1 and fitting):
            found[fitting[0]] = robot.name
    taken = set(found.values())
    robots_left = [robot for robot in robots if robot.name not in taken]
    hints_left = [hint for hint in hints if hint not in found and hint.is_robot]
    is_plain = len(robots_left) == len(hints_left)
    return found, dict(zip(hints_left, (robot.name for robot in robots_left))) if is_plain else {}


def _score(robot, hint, count):
    if robot.namespace == hint.namespace and (robot.namespace != '/' or count == 1):
        return 3 + hint.is_robot
    if robot.names & hint.names:
        return 2
    return 1 if count == 1 and hint.is_robot else 0


def _start(robot, hints, stages, by_order):
    offset = _offset(stages)
    by_source = {hint.source: hint for hint in reversed(hints)}
    stage, localizer = by_source.get(poses.STAGE), by_source.get(poses.LOCALIZER)
    simulated = [stage, by_source.get(poses.SPAWNED)] if robot.is_driven else []
    order = [*simulated, stage if offset else None, localizer if localizer and any(localizer.pose) else None, stage,
             by_source.get(poses.SPAWNED), localizer, by_source.get(poses.FRAME)]
    chosen = next((hint for hint in order if hint is not None), None)
    if chosen is None:
        return Start(robot, None, (0.0, 0.0, 0.0), (), False)
    pose = in_map(chosen, offset, robot)
    others = [(hint, in_map(hint, offset, robot)) for hint in hints if hint is not chosen and not (
        robot.is_driven and chosen in simulated)]  # where the simulator has it, whatever a localizer guesses
    return Start(robot, chosen, pose, tuple(one for one in others if _differ(one[1], pose)), chosen in by_order)


def _offset(stages):
    return next((stage.offset for stage in stages if stage.offset is not None), None)


def in_map(hint, offset, robot):
    """Return the pose of a hint in a robot's map frame. ``offset``: that frame's pose in Stage's world, or None."""
    x, y, yaw = hint.pose
    offset = offset if hint.source == poses.STAGE else robot.map_pose if hint.in_world else None
    if offset and any(offset):
        x, y = worlds.turned(x - offset[0], y - offset[1], -offset[2])
        x, y, yaw = round(x, 9) + 0.0, round(y, 9) + 0.0, math.remainder(yaw - offset[2], 2 * math.pi)
    return x, y, yaw


def _differ(one, other):
    return max(abs(a - b) for a, b in zip(one[:2], other[:2])) > _FAR
