"""The plans that move_base publishes, and those that it makes on request."""
from __future__ import annotations

from contextlib import nullcontext
from typing import TYPE_CHECKING, Any, Sequence

import rospy
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan, GetPlanResponse
from sensor_msgs.msg import PointCloud2
from std_srvs.srv import Empty, EmptyResponse

from move_base_abstract.goals.events import Departed
from move_base_abstract.maps.planning import path_along
from move_base_abstract.motion.geometry import Pose2D

from ..messages import conversions
from ..messages.outlets import LatchedOutlets
from ..messages.packing import of_message

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.engine.stream import Stream
    from move_base_abstract.goals.navigator import Navigator

    from ..clocks.timing import Clock
    from ..messages.packing import Pack
    from ..robot.names import RobotNames
    from .robot_map import RobotMap

#: topics on which local planners show their samples, with publish_cost_grid_pc and publish_traj_pc; no messages here
_CLOUDS = {'DWAPlannerROS': ('cost_cloud', 'trajectory_cloud'), 'TrajectoryPlannerROS': ('cost_cloud',)}


class PlannerInterface:
    """Topics ``<planner>/plan`` and services ``make_plan``, ``<planner>/make_plan``, ``clear_costmaps``."""

    def __init__(self, names: RobotNames, settings: RobotSettings, clock: Clock,
                 navigator: Navigator, robot_map: RobotMap, stream: Stream) -> None:
        self._names = names
        self._clock = clock
        self._navigator = navigator
        self._map = robot_map
        self._global_frame = settings.values['global_frame']
        self._add_unreachable_goal = settings.values['make_plan_add_unreachable_goal']
        local = settings.local_planner
        planner = settings.global_planner
        self._plans = LatchedOutlets()
        for topic in (planner + '/plan', local + '/global_plan', local + '/local_plan'):
            self._plans.add(names.own(topic), Path, self._pack_way, queue_size=1)
        self._clouds = [rospy.Publisher(names.own('{}/{}'.format(local, cloud)), PointCloud2, queue_size=1)
                        for cloud in _CLOUDS.get(local, ())]
        stream.subscribe('plan', {Departed: self._show})
        self._services = [
            rospy.Service(names.own('make_plan'), GetPlan, self._make_plan_when_idle),
            rospy.Service(names.own(planner + '/make_plan'), GetPlan,
                          lambda request: GetPlanResponse(self._make_plan(request))),
            rospy.Service(names.own('clear_costmaps'), Empty, lambda _request: EmptyResponse())]

    def set_add_unreachable_goal(self, is_added: bool) -> None:
        """Set whether a plan that ends near the goal also has the goal itself as its last pose."""
        self._add_unreachable_goal = is_added

    def close(self) -> None:
        """Remove the topics and services."""
        for topic in (self._plans, *self._clouds):
            topic.unregister()
        for service in self._services:
            service.shutdown('the robot is removed')

    def _show(self, event: Departed) -> None:
        """Publish the way that the robot now takes, also for later listeners."""
        leg = self._navigator.robot.leg
        assert leg is not None  # it has just departed
        self._plans.show(leg.start, leg.corners, Pose2D(event.x, event.y, event.yaw), event.time_ns)

    def _pack_way(self, start: Pose2D, corners: Any, goal: Pose2D, now_ns: int) -> Pack:
        return of_message(self._to_path(path_along(start, corners, goal), now_ns))

    def _make_plan_when_idle(self, request: Any) -> Any:
        with self._clock.lock:
            active = self._navigator.is_active
        if active:
            raise rospy.ServiceException('move_base must be in an inactive state to make a plan for an external user')
        plan = self._make_plan(request)
        plan.header.frame_id, plan.header.stamp = '', conversions.to_time(0)  # as in move_base, unlike in planners
        return GetPlanResponse(plan)

    def _make_plan(self, request: Any) -> Any:
        """Return the plan from the request's start, or from the robot, in the global frame; empty if there is no way.

        :raises rospy.ServiceException: if no plan can be made, for example for a pose in another frame.
        """
        self._map.wait()
        lacking = self._navigator.planner.lacking
        if lacking:
            raise rospy.ServiceException('make_plan: {}'.format(lacking))
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            start = self._navigator.robot.pose_at(now_ns)
        try:
            if request.start.header.frame_id:
                start = self._in_global_frame(request.start)
            goal = self._in_global_frame(request.goal)
            with nullcontext() if self._navigator.planner.goes_straight else self._clock.lock:
                poses = self._navigator.planner.plan_near(start, goal, request.tolerance, self._add_unreachable_goal)
        except ValueError as error:
            raise rospy.ServiceException('make_plan: {}'.format(error)) from None
        return self._to_path(poses, now_ns)

    def _in_global_frame(self, message: Any) -> Pose2D:
        """Return the Pose2D of a request's pose. Like upstream's planners this takes only the global frame."""
        if message.header.frame_id.lstrip('/') != self._global_frame:
            raise ValueError("the start and the goal must be in the global frame '{}', got '{}'".format(
                self._global_frame, message.header.frame_id))
        return conversions.from_pose(message.pose)

    def _to_path(self, poses: Sequence[Pose2D], now_ns: int) -> Any:
        return Path(conversions.to_header(self._global_frame, now_ns),
                    [conversions.to_pose_stamped(pose, self._global_frame, now_ns) for pose in poses])
