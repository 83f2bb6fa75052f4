"""Say of an adopted launch file which of its maps and parameters count: robots use maps as upstream's planner does.

``adoption`` is the object that applies the rules of :mod:`.adoption`.
"""
import math
import os
import shlex
import textwrap
from functools import lru_cache

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import error
from move_base_abstract.common.shown import listed

from ..adopting import poses, reading, robots, served
from ..loopback import PACKAGE
from . import given, roles

_WIDTH = 116  # columns


def use_maps(adoption, kept):
    """Have the robots use the maps that the ``kept`` nodes serve. A start that upstream would not allow may be left."""
    maps = _served(adoption, kept)
    used, ground_of = {}, lru_cache(maxsize=None)(_ground)  # each map is loaded once
    for robot, node in adoption.ours(kept) if maps else ():
        if robot.is_driven or node is not None and node.type == robots.OWN[1]:
            continue  # the walls of velocity robots are found elsewhere; the original package's program looks at no map
        try:
            one, settings, why = _used(adoption, robot, node, maps)
        except ConfigurationError:
            continue  # reported when all is decided
        if one is not None:
            used.setdefault((one, _as_upstream(settings)), []).append(robot.name)
            _say_start(adoption, robot.name, settings, one, ground_of(one.words))
        elif why:
            adoption.remarks.append('{} uses no map and drives straight: {}'.format(robot.name, why))
    for (one, how), names in used.items():
        adoption.remarks.append(
            '{} use{} the map of {}, as upstream would{}; --param {}/use_map=false undoes it, --param use_map=false '
            'for all robots'.format(listed(names), 's' * (len(names) == 1), one.name, how, names[0]))
    _say_floors(adoption, used)
    for one in maps:
        if used and not adoption.is_driven and one not in [chosen for chosen, _how in used]:
            adoption.remarks.append('no robot uses the map of {} on {}'.format(one.name, one.topic))


def _used(adoption, robot, node, maps):
    """Return (the Served that a Robot uses from now on or None, its settings, why it uses none or '').

    :raises ConfigurationError: if the robot would end with an error.
    """
    name, values, group = robot.name, adoption.values(), adoption.below(robot.name)
    said = served.nearest(name, 'use_map', values)
    if said is False or {'use_map', 'compatible_with'} & set(group):
        return None, None, ''  # somebody has said what to do; the original package's robots know no routes
    if said not in (None, True):
        adoption.problems.append(str(error('parameter use_map above {}'.format(name), said, 'true or false')))
        return None, None, ''
    settings = adoption.read_settings(group, name)
    own, frame = settings.values['map_topic'], settings.values['global_frame']
    if own is None and settings.costmaps.map_topic is None:
        return None, None, 'its global costmap has no static layer'
    remaps = node.remap_args if node is not None else ()
    wanted = served.resolved(own or settings.costmaps.map_topic, robot.namespace, remaps)
    one = next((one for topic in (wanted, own or '/map') for one in maps if one.topic == topic), None)
    if one is None:
        return None, None, 'nothing in the file serves {}'.format(wanted)
    if frame != one.frame_id:
        return None, None, 'its global frame is {}, and the map of {} is in the frame {}'.format(
            frame, one.name, one.frame_id)
    param = {'use_map': True}
    if 'routes' not in group and group.get('allow_occupied_goals') is not True:
        param.update(routes='grid', leave_obstacles=True)
    if not own and one.topic != ('/map' if wanted == robot.namespace + 'map' else wanted):
        param['map_topic'] = one.topic
    adoption.param.update(('{}/{}'.format(name, key), value) for key, value in param.items() if key not in group)
    return one, adoption.read_settings(adoption.below(name), name), ''


def take_planners(adoption, node):
    """Set the planners of the robot that replaces a move_base_flex: its relay's, or the first ones in its lists."""
    name, values = roles.name_of(node), adoption.values()
    relays = [roles.name_of(one) for one in adoption.config.nodes
              if one.namespace == node.namespace and 'move_base_legacy_relay' in one.type]
    for key, lists in (('base_local_planner', 'controllers'), ('base_global_planner', 'planners')):
        asked = [values.get('{}/{}'.format(relay, key)) for relay in relays]
        first = values.get('{}/{}'.format(name, lists))
        asked += [one.get('name') for one in (first if isinstance(first, list) else ()) if isinstance(one, dict)]
        chosen = next((one for one in asked if isinstance(one, str) and one), None)
        if chosen is not None and '{}/{}'.format(name, key) not in values:
            adoption.param['{}/{}'.format(name, key)] = chosen.rpartition('/')[2]
    adoption.remarks.append('{0} has the interface of move_base, under its own name ({0}/make_plan): programs that use '
                            'the actions of move_base_flex (exe_path, get_path) wait in vain'.format(name))


def add_floor(adoption, kept):
    """Serve the floor plan of Stage's world, if the file serves no map and does not say where the map's frame is."""
    if _served(adoption, kept) or adoption.is_driven:
        return
    for stage in adoption.stages:
        name = stage.node.namespace + 'map_server'
        if stage.offset is not None or any(name == roles.name_of(node) for node in kept) or name in adoption.added:
            continue
        from ..adopting import floors  # it needs numpy and Pillow
        try:
            floors.map_of(stage.world)
        except ConfigurationError:
            continue  # a line says that the world is not understood
        adoption.floors[stage.world] = name
        adoption.added[name] = '{}/map_server {}'.format(PACKAGE, shlex.quote(stage.world))
        return


