"""The node ``map_server``: the real one if it is installed, otherwise a stand-in with its command line and interface.

In lockstep it takes part if the time master's ``participants`` name it, as lockstep_launch does.

Topics (latched): ``map``, ``map_metadata``. Services: ``static_map``, ``change_map``. Parameters: ``~frame_id``,
``~image``; with the old form of the command line also ``~negate``, ``~occupied_thresh``, ``~free_thresh``.
"""
import os
import sys
import threading
import time
from dataclasses import replace

import rospkg
import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse
from rosgraph_msgs.msg import Clock
from roslib import packages
from rospy.numpy_msg import numpy_msg

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import as_number, number
from move_base_abstract.common.map_images import ImageRule
from move_base_abstract.common.parameter_table import read_table
from move_base_abstract.common.shown import shown_text
from move_base_abstract.config.node_tables import MAP_FRAME, MAP_IMAGE, MAP_OLD_FORM
from move_base_abstract.maps.map_files import MapDescription, load_map, read_description
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.adopting import worlds
from move_base_abstract_ros.clocks.timing import make_timing
from move_base_abstract_ros.messages import conversions
from move_base_abstract_ros.process.node_process import run_node

try:
    from nav_msgs.srv import LoadMap, LoadMapResponse
except ImportError:
    LoadMap = None  # nav_msgs of Debian 11 and before: there is no service change_map there

_USAGE = ('USAGE: map_server MAP.yaml\n'
          '  MAP.yaml: the description of a map\n'
          'OR: map_server STAGE.world\n'
          '  STAGE.world: a world file of Stage, whose floor plan is the map\n'
          'DEPRECATED USAGE: map_server IMAGE RESOLUTION\n'
          '  IMAGE: an image file\n'
          '  RESOLUTION: the side of a pixel [m]')
_FAILED = 255  # also the exit code of the real map_server
_POLL_SECONDS = 0.02
_REMINDER_SECONDS = 5.0


def main():
    """Run the node until ROS shuts down; exits with 255 if the arguments or the map cannot be used.

    If the real map_server is installed, it takes the place of this process.
    """
    is_own_form = len(sys.argv) > 1 and worlds.is_world(sys.argv[1])
    real = None if is_own_form else find_real_map_server()
    if real:
        os.execv(real, [real] + sys.argv[1:])
    arguments = rospy.myargv(sys.argv)[1:]
    if arguments and arguments[0] in ('-h', '--help'):
        print(_USAGE)
        return
    if len(arguments) not in (1, 2) or arguments[0].startswith('--'):
        print('map_server: got {} arguments{}; allowed: 1, or 2 in the old form\n{}'.format(
            len(arguments), ', {}'.format(shown_text(arguments[0])) if arguments else '', _USAGE), file=sys.stderr)
        sys.exit(_FAILED)
    run_node('map_server', lambda: _build(arguments), failed=_FAILED, anonymous=True)


def find_real_map_server():
    """Return the path of the executable of the package map_server, or None if that is not installed."""
    try:
        paths = packages.find_node('map_server', 'map_server')
    except rospkg.ResourceNotFound:
        return None
    return paths[0] if paths else None


def _build(arguments):
    raw = rospy.get_param('~', {})
    where = rospy.get_name()
    values = read_table(raw, (MAP_FRAME, MAP_IMAGE), where)
    if worlds.is_world(arguments[0]):
        from move_base_abstract_ros.adopting import floors  # few maps are of Stage
        return MapServer(values['frame_id'], OccupancyMap(*floors.map_of(arguments[0])))
    if len(arguments) == 2:
        rospy.logwarn('%s: IMAGE RESOLUTION is the old form; a YAML file says more', where)
        description = _describe_old_form(arguments, raw, where)
    else:
        description = _describe(arguments[0])
        if values['image']:
            description = replace(description, image=values['image'], beside='')
    return MapServer(values['frame_id'], load_map(description))


def _describe(path):
    description = read_description(path)
    for warning in description.warnings:
        rospy.logwarn('%s: %s', rospy.get_name(), warning)
    return description


