"""The plans that move_base shows and makes on request, and the costmaps that it would have."""
import rospy
from geometry_msgs.msg import Point32, PolygonStamped
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan, GetPlanResponse
from std_srvs.srv import Empty, EmptyResponse

from move_base_abstract.planning import straight_path

from . import conversions

_COSTMAPS = ('global_costmap', 'local_costmap')


class PlannerInterface:
    """Topics ``<planner>/plan`` and services ``make_plan``, ``<planner>/make_plan``, ``clear_costmaps``."""

    def __init__(self, names, settings, clock, navigator, robot_map):
        self._names = names
        self._clock = clock
        self._navigator = navigator
        self._map = robot_map
        self._global_frame = settings.values['global_frame']
        self.add_unreachable_goal = settings.values['make_plan_add_unreachable_goal']
        local = settings.local_planner
        planner = settings.global_planner
        self._plans = [rospy.Publisher(names.own(topic), Path, queue_size=1) for topic in (
            planner + '/plan', local + '/global_plan', local + '/local_plan')]
        self._services = [
            rospy.Service(names.own('make_plan'), GetPlan, self._make_plan_when_idle),
            rospy.Service(names.own(planner + '/make_plan'), GetPlan, self._make_plan),
            rospy.Service(names.own('clear_costmaps'), Empty, lambda _request: EmptyResponse())]
        self._costmaps = _CostmapTopics(names, settings, robot_map)

    def close(self):
        """Leave the graph."""
        for publisher in self._plans:
            publisher.unregister()
        for service in self._services:
            service.shutdown('the robot is removed')
        self._costmaps.close()

    def show(self, start, goal, now_ns):
        """Publish the way that the robot now takes."""
        listened = [publisher for publisher in self._plans if publisher.get_num_connections() > 0]
        if listened:
            path = self._to_path(straight_path(start, goal), now_ns)
            for publisher in listened:
                publisher.publish(path)

    def _make_plan_when_idle(self, request):
        with self._clock.lock:
            active = self._navigator.is_active
        if active:
            raise rospy.ServiceException('move_base must be in an inactive state to make a plan for an external user')
        return self._make_plan(request)

    def _make_plan(self, request):
        """Plan from the request's start (or from the robot) in the global frame; an empty plan if there is no way."""
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
            poses = self._navigator.planner.plan_near(start, goal, request.tolerance, self.add_unreachable_goal)
        except ValueError as error:
            raise rospy.ServiceException('make_plan: {}'.format(error)) from None
        plan = self._to_path(poses, now_ns)
        plan.header.frame_id, plan.header.stamp = '', conversions.to_time(0)
        return GetPlanResponse(plan)

    def _in_global_frame(self, message):
        """Return the Pose2D of a request's pose; like upstream's planners this takes the global frame only."""
        if message.header.frame_id.lstrip('/') != self._global_frame:
            raise ValueError("the start and the goal must be in the global frame '{}', got '{}'".format(
                self._global_frame, message.header.frame_id))
        return conversions.from_pose(message.pose)

    def _to_path(self, poses, now_ns):
        return Path(conversions.to_header(self._global_frame, now_ns),
                    [conversions.to_pose_stamped(pose, self._global_frame, now_ns) for pose in poses])


class _CostmapTopics:
    """The costmaps' topics, so that existing RViz set-ups find them: the map as it is, and a square footprint.

    Without a map the grid is free everywhere inside the bounds. Without these the world has no end and thus no grid:
    then the grid topics are there and stay silent.
    """

    _CELLS = 100

    def __init__(self, names, settings, robot_map):
        self._publishers = []
        self._grids = []
        footprint = _footprint(settings)
        for costmap in _COSTMAPS:
            grid = rospy.Publisher(names.own(costmap + '/costmap'), OccupancyGrid, queue_size=1, latch=True)
            update = rospy.Publisher(names.own(costmap + '/costmap_updates'), OccupancyGridUpdate, queue_size=1)
            polygon = rospy.Publisher(names.own(costmap + '/footprint'), PolygonStamped, queue_size=1, latch=True)
            polygon.publish(footprint)
            if settings.values['world_bounds'] and robot_map.check is None:
                grid.publish(self._free_grid(settings))
            self._publishers += [grid, update, polygon]
            self._grids.append(grid)
        robot_map.follow(self._show_map)

    def _show_map(self, message, _occupancy):
        """Publish the map's own message: all robots of the process share it."""
        for grid in self._grids:
            grid.publish(message)

    def close(self):
        """Leave the graph."""
        for publisher in self._publishers:
            publisher.unregister()

    def _free_grid(self, settings):
        bounds = settings.bounds
        width, height = bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min
        grid = OccupancyGrid(header=conversions.to_header(settings.values['global_frame'], 0))
        grid.info.resolution = max(width, height) / self._CELLS
        grid.info.width = max(1, int(round(width / grid.info.resolution)))
        grid.info.height = max(1, int(round(height / grid.info.resolution)))
        grid.info.origin.position.x, grid.info.origin.position.y = bounds.x_min, bounds.y_min
        grid.info.origin.orientation.w = 1.0
        grid.data = [0] * (grid.info.width * grid.info.height)
        return grid


def _footprint(settings):
    """Return a square of upstream's default inscribed radius, 0.325 m, in base_link."""
    half = 0.325
    polygon = PolygonStamped(header=conversions.to_header(settings.frame(settings.values['robot_base_frame']), 0))
    polygon.polygon.points = [Point32(x * half, y * half, 0.0) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return polygon
