"""Plans, footprints and the local costmap, for an RViz from the start on, and for one that comes later."""
import math
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PolygonStamped, Pose, PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from robot_harness import GUARD, RawClient, Record, active_since_ns, pose_stamped

LAUNCH_FILE = """
<launch>  <!-- the topics that RViz shows for a robot without costmaps and planner -->
  <group ns="robot_0">
    <param name="footprint" value="[[0.5, 0.25], [-0.5, 0.25], [-0.5, -0.25], [0.5, -0.25]]"/>
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        max_speed: 1.0
        tf_prefix: robot_0
        global_costmap: {footprint_padding: 0.0}
        local_costmap: {footprint: [[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]], width: 4.0, height: 2.0, resolution: 0.1}
      </rosparam>
    </node>
  </group>
</launch>
"""
FACTOR = 2
OWN_NODE = 'planner_views_test'

MOVE_BASE = '/robot_0/move_base'
PLANS = ('NavfnROS/plan', 'TrajectoryPlannerROS/global_plan', 'TrajectoryPlannerROS/local_plan')
FAR = 10_000.0


def corners(polygon):
    """Return the corners of a PolygonStamped [mm]."""
    return [(round(point.x, 3), round(point.y, 3)) for point in polygon.polygon.points]


def latest(topic, kind):
    """Return the first message that a new subscriber gets."""
    return rospy.wait_for_message('{}/{}'.format(MOVE_BASE, topic), kind, GUARD)


class PlannerViews(unittest.TestCase):
    """Each test begins with the robot at the origin."""

    @classmethod
    def setUpClass(cls):
        # One publisher for all tests: rospy may lose the first message of a new one right after another has ended.
        cls.publisher = rospy.Publisher('/robot_0/set_pose', Pose, queue_size=1, latch=True)

    def setUp(self):
        self.client = RawClient('/robot_0')
        self.place(0.0)

    def place(self, x):
        """Put the robot at (x, 0) [m] and wait until its footprint is there."""
        shown = Record(MOVE_BASE + '/global_costmap/footprint', PolygonStamped)
        self.publisher.publish(pose_stamped(x).pose)
        shown.wait_for(lambda polygon: math.isclose(polygon.polygon.points[0].x, x + 0.5, rel_tol=1e-6)
                       and (x or corners(polygon)[0] == (0.5, 0.25)))
        shown.close()

    def travel(self, x, y=0.0):
        """Send the robot to a far place; return its time of departure [ns]."""
        goal_id = self.client.send(pose_stamped(x, y))
        start_ns = active_since_ns(self.client, goal_id)

        def end():
            self.client.cancel(goal_id)
            self.client.ending(goal_id)
        self.addCleanup(end)
        return start_ns

    def test_who_comes_while_a_robot_travels_is_told_its_plans(self):
        start_ns = self.travel(FAR)
        for topic in PLANS:
            plan = latest(topic, Path)
            self.assertEqual((plan.header.frame_id, plan.header.stamp.to_nsec()), ('map', start_ns))
            self.assertEqual((plan.poses[0].pose.position.x, plan.poses[-1].pose.position.x), (0.0, FAR))

    def test_footprints_have_the_robots_shape_and_move_with_it(self):
        self.assertEqual(corners(latest('global_costmap/footprint', PolygonStamped)),
                         [(0.5, 0.25), (-0.5, 0.25), (-0.5, -0.25), (0.5, -0.25)])
        self.assertEqual(corners(latest('local_costmap/footprint', PolygonStamped)),
                         [(1.01, 0.0), (-1.01, 1.01), (-1.01, -1.01)])
        global_one = Record(MOVE_BASE + '/global_costmap/footprint', PolygonStamped)
        local_one = Record(MOVE_BASE + '/local_costmap/footprint', PolygonStamped)
        start_ns = self.travel(0.0, FAR)
        for record, frame, nose in ((global_one, 'map', 0.5), (local_one, 'robot_0/odom', 1.01)):
            moving = [record.wait_for(lambda polygon, metres=metres: polygon.polygon.points[0].y > metres)
                      for metres in (1.5, 2.5)]
            for polygon in moving:
                travelled = (polygon.header.stamp.to_nsec() - start_ns) * 1e-9
                self.assertEqual(polygon.header.frame_id, frame)
                self.assertAlmostEqual(polygon.polygon.points[0].y, travelled + nose, places=3)
            self.assertGreater(moving[1].header.stamp, moving[0].header.stamp)

    def test_a_footprint_that_stands_is_told_again_and_again_with_the_present(self):
        record = Record(MOVE_BASE + '/local_costmap/footprint', PolygonStamped)
        first = record.wait_for()
        again = record.wait_for(lambda polygon: polygon.header.stamp > first.header.stamp)
        self.assertEqual(corners(again), corners(first))

    def test_the_local_costmap_is_a_window_that_goes_with_the_robot_in_the_odom_frame(self):
        grids = Record(MOVE_BASE + '/local_costmap/costmap', OccupancyGrid)
        self.travel(FAR)
        for metres in (0.5, 1.5):
            grid = grids.wait_for(lambda grid, metres=metres: grid.info.origin.position.x > metres - 2.0)
            self.assertEqual((grid.header.frame_id, grid.info.width, grid.info.height), ('robot_0/odom', 40, 20))
            cells = grid.info.origin.position.x / 0.1
            self.assertAlmostEqual(cells, round(cells), places=6)
            self.assertAlmostEqual(grid.info.origin.position.y, -1.0)
            self.assertEqual(set(grid.data), {0})

    def test_make_plan_has_no_header_and_that_of_the_planner_has_one(self):
        plans = [rospy.ServiceProxy(MOVE_BASE + name, GetPlan)(PoseStamped(), pose_stamped(3.0), 0.0).plan
                 for name in ('/make_plan', '/NavfnROS/make_plan')]
        self.assertEqual((plans[0].header.frame_id, plans[0].header.stamp.to_nsec()), ('', 0))
        self.assertEqual(plans[1].header.frame_id, 'map')
        self.assertGreater(plans[1].header.stamp.to_nsec(), 0)
        self.assertEqual([pose.pose for pose in plans[0].poses], [pose.pose for pose in plans[1].poses])

    def test_places_that_are_too_far_apart_for_a_plan_are_refused_with_a_text(self):
        make_plan = rospy.ServiceProxy(MOVE_BASE + '/make_plan', GetPlan)
        with self.assertRaisesRegex(rospy.ServiceException, 'make_plan: pose: x must be within'):
            make_plan(pose_stamped(-1.7e308), pose_stamped(1.7e308), 0.0)

    def test_a_robot_at_the_end_of_the_world_does_no_harm(self):
        self.place(1e9)
        grid = latest('local_costmap/costmap', OccupancyGrid)
        self.assertTrue(math.isclose(grid.info.origin.position.x, 1e9, rel_tol=1e-6))
        ended = self.client.ending(self.client.send(pose_stamped(1.1e9)))
        self.assertEqual(ended.status.status, GoalStatus.ABORTED)
        self.assertIn('pose: x must be within +-1e9 m, got 1100000000.0', ended.status.text)
