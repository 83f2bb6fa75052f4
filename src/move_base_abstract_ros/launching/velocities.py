"""Give the robots of an adopted launch file that are driven by velocities what their simulator would have given them.

``adoption`` is the object that applies the rules of :mod:`.adoption`.
"""
import os
import re
import shlex
from dataclasses import replace

from move_base_abstract.common.errors import ConfigurationError

from ..adopting import drivers, kinds, poses, served
from ..loopback import PACKAGE
from . import given, programs, roles, start_poses

FLEET = 'velocity_robots'
_WALLS = '/stage_walls'  # the namespace of the map_server of a floor plan of Stage
_BASES = ('base_footprint', 'base_link')
_NAME = re.compile('[A-Za-z][A-Za-z0-9_]*')
_ASKS = ((b'/gazebo/', 'names topics or services of Gazebo (/gazebo/...), which nobody has here'),
         (b'MoveBaseAction', 'has goals for a move_base, and the robots here are driven by velocities: '
                             '--add NAMESPACE/move_base={}/move_base adds one'.format(PACKAGE)))


def driven(adoption):
    """Return the Robots that are added as velocity robots, and not left out by the user."""
    return [robot for robot in adoption.robots if robot.is_driven and robot.name not in adoption.options.leave_out]


def tells_place(adoption):
    """Return whether velocity robots say where they are in the map: a localizer is left out, and no SLAM stays."""
    nodes = [node for node in adoption.config.nodes if roles.name_of(node) not in adoption.options.leave_out]
    reasons = [kinds.kind_of(node.package, node.type).why for node in nodes
               if not adoption.is_kept(node) and roles.program_of(node) is not None]
    out = [node for node in nodes if kinds.is_localizer(node.package) and not adoption.is_kept(node)
           and not (adoption.options.real_navigation and roles.program_of(node) is not None)]
    return bool(out) and kinds.SENSES not in reasons


def prepare(adoption, kept):
    """Add the velocity robots, each with the parameters and topics of what drove it. ``kept``: nodes that stay."""
    values, place = adoption.values(), tells_place(adoption)
    for robot in driven(adoption):
        drive = drivers.drive_of(adoption.config, robot.hint, adoption.stages) if robot.hint else drivers.Drive(
            {}, {}, ['nothing in the file says what it is'])
        params = {**drive.params, 'publish_map_frame': place, 'initialpose_moves': False}
        if params.get('robot_base_frame') in _BASES and not any(
                node.namespace in (robot.namespace, '/') and kinds.kind_of(node.package, node.type).word == kinds.STATE
                for node in kept):
            del params['robot_base_frame']  # the robot has both bases, as nobody else publishes one below the other
        prefix = _prefix_of(robot, values)
        if prefix:
            params['tf_prefix'] = prefix
            params.update({'slash_in_headers': True} if _is_of_stage(robot) else {})
        walls = _walls_of(adoption, robot, kept, place)
        params.update({'use_map': True, 'map_topic': walls} if walls else {})
        adoption.param.update((robot.name + '/' + key, value) for key, value in params.items())
        remaps = ['{}{}:={}'.format(robot.namespace, ours, _absolute(robot, topic))
                  for ours, topic in drive.topics.items()]
        adoption.added[robot.name] = ' '.join(['{}/{}'.format(PACKAGE, drivers.NODE), *map(shlex.quote, remaps)])
        for remark in drive.remarks:
            adoption.remarks.append('{}: {} ({})'.format(robot.name, remark, robot.place))
    _say_asking(adoption, kept)
    _plan_once(adoption, kept)
    adoption.remarks += ["{} is taken for Stage's world, because the path that the file names is not here ({})".format(
        stage.world, stage.node.filename or '') for stage in adoption.stages
        if driven(adoption) and stage.world not in poses.words_of(stage.node.args)]


def _is_of_stage(robot):
    return robot.hint is not None and robot.hint.source == poses.STAGE


def _prefix_of(robot, values):
    if _is_of_stage(robot):
        return robot.namespace.strip('/').rpartition('/')[2] if robot.namespace != robot.hint.node.namespace else ''
    return str(served.nearest(robot.name, 'tf_prefix', values) or robot.namespace).strip('/')


def _absolute(robot, topic):
    base = robot.hint.node.name if topic.startswith('~') else ''  # only drivers have topics of their own
    return poses.ns_join(robot.namespace, poses.ns_join(base, topic[1:]) if base else topic)