def _describe_old_form(arguments, raw, where):
    image, resolution = arguments
    values = read_table(raw, MAP_OLD_FORM, where)
    try:
        resolution = number(above=0.0)(as_number(resolution))
    except ValueError:
        raise ConfigurationError("argument RESOLUTION: got '{}'; allowed: a finite number > 0 [m]\n{}".format(
            resolution, _USAGE)) from None
    return MapDescription(image, resolution, rule=ImageRule(
        negate=bool(values['negate']), occupied_thresh=values['occupied_thresh'], free_thresh=values['free_thresh']))


class MapServer:
    """Publishes one map, returns it to callers of ``static_map``, and replaces it when ``change_map`` asks."""

    def __init__(self, frame_id, occupancy):
        participant = lockstep.join(own_threads=False) if lockstep.is_awaited(rospy.get_name()) else None
        self._frame_id = frame_id
        self._lock = threading.Lock()
        self._metadata = rospy.Publisher('map_metadata', MapMetaData, queue_size=1, latch=True)
        # numpy_msg: rospy sends the array of cells as it is, instead of one Python number for each cell
        self._map = rospy.Publisher('map', numpy_msg(OccupancyGrid), queue_size=1, latch=True)
        self._grid = None
        _wait_for_time()
        timing = make_timing()
        timing.watch()
        self._has_left_clock = participant is None and timing.leave_clock()  # time need not wait for this node
        self.show(occupancy, rospy.Time.now())
        self._services = [rospy.Service('static_map', GetMap, self._get_map)]
        if LoadMap is not None:
            self._services.append(rospy.Service('change_map', LoadMap, self._change_map))
        if participant is not None:
            participant.serve()

    def show(self, occupancy, now):
        """Publish ``occupancy`` (OccupancyMap) from ``now`` (rospy.Time) on."""
        grid = numpy_msg(OccupancyGrid)()
        grid.header.frame_id = self._frame_id
        grid.header.stamp = grid.info.map_load_time = now
        grid.info.resolution = occupancy.resolution
        grid.info.width, grid.info.height = occupancy.width, occupancy.height
        grid.info.origin = conversions.to_pose(occupancy.origin)
        grid.data = occupancy.cells.reshape(-1)
        with self._lock:
            self._grid = grid
            self._metadata.publish(grid.info)
            self._map.publish(grid)
        rospy.loginfo('%s: a map of %d x %d cells of %.3f m', rospy.get_name(), occupancy.width, occupancy.height,
                      occupancy.resolution)

    def _get_map(self, _request):
        return numpy_msg(GetMapResponse)(self._grid)

    def _change_map(self, request):
        """Show the map of another YAML file; if that fails, the old map stays."""
        try:
            occupancy = load_map(_describe(to_path(request.map_url)))
            now = rospy.wait_for_message('/clock', Clock).clock if self._has_left_clock else rospy.Time.now()
            self.show(occupancy, now)
        except ConfigurationError as error:
            rospy.logerr('%s: change_map: %s; the map stays as it is', rospy.get_name(), error)
            return LoadMapResponse(result=LoadMapResponse.RESULT_UNDEFINED_FAILURE)
        return numpy_msg(LoadMapResponse)(self._grid, LoadMapResponse.RESULT_SUCCESS)


def to_path(url):
    """Return the path in ``url``: a path itself, ``file://PATH`` or ``package://PACKAGE/PATH``.

    :raises ConfigurationError: if there is no such package.
    """
    if url.startswith('file://'):
        return url[len('file://'):]
    if not url.startswith('package://'):
        return url
    package, _, path = url[len('package://'):].partition('/')
    try:
        return os.path.join(rospkg.RosPack().get_path(package), path)
    except rospkg.ResourceNotFound:
        raise ConfigurationError("{}: there is no package '{}'".format(url, package)) from None


def _wait_for_time():
    """Wait for the first /clock if time is simulated, because a stamp of 0 has another meaning."""
    warned = time.monotonic()
    while rospy.Time.now().is_zero() and not rospy.is_shutdown():
        time.sleep(_POLL_SECONDS)
        if time.monotonic() - warned > _REMINDER_SECONDS:
            warned = time.monotonic()
            rospy.logwarn('%s: use_sim_time is true but nothing has come on /clock yet: is a time master running?',
                          rospy.get_name())
