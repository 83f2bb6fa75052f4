"""The positions of robots that the built-in simulator publishes: tf, topics, teleports."""
import math
import unittest

import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from robot_harness import GUARD, RawClient, Record, active_since_ns, pose_stamped, simple_client

from move_base_abstract.srv import SetPose

LAUNCH_FILE = """
<launch>  <!-- tf, pose topics and teleports of the built-in simulator -->
  <group ns="robot_0">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        max_speed: 2.0
        start_x: 1.0
        start_y: 2.0
        start_yaw: 0.5
        tf_prefix: robot_0
        backend: virtual_robots
        pose_update_freq: 0.0
      </rosparam>
    </node>
  </group>
  <group ns="robot_1">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        {max_speed: 2.0, acceleration: 0.5, turn_rate: 1.0, tf_prefix: robot_1, pose_update_freq: 5.0,
         stage_offset_x: -162.0, stage_offset_y: -110.0}
      </rosparam>
    </node>
  </group>
</launch>
"""
FACTOR = 10
OWN_NODE = 'backend_builtin_test'


class BuiltinBackend(unittest.TestCase):
    """robot_0 publishes its pose at departure and arrival only; robot_1 five times a second, with ramps and turns."""

    @classmethod
    def setUpClass(cls):
        cls.start = rospy.wait_for_message('/robot_0/amcl_pose', PoseWithCovarianceStamped, GUARD)
        cls.client = RawClient('/robot_0')
        cls.simple = simple_client('/robot_0')
        cls.buffer = tf2_ros.Buffer(debug=False)
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        rospy.wait_for_service('/robot_0/set_robot_pose', GUARD * 10)
        cls.set_pose = rospy.ServiceProxy('/robot_0/set_robot_pose', SetPose)

    def put(self, x=0.0, y=0.0, yaw=0.0):
        """Put robot_0 at (x, y, yaw) by its service [m, m, rad]."""
        answer = self.set_pose(pose_stamped(x, y, yaw))
        self.assertTrue(answer.success, answer.message)

    def test_it_stands_at_its_start_pose_for_those_who_come_late(self):
        pose = self.start.pose.pose
        self.assertEqual((self.start.header.frame_id, pose.position.x, pose.position.y), ('map', 1.0, 2.0))
        self.assertAlmostEqual(2.0 * math.atan2(pose.orientation.z, pose.orientation.w), 0.5)

    def test_all_pose_topics_agree(self):
        self.put(3.0, 4.0, 1.0)
        amcl = Record('/robot_0/amcl_pose', PoseWithCovarianceStamped).wait_for(
            lambda message: message.pose.pose.position.x == 3.0).pose.pose
        odom = Record('/robot_0/odom', Odometry).wait_for(lambda message: message.pose.pose.position.x == 3.0)
        truth = Record('/robot_0/base_pose_ground_truth', Odometry).wait_for(
            lambda message: message.pose.pose.position.x == 3.0)
        plain = Record('/robot_0/robot_pose', PoseStamped).wait_for(lambda message: message.pose.position.x == 3.0)
        self.assertEqual([odom.pose.pose, truth.pose.pose, plain.pose], [amcl, amcl, amcl])
        self.assertEqual(plain.header, truth.header)
        self.assertEqual((odom.header.frame_id, odom.child_frame_id, truth.header.frame_id),
                         ('robot_0/odom', 'robot_0/base_link', 'map'))

    def test_tf_leads_from_the_map_over_odom_to_base_link_at_the_present(self):
        self.put(5.0, -6.0)
        # This process's clock may lag behind the instant at which the robot was put there. If tf already had the old
        # place at that very instant, the new place is dated 1 ns later.
        odom = Record('/robot_0/odom', Odometry).wait_for(lambda message: message.pose.pose.position.x == 5.0)
        while rospy.Time.now() <= odom.header.stamp:
            rospy.sleep(0.01)
        for parent, child in (('map', 'robot_0/odom'), ('robot_0/odom', 'robot_0/base_link')):
            self.buffer.lookup_transform(parent, child, rospy.Time.now(), rospy.Duration(100.0))
        position = self.buffer.lookup_transform('map', 'robot_0/base_link', rospy.Time.now(),
                                                rospy.Duration(100.0)).transform.translation
        self.assertAlmostEqual(position.x, 5.0, places=9)
        self.assertAlmostEqual(position.y, -6.0, places=9)

    def test_look_ups_of_the_present_work_while_the_pose_topics_are_silent(self):
        self.put()
        odom = Record('/robot_0/odom', Odometry)
        odom.wait_for(lambda message: message.pose.pose.position.x == 0.0)
        goal_id = self.client.send(pose_stamped(400.0))
        start_ns = active_since_ns(self.client, goal_id)
        for _ in range(5):
            now = rospy.Time.now()
            found = self.buffer.lookup_transform('map', 'robot_0/base_link', now, rospy.Duration(100.0))
            expected = max(0.0, 2.0 * (now.to_nsec() - start_ns) * 1e-9)
            self.assertAlmostEqual(found.transform.translation.x, expected, places=6)
        # A late message from the test before may have come first.
        moving = [message for message in odom.messages
                  if message.pose.pose.position.x > 0.0 and message.header.stamp.to_nsec() > start_ns]
        self.assertEqual(moving, [], 'pose_update_freq 0: nothing between departure and arrival')
        self.client.cancel(goal_id)
        self.client.ending(goal_id)
        odom.wait_for(lambda message: message.pose.pose.position.x > 0.0)

    def test_pose_updates_come_on_their_grid_and_follow_the_motion_law(self):
        client = RawClient('/robot_1')
        odom = Record('/robot_1/odom', Odometry)
        odom.wait_for()
        goal_id = client.send(pose_stamped(0.0, 20.0))
        start_ns = active_since_ns(client, goal_id)
        end_ns = client.ending(goal_id).header.stamp.to_nsec()
        quarter_turn = math.pi / 2.0
        self.assertAlmostEqual((end_ns - start_ns) * 1e-9, 2 * quarter_turn + 20.0 / 2.0 + 2.0 / 0.5, places=6)
        updates = [message for message in odom.messages if start_ns < message.header.stamp.to_nsec() < end_ns]
        self.assertTrue(updates)
        for message in updates:
            elapsed_ns = message.header.stamp.to_nsec() - start_ns
            self.assertEqual(elapsed_ns % 200_000_000, 0)
            if quarter_turn < elapsed_ns * 1e-9 < quarter_turn + 4.0:
                ramp = elapsed_ns * 1e-9 - quarter_turn
                self.assertAlmostEqual(message.pose.pose.position.y, 0.25 * ramp * ramp, places=6)
                self.assertAlmostEqual(message.twist.twist.linear.x, 0.5 * ramp, places=6)

    def test_initialpose_and_set_pose_teleport(self):
        odom = Record('/robot_0/odom', Odometry)
        odom.wait_for()
        initial = PoseWithCovarianceStamped()
        initial.header.frame_id = 'map'
        initial.pose.pose = pose_stamped(8.0, 9.0).pose
        first = rospy.Publisher('/robot_0/initialpose', PoseWithCovarianceStamped, queue_size=1, latch=True)
        first.publish(initial)
        odom.wait_for(lambda message: message.pose.pose.position.x == 8.0)
        second = rospy.Publisher('/robot_0/set_pose', Pose, queue_size=1, latch=True)
        second.publish(pose_stamped(-8.0, 9.0).pose)
        odom.wait_for(lambda message: message.pose.pose.position.x == -8.0)
        first.unregister()
        second.unregister()

    def test_cmd_pose_teleports_as_in_stages_world(self):
        for robot, place in (('robot_0', (-6.0, 3.5)), ('robot_1', (-6.0 + 162.0, 3.5 + 110.0))):
            odom = Record('/{}/odom'.format(robot), Odometry)
            odom.wait_for()
            command = rospy.Publisher('/{}/cmd_pose'.format(robot), Pose, queue_size=1, latch=True)
            command.publish(pose_stamped(-6.0, 3.5).pose)
            odom.wait_for(lambda message, place=place: (
                message.pose.pose.position.x, message.pose.pose.position.y) == place)
            command.unregister()
        self.put_back('robot_1')

    @staticmethod
    def put_back(robot):
        """Put ``robot`` at the origin."""
        service = rospy.ServiceProxy('/{}/set_robot_pose'.format(robot), SetPose)
        assert service(pose_stamped()).success

    def test_a_teleport_in_base_link_is_relative_to_the_robot(self):
        self.put(1.0, 1.0, math.pi / 2.0)
        self.assertTrue(self.set_pose(pose_stamped(2.0, frame='robot_0/base_link')).success)
        Record('/robot_0/odom', Odometry).wait_for(lambda message: abs(message.pose.pose.position.y - 3.0) < 1e-9)

    def test_bad_teleports_are_refused_with_a_reason_and_move_nothing(self):
        self.put(7.0, 7.0)
        for pose, reason in ((pose_stamped(math.nan), 'x must be finite'), (pose_stamped(frame='moon'), 'moon'),
                             (pose_stamped(quaternion=(0, 0, 0, 0)), 'length close to zero')):
            answer = self.set_pose(pose)
            self.assertFalse(answer.success)
            self.assertIn(reason, answer.message)
        records = Record('/robot_0/robot_pose', PoseStamped)
        records.wait_for(lambda message: (message.pose.position.x, message.pose.position.y) == (7.0, 7.0))
        self.put(7.0, 8.0)
        records.wait_for(lambda message: message.pose.position.y == 8.0)
        self.assertEqual([(message.pose.position.x, message.pose.position.y) for message in records.messages[-2:]],
                         [(7.0, 7.0), (7.0, 8.0)])

    def test_latest_tf_is_the_robots_pose_after_a_cancel(self):
        self.put()
        goal_id = self.client.send(pose_stamped(1000.0))
        self.client.wait_for_state(goal_id, GoalStatus.ACTIVE)
        self.client.cancel(goal_id)
        stamp = self.client.ending(goal_id).header.stamp
        odom = Record('/robot_0/odom', Odometry)
        stop = odom.wait_for(lambda message: message.header.stamp == stamp).pose.pose.position.x
        later = self.buffer.lookup_transform('map', 'robot_0/base_link', stamp + rospy.Duration(0.5),
                                             rospy.Duration(100.0)).transform.translation.x
        self.assertAlmostEqual(later, stop, places=9)
