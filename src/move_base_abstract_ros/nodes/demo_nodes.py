"""The nodes of the demo: time master, map server, a fleet with the mission's robots, and RViz if asked for."""
import os

import rospkg

from move_base_abstract.errors import ConfigurationError
from move_base_abstract_ros.loopback import PACKAGE
from move_base_abstract_ros.map_files import load_map, read_description


def start(ros, plan, factor, speed, map_path, rviz):
    """Start them on the master of ``ros`` (Loopback); ``map_path`` may be None: no map."""
    ros.run('time_master', 'time_master', parameters={'factor': factor})
    if map_path is not None:
        ros.run('map_server', 'map_server', arguments=(map_path,))
    ros.run('fleet', 'fleet', parameters={
        'defaults': {'max_speed': speed, 'use_map': map_path is not None},
        'robots': [{'name': robot.name, 'start_x': robot.start.x, 'start_y': robot.start.y,
                    'start_yaw': robot.start.yaw} for robot in plan.robots]})
    if rviz:
        ros.spawn('rviz', ['rviz', '-d', shipped('rviz', 'simulator.rviz')])


def shipped(*path):
    """Return the path of a file that ships with the package."""
    return os.path.join(rospkg.RosPack().get_path(PACKAGE), *path)


def choose_map(asked, default, plan):
    """Return the path of the map to use, or None, and a line for the user that says why.

    A map that was asked for is used; the default one where all places of the mission are free in it.
    :raises ConfigurationError: if the map that was asked for cannot be read.
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
