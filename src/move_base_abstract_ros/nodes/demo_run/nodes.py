"""The nodes of the demo: time master, map server, a fleet with the mission's robots, and RViz if wanted."""
import os

import rospkg

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract_ros.loopback import PACKAGE

WATCHED_POSES = 10.0  # Hz, simulated: in lockstep, robots publish poses on the way only if a rate is given
ROBOT_RADIUS = 0.6  # m, of robots that drive around the obstacles of the map


def clock_parameters(kind, factor, names, event_log, note):
    """Return the time master's parameters for a clock of ``kind`` 'lockstep' or 'scaled'.

    ``factor``: simulated seconds per wall second; None: no limit in lockstep, 20 on the scaled clock. ``names``: of the
    participants, ``event_log`` and ``note``: paths of the log, and of the time master's last note; in lockstep only.
    """
    if kind == 'scaled':
        return {'mode': 'scaled', 'factor': 20.0 if factor is None else factor}
    return {'mode': 'lockstep', 'participants': names, 'speed_limit': factor or 0.0, 'on_death': 'end',
            'event_log': event_log, 'note_of_end': note}


def robot_settings(speed, has_map, routes, rviz):
    """Return the settings of all robots.

    ``speed`` [m/s]; ``has_map``: whether a map is used; ``routes``: whether robots drive around its obstacles;
    ``rviz``: whether RViz shows them.
    """
    settings = {'max_speed': speed, 'use_map': has_map, 'log_motion': True}
    if rviz:
        settings['pose_update_freq'] = WATCHED_POSES
    if routes:
        settings.update(routes='grid', robot_radius=ROBOT_RADIUS)
    return settings


def start(ros, plan, clock, settings, map_path, rviz):
    """Start the nodes on the master of ``ros`` (Loopback).

    ``clock``: the parameters of the time master; ``settings``: those of all robots; ``map_path``: None for no map.
    """
    ros.run('time_master', 'time_master', parameters=clock)
    if map_path is not None:
        ros.run('map_server', 'map_server', arguments=(map_path,))
    ros.run('fleet', 'fleet', parameters={
        'defaults': settings,
        'robots': [{'name': robot.name, 'start_x': robot.start.x, 'start_y': robot.start.y,
                    'start_yaw': robot.start.yaw} for robot in plan.robots]})
    if rviz:
        ros.spawn('rviz', ['rviz', '-d', shipped('rviz', 'simulator.rviz')])


def shipped(*path):
    """Return the absolute path of a file that ships with the package."""
    return os.path.join(rospkg.RosPack().get_path(PACKAGE), *path)


def choose_map(asked, default, plan):
    """Return (path, line): the map to use, or None, and a line for the user that says why.

    ``asked``: the path of the map that the user gave, or None. Without it the map ``default`` of the package is used,
    if all places of the mission ``plan`` are free in it.
    :raises ConfigurationError: if the map that the user gave cannot be read.
    """
    if asked is not None:
        read_description(asked)
        return os.path.abspath(asked), 'map: {}'.format(asked)
    path = shipped('maps', default)
    try:
        grid = load_map(read_description(path))
    except ConfigurationError as error:
        return None, 'no map: {}'.format(error)
    blocked = [place for robot in plan.robots for place in (robot.start, *robot.goals) if not grid.is_free(place)]
    if blocked:
        return None, 'no map: ({:g}, {:g}) m is not a free place of {}'.format(blocked[0].x, blocked[0].y, default)
    return path, 'map: {}'.format(default)