def set_frames(adoption):
    """Give each robot a tf_prefix, or a frame of its odometry, if several robots would have the same frames."""
    values = adoption.values()
    by_goals = [robot for robot in adoption.robots if not robot.is_driven]
    bases = [str(values.get(robot.name + '/global_costmap/robot_base_frame', 'base_link')).strip('/')
             for robot in by_goals]
    for robot, base in zip(by_goals, bases if len(bases) > 1 else ()):
        prefix = robot.namespace.strip('/') or next(iter(sorted(robot.names)), '')
        if not prefix or {robot.name + '/tf_prefix', robot.namespace + 'tf_prefix'} & set(values):
            continue
        if bases.count(base) > 1:
            adoption.param[robot.name + '/tf_prefix'] = prefix
        elif not _has_odometry(robot.name, values):
            adoption.param[robot.name + '/odom_frame'] = (base.rpartition('/')[0] or prefix) + '/odom'


def _has_odometry(name, values):
    """Return whether the parameters say what the frame of a robot's odometry is: not the map's."""
    said = str(values.get(name + '/local_costmap/global_frame', '')).strip('/')
    maps = str(values.get(name + '/global_costmap/global_frame', 'map')).strip('/')
    return name + '/odom_frame' in values or said not in ('', maps)


def set_stage_offsets(adoption):
    """Tell robots in the frame of a map where it lies in Stage's world, or the user that nobody knows."""
    for stage in adoption.stages:
        place = stage.node.filename or ''
        if stage.offset is None and stage.world not in adoption.floors:
            adoption.remarks.append(
                "places in Stage's world count as places of the map, because it is not known where the map lies there: "
                '{} ({}); --start NODE=X,Y,YAW sets others'.format(stage.why.replace(reading.NOT_INSTALLED, ''), place))
        elif stage.offset is not None and any(stage.offset):
            adoption.done.append("the map's frame is at ({:g}, {:g}, {:g}) in Stage's world, {} ({})".format(
                *stage.offset, stage.why, place))
            for robot in adoption.robots:
                offset = {'{}/stage_offset_{}'.format(robot.name, axis): float(value)
                          for axis, value in zip(('x', 'y', 'yaw'), stage.offset) if value}
                adoption.param.update(
                    (key, value) for key, value in offset.items() if key not in adoption.config.params)


def _say_floors(adoption, used):
    """Say that floor plans of Stage are served, or serve them no longer if no robot has ``used`` them."""
    for world, name in list(adoption.floors.items()):
        if used:
            adoption.done.append("{} is added: the floor plan of Stage's world {} is the map, in the frame of that "
                                 'world'.format(name, os.path.basename(world)))
        else:
            del adoption.floors[world], adoption.added[name]


def _served(adoption, kept):
    values = adoption.values()
    found = [served.served_by(node, values) for node in kept
             if node.type == 'map_server' and node.package in (PACKAGE, 'map_server')]
    for name, added in {**adoption.options.add, **adoption.added}.items():
        _package, kind, arguments = given.split(added)
        if kind == 'map_server':
            topic = served.resolved('map', name.rpartition('/')[0] + '/', ())
            found.append(served.Served(name, topic, 'map', tuple(poses.words_of(arguments))))
    return found


def _ground(words):
    from ..adopting import floors  # it needs numpy and Pillow
    return floors.ground(words)


def _say_start(adoption, name, settings, one, ground):
    place = ground(settings.start.x, settings.start.y)
    if place:
        adoption.remarks.append('{} starts at ({:g}, {:g}), {} of {}{}'.format(
            name, settings.start.x, settings.start.y, place, one.name,
            ', and may leave that place (leave_obstacles)' if settings.values['leave_obstacles'] else ''))


def _as_upstream(settings):
    """Return in words how a robot with these settings uses a map."""
    if settings.values['routes'] != 'grid':
        return ': goals in occupied cells cannot be reached'
    costmaps, tolerances = settings.costmaps, settings.tolerances
    inflation = '' if costmaps.inflation == math.inf else ', inflation {:g} m'.format(costmaps.inflation)
    near = ', or {:g} m beside a goal'.format(settings.plan_tolerance) if settings.plan_tolerance else ''
    return (' (routes: grid, radius {:.3g} m{}, unknown cells {}, tolerances {:g} m and {:g} rad{}): ways lead around '
            'what it shows, and goals in occupied cells cannot be reached'.format(
                costmaps.global_footprint.inscribed_radius, inflation,
                'free' if settings.values['allow_unknown'] else 'not free', tolerances.xy, tolerances.yaw, near))


def unread(adoption):
    """Return lines with the parameters of our robots, and of nodes left out or replaced, that have no effect."""
    keys = [key for key in adoption.config.params if not poses.is_of_place(key)]
    names = [*map(roles.name_of, adoption.config.nodes), *adoption.options.add, *adoption.added]
    out = [roles.name_of(node) for node in adoption.config.nodes if adoption.is_out(node)]
    found = {}
    for name in names:
        paths = _below(name, names, keys)
        if name in adoption.settings:
            settings = adoption.settings[name]
            paths = ['{} (only with {})'.format(path, settings.needs[path]) if path in settings.needs else path
                     for path in (*settings.ignored, *settings.unknown) if path in paths]
        elif name not in out:
            continue  # its program is started, and reads what it wants
        if paths:
            found.setdefault(tuple(paths), []).append(name)
    return [line for paths, owners in found.items() for line in textwrap.wrap(
        '{}: {}'.format(listed(owners), ', '.join(paths)), _WIDTH, subsequent_indent='    ', break_long_words=False,
        break_on_hyphens=False)]


def _below(owner, others, keys):
    """Return the paths below ``owner`` of the ``keys`` (full names of parameters) that belong to none of ``others``."""
    inner = tuple(other + '/' for other in others if other.startswith(owner + '/'))
    return [key[len(owner) + 1:] for key in sorted(keys) if key.startswith(owner + '/') and not key.startswith(inner)]
