"""The mission in RViz: maps as OccupancyGrid; samples, tasks and ways as markers; RMSE and variance.

Messages are made only for topics with a subscriber, so they cost nothing without RViz. A late subscriber gets the
latest message at once.
"""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
import rospy
from geometry_msgs.msg import Point, TransformStamped
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import ColorRGBA, Float64
from tf2_ros import StaticTransformBroadcaster
from visualization_msgs.msg import Marker, MarkerArray

from .legend import make_legend, variance_offset_m

ROBOT_COLOURS = ((0.84, 0.15, 0.16), (0.12, 0.47, 0.71), (0.17, 0.63, 0.17), (0.58, 0.40, 0.74), (1.0, 0.5, 0.05))
SAMPLE_M, TASK_M, WAY_M = 5.0, 6.0, 1.0  # sizes of markers
SAMPLE_Z, TASK_Z, WAY_Z = 0.3, 0.2, 0.1  # heights: more important markers lie on top


class LatchedView(rospy.SubscribeListener):
    """A topic whose message make() makes if there is a subscriber; if it returns None, there is nothing to show yet."""

    def __init__(self, topic: Optional[str], kind: str, make: Any) -> None:
        super().__init__()
        self._make = make
        self._publisher = rospy.Publisher(topic, kind, subscriber_listener=self, queue_size=2)

    def refresh(self) -> None:
        """Publish again, if there is a subscriber."""
        if self._publisher.impl.connections:  # counts onlookers, which lockstep does not count
            message = self._make()
            if message is not None:
                self._publisher.publish(message)

    def peer_subscribe(self, _topic_name: Any, _topic_publish: Any, peer_publish: Any) -> None:
        """Send the present state to a new subscriber."""
        message = self._make()
        if message is not None:
            peer_publish(message)


class Views:
    """All topics that show a mission, below the node's own name. Call refresh() after each change.

    variance_frame: frame of the variance's map. If it is not map, a static transform puts it beside the prediction.
    """

    def __init__(self, coordinator: Any, variance_frame: str = 'map') -> None:
        self._coordinator = coordinator
        grid, truth = coordinator.truth.grid, coordinator.truth.values
        self._cell_m = grid.cell_m
        span, to = (float(truth.min()), float(truth.max())), (0.0, float(truth.var()))
        self._told = None
        self._latched = [
            LatchedView('~prediction', OccupancyGrid, lambda: self._map('mean', 'map', span)),
            LatchedView('~variance', OccupancyGrid, lambda: self._map('variance', variance_frame, to)),
            LatchedView('~truth', OccupancyGrid, lambda: to_grid(truth, self._cell_m, 'map', span)),
            LatchedView('~legend', MarkerArray, lambda: make_legend(grid, coordinator.truth.unit, span, to)),
            LatchedView('~markers', MarkerArray, self._markers)]
        if variance_frame != 'map':
            self._frames = StaticTransformBroadcaster()
            self._frames.sendTransform(_beside(variance_frame, variance_offset_m(grid)))
        self._rmse = rospy.Publisher('~rmse', Float64, queue_size=10, latch=True)
        self._mean_variance = rospy.Publisher('~mean_variance', Float64, queue_size=10, latch=True)

    def refresh(self) -> None:
        """Publish all that has changed."""
        markers, estimate = self._latched[-1], self._coordinator.estimate
        markers.refresh()
        if estimate is None or estimate is self._told:
            return
        self._told = estimate
        self._rmse.publish(estimate.rmse)
        self._mean_variance.publish(estimate.mean_variance)
        for view in self._latched[:2]:
            view.refresh()

    def _map(self, name: str, frame: str, span: Any) -> Any:
        estimate = self._coordinator.estimate
        return None if estimate is None else to_grid(getattr(estimate, name), self._cell_m, frame, span)

    def _markers(self) -> Any:
        log = self._coordinator.log
        markers = [to_points('samples', 0, Marker.SPHERE_LIST, SAMPLE_M, SAMPLE_Z, (0.1, 0.1, 0.1),
                             [(sample.x, sample.y) for sample in log.samples])]
        for robot in range(self._coordinator.config.robots):
            colour = ROBOT_COLOURS[robot % len(ROBOT_COLOURS)]
            current = self._coordinator.current_task(robot)
            tasks = ([current] if current else []) + list(self._coordinator.queue(robot))
            places = [(task.x, task.y) for task in tasks]
            markers.append(to_points('tasks', robot, Marker.CUBE_LIST, TASK_M, TASK_Z, colour, places))
            here = [(way.x, way.y) for way in log.waypoints if way.robot == robot][-1:]
            markers.append(to_points('ways', robot, Marker.LINE_STRIP, WAY_M, WAY_Z, colour,
                                     here + places if here and places else []))
        return MarkerArray(markers)


def _beside(frame: str, x: float) -> Any:
    """Return the transform of a frame that lies x east of the frame map [m]."""
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = 'map', frame
    transform.header.stamp = rospy.Time.now()
    transform.transform.translation.x = x
    transform.transform.rotation.w = 1.0
    return transform


def to_grid(values: Any, cell_m: Any, frame: str, span: Any) -> Any:
    """Return values (rows from the south) as an OccupancyGrid; span: (low, high), the values that become 1 and 98.

    0, 99 and 100 are not used, because RViz's colours of them have other meanings.
    """
    low, high = span
    grid = OccupancyGrid()
    grid.header.frame_id = frame
    grid.header.stamp = grid.info.map_load_time = rospy.Time.now()
    grid.info.resolution = cell_m
    grid.info.height, grid.info.width = values.shape
    grid.info.origin.orientation.w = 1.0
    share = (values - low) / (high - low) if high > low else np.zeros(values.shape)
    grid.data = np.rint(1.0 + 97.0 * np.clip(share, 0.0, 1.0)).astype(np.int8).ravel().tolist()
    return grid


def to_points(namespace: str, number: int, kind: str, size_m: Any, height_m: Any, colour: Any, places: Any) -> Any:
    """Return a marker of many places (x, y) [m, map frame]; without places it deletes the marker shown before."""
    marker = Marker(ns=namespace, id=number, type=kind, action=Marker.ADD if places else Marker.DELETE)
    marker.header.frame_id = 'map'
    marker.pose.orientation.w = 1.0
    marker.scale.x = marker.scale.y = marker.scale.z = size_m
    marker.color = ColorRGBA(*colour, 1.0)
    marker.points = [Point(x, y, height_m) for x, y in places]
    return marker
