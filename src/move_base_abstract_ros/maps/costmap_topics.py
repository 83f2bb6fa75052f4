"""The topics of costmaps, so that existing RViz set-ups show the map and the footprint. The map is not inflated."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, List, Tuple

import rospy
from geometry_msgs.msg import PolygonStamped
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid

from move_base_abstract.maps.costmaps import Window

from ..messages import conversions
from ..messages.outlets import LatchedOutlet, LatchedOutlets
from ..messages.packing import InFrame, of_message

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.maps.costmaps import Footprint
    from move_base_abstract.maps.occupancy import OccupancyMap
    from move_base_abstract.maps.planning import WorldBounds

    from ..messages.packing import Pack
    from ..robot.host import Host
    from ..robot.names import RobotNames
    from .robot_map import RobotMap

_CELLS = 100
_WINDOW_RATE = 5.0  # Hz, wall
_FLOAT32_MAX = 3.4e38


class CostmapTopics:
    """Grids and footprints of one robot.

    The global costmap is the map, in the global frame. Without a map it is free everywhere inside the bounds. Without
    bounds the world is infinite and has no grid; then the topic exists but has no messages. The local costmap is a
    window of the global one that moves with the robot. It is in the odom frame, which coincides with the global frame.
    """

    def __init__(self, names: RobotNames, settings: RobotSettings, host: Host, robot_map: RobotMap) -> None:
        self._global_frame = settings.values['global_frame']
        self._local_frame = settings.odom_frame
        self._costmaps = settings.costmaps
        self._map = robot_map
        self._throttle = host.throttle(_WINDOW_RATE)
        self._grid = rospy.Publisher(names.own('global_costmap/costmap'), OccupancyGrid, queue_size=1, latch=True)
        self._window = LatchedOutlet(names.own('local_costmap/costmap'), OccupancyGrid, self._pack_window,
                                     queue_size=1)
        self._updates = [rospy.Publisher(names.own(costmap + '/costmap_updates'), OccupancyGridUpdate, queue_size=1)
                         for costmap in ('global_costmap', 'local_costmap')]
        self._footprints: Any = LatchedOutlets()
        for costmap, frame_id, footprint in (
                ('global_costmap', self._global_frame, self._costmaps.global_footprint),
                ('local_costmap', self._local_frame, self._costmaps.local_footprint)):
            self._footprints.add(names.own(costmap + '/footprint'), PolygonStamped,
                                 _footprint_packer(footprint, frame_id), queue_size=1)
        if settings.values['world_bounds'] and robot_map.check is None:
            self._grid.publish(_free_grid(settings.bounds, self._global_frame))
        robot_map.follow(self._show_map)

    def moved(self, pose: Pose2D, stamp_ns: int, is_event: bool) -> None:
        """Show the robot at ``pose`` (global frame), at ``stamp_ns`` [ns].

        ``is_event`` says that it starts or comes to rest; then the window is shown whatever its rate is.
        """
        self._footprints.show(pose, stamp_ns)
        if is_event or self._throttle.ready():
            self._window.show(pose, stamp_ns)

    def is_heard(self) -> int:
        """Return NOBODY (0), ONLOOKERS or PARTICIPANTS: the kind of nodes that hear what moves with the robot."""
        return max(self._footprints.is_heard(), self._window.is_heard())

    def hearers(self) -> List[Tuple[str, str]]:
        """Return (topic, name) of each node that hears a topic that moves with the robot."""
        return self._footprints.hearers() + self._window.hearers()

    def close(self) -> None:
        """Remove the topics."""
        for topic in (self._grid, self._window, *self._updates, self._footprints):
            topic.unregister()

    def _show_map(self, message: Any, _occupancy: OccupancyMap) -> None:
        """Publish the received map message itself, which all robots of the process share."""
        self._grid.publish(message)
        if self._footprints.shown is not None:
            self._window.show(*self._footprints.shown)

    def _pack_window(self, pose: Pose2D, stamp_ns: int) -> Pack:
        window = self._costmaps.window
        x, y = window.corner(pose)
        grid = _grid(self._local_frame, stamp_ns, x, y, window)
        occupancy = None if self._map.check is None else self._map.check.occupancy
        if occupancy is None:
            grid.data = [0] * (window.columns * window.rows)
        else:
            grid.data = occupancy.cut(x, y, window.columns, window.rows, window.resolution).ravel().tolist()
        return of_message(grid)


def _footprint_packer(footprint: Footprint, frame_id: str) -> Callable[[Pose2D, int], Pack]:
    frame = InFrame(frame_id)

    def make(pose: Pose2D, stamp_ns: int) -> Pack:
        points = [(_to_float32(x), _to_float32(y)) for x, y in footprint.at(pose)]
        return lambda seq: frame.polygon(seq, points, stamp_ns)
    return make


def _to_float32(value: float) -> float:
    """Return ``value``, limited to the range of a float32."""
    return max(-_FLOAT32_MAX, min(_FLOAT32_MAX, value))


def _grid(frame_id: str, stamp_ns: int, x: float, y: float, window: Window) -> Any:
    grid = OccupancyGrid(header=conversions.to_header(frame_id, stamp_ns))
    grid.info.resolution = window.resolution
    grid.info.width, grid.info.height = window.columns, window.rows
    grid.info.origin.position.x, grid.info.origin.position.y = x, y
    grid.info.origin.orientation.w = 1.0
    return grid


def _free_grid(bounds: WorldBounds, frame_id: str) -> Any:
    width, height = bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min
    resolution = max(width, height) / _CELLS
    window = Window(max(1, int(round(width / resolution))), max(1, int(round(height / resolution))), resolution)
    grid = _grid(frame_id, 0, bounds.x_min, bounds.y_min, window)
    grid.data = [0] * (window.columns * window.rows)
    return grid