def _walls_of(adoption, robot, kept, place):
    """Return the topic of the map whose walls stop a robot, or ''. A floor plan of Stage comes before a served map."""
    if served.nearest(robot.name, 'use_map', adoption.values()) is False:
        return ''
    topics = [one.topic for node in kept if node.type == 'map_server' and node.package in (PACKAGE, 'map_server')
              for one in [served.served_by(node, adoption.values())]]
    is_of_stage = _is_of_stage(robot)
    if is_of_stage and not (place and topics) and _serves_floor(adoption, adoption.stages[0].world):
        return _WALLS + '/map'
    own = [topic for topic in topics if topic == robot.namespace + 'map'] or [
        topic for topic in topics if topic == '/map'] or topics
    return own[0] if own and (place or not is_of_stage) else ''


def _serves_floor(adoption, world):
    """Serve the floor plan of Stage's world, and return whether there is one."""
    from ..adopting import floors  # it needs numpy and Pillow, and few launch files need it
    name = _WALLS + '/map_server'
    if name not in adoption.added:
        try:
            floors.map_of(world)
        except ConfigurationError as error:
            remark = 'there are no walls: {}'.format(error)
            adoption.remarks += [remark] if remark not in adoption.remarks else []
            return False
        adoption.added[name] = '{}/map_server {}'.format(PACKAGE, shlex.quote(world))
        adoption.done.append("{} is added: the floor plan of Stage's world {} stops the robots".format(
            name, os.path.basename(world)))
    return True


def _say_asking(adoption, kept):
    for node in kept if driven(adoption) else ():
        path = roles.program_of(node) if node.package != PACKAGE else None
        for word, what in _ASKS if path is not None else ():
            if programs.mentions(path, word):
                adoption.remarks.append('{} {} ({})'.format(roles.name_of(node), what, node.filename or ''))


def _plan_once(adoption, kept):
    """Have each real move_base plan once, where it would try without a pause until planner_patience is over.

    Computing takes no simulated time, so that would never be.
    """
    values = adoption.values()
    for node in kept:
        if kinds.kind_of(node.package, node.type).word != kinds.ROBOT or node.package != 'move_base' or not (
                adoption.options.real_navigation or adoption.is_kept(node)):
            continue
        name = roles.name_of(node)
        retries, frequency = (values.get('{}/{}'.format(name, key), default) for key, default in (
            ('max_planning_retries', -1), ('planner_frequency', 0.0)))
        if retries in (-1, None) and frequency in (0.0, None):
            adoption.param[name + '/max_planning_retries'] = 0
            adoption.done.append('{}: max_planning_retries is 0, because its planner_frequency is 0: it would plan '
                                 'without a pause until planner_patience is over, and computing takes no time'.format(
                                     name))


def gathered(adoption, options):
    """Return LaunchOptions in which the velocity robots are one fleet, if they are several: only then do they meet."""
    robots = driven(adoption)
    parents = {robot.namespace.rstrip('/').rpartition('/')[0] for robot in robots}
    names = [robot.namespace.rstrip('/').rpartition('/')[2] for robot in robots]
    if len(robots) < 2 or len(parents) > 1 or not all(map(_NAME.fullmatch, names)):
        if len(robots) > 1:
            adoption.remarks.append('the robots neither see nor stop one another, because their namespaces are not '
                                    'side by side: each is a process of its own')
        return options
    fleet = '{}/{}'.format(parents.pop(), FLEET)
    tables = [_table(robot, name, options) for robot, name in zip(robots, names)]
    shared = {key: value for key, value in tables[0].items() if all(table.get(key) == value for table in tables)}
    words = [word for robot in robots for word in options.add[robot.name].split(' ')[1:]]
    own = tuple(robot.name + '/' for robot in adoption.robots if robot.is_driven)
    adoption.done.append('{} is added: {} robots in one process, which see and stop one another'.format(
        fleet, len(robots)))
    return replace(
        options, start={name: pose for name, pose in options.start.items() if name + '/' not in own},
        leave_out=tuple(name for name in options.leave_out if name + '/' not in own),
        add={**{name: added for name, added in options.add.items() if name + '/' not in own},
             fleet: ' '.join(['{}/fleet'.format(PACKAGE), *words])},
        param={**{key: value for key, value in options.param.items() if not (key + '/').startswith(own)},
               fleet: {'defaults': {**shared, 'driven_by': 'velocities'}, 'robots': [
                   {key: value for key, value in table.items() if key not in shared} for table in tables]}})


def _table(robot, name, options):
    """Return the row of a robot in a fleet's scenario: its name, its place, its parameters."""
    row = {'name': name, **dict(zip(start_poses.PLACED, options.start.get(robot.name, ()))),
           **served.below(robot.name, dict(given.single(options.param)))}
    if row.get('tf_prefix') == name:
        del row['tf_prefix']  # a fleet's own default
    return row
