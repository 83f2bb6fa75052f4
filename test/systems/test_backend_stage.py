"""The backend for Stage, with a stand-in that has the topics of stage_ros: poses out, truth in, a whole tf tree."""
import threading
import time
import unittest

import rosgraph
import rospy
import tf2_ros
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from robot_harness import GUARD, REACHED, Record, go, pose_stamped, simple_client, to_transform, warned
from rosgraph_msgs.msg import Clock, Log

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_ros.messages import conversions

LAUNCH_FILE = """
<launch>  <!-- the backend stage_ros with a stand-in for Stage in the test, since Debian has neither simulator -->
  <include file="$(find move_base_abstract)/launch/time_master.launch">
    <arg name="factor" value="2"/>
    <arg name="start_time" value="200"/>
  </include>
  <group ns="robot_0">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        backend: stage_ros
        tf_prefix: robot_0
        max_speed: 2.0
        start_x: 1.0
        start_y: 2.0
        stage_offset_x: -10.0
        stage_offset_y: 5.0
        stage_offset_yaw: 1.5707963267948966
      </rosparam>
    </node>
  </group>
  <group ns="robot_1">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        {backend: stage, tf_prefix: robot_1, max_speed: 2.0, start_x: 3.0, stage_world_frame: stage_world}
      </rosparam>
    </node>
  </group>
  <group ns="robot_2">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>{backend: stage_ros, tf_prefix: robot_2, max_speed: 2.0, start_x: 7.0}</rosparam>
    </node>
  </group>
</launch>
"""
OWN_NODE = 'stageros'

QUARTER_TURN = 1.5707963267948966
PERIOD = 0.05  # s, wall
BEHIND_NS = 141_200_000_000  # the clock of robot_2's Stage is behind /clock by this


class Stage:
    """One robot of stage_ros: it goes to cmd_pose and publishes its true pose, its odometry and odom -> base_link.

    Like that of Stage, its odometry starts where the robot started and does not notice if the robot is moved.
    """

    ODOMETRY = Pose2D(0.5, 0.25, 0.1)

    def __init__(self, name, behind_ns=0):
        self.name = name
        self._behind_ns = behind_ns
        self.follows = True
        self.is_silent = False
        self._pose = Pose2D()
        self._truth = rospy.Publisher(f'/{name}/base_pose_ground_truth', Odometry, queue_size=10)
        self._odom = rospy.Publisher(f'/{name}/odom', Odometry, queue_size=10)
        self._tf = tf2_ros.TransformBroadcaster()
        rospy.Subscriber(f'/{name}/cmd_pose', Pose, self._on_cmd_pose, queue_size=10)
        threading.Thread(target=self._run, daemon=True).start()

    def _on_cmd_pose(self, message):
        if self.follows:
            self._pose = conversions.from_pose(message)

    def _run(self):
        last_ns = 0
        while not rospy.is_shutdown():
            time.sleep(PERIOD)
            stamp_ns = rospy.Time.now().to_nsec() - self._behind_ns
            if stamp_ns > last_ns and not self.is_silent:
                last_ns = stamp_ns
                self._tell(stamp_ns)

    def _tell(self, stamp_ns):
        odom, base = f'{self.name}/odom', f'{self.name}/base_link'
        self._tf.sendTransform([to_transform(self.ODOMETRY, odom, base, stamp_ns)])
        for publisher, frame, pose in ((self._odom, odom, self.ODOMETRY), (self._truth, '/truth', self._pose)):
            message = Odometry(header=conversions.to_header(frame, stamp_ns))
            message.pose.pose = conversions.to_pose(pose)
            publisher.publish(message)


class StageBackend(unittest.TestCase):
    """robot_0 gets the offset of Stage's world by parameters, robot_1 by tf. The Stage of robot_2 has another clock."""

    @classmethod
    def setUpClass(cls):
        # Stage advertises /clock. This stand-in publishes nothing on it, since two clocks would make time jump.
        cls.clock = rospy.Publisher('/clock', Clock, queue_size=1)
        cls.log = Record('/rosout', Log)
        cls.commands = [Record(f'/robot_{k}/cmd_pose', Pose) for k in (0, 1)]
        cls.simple = simple_client('/robot_0')
        cls.stages = [Stage('robot_0'), Stage('robot_1'), Stage('robot_2', BEHIND_NS)]
        cls.buffer = tf2_ros.Buffer(debug=False)
        cls.listener = tf2_ros.TransformListener(cls.buffer)

    def assert_at(self, pose, x, y, yaw):
        found = conversions.from_pose(pose)
        self.assertAlmostEqual(found.x, x, places=6)
        self.assertAlmostEqual(found.y, y, places=6)
        self.assertAlmostEqual(found.yaw, yaw, places=6)

    def wait_for_tf(self, child, x, y):
        """Wait until tf has ``child`` at (x, y) in the map [m]; return its transform."""
        deadline = time.monotonic() + GUARD
        position = None
        while time.monotonic() < deadline:
            if self.buffer.can_transform('map', child, rospy.Time()):
                position = self.buffer.lookup_transform('map', child, rospy.Time()).transform.translation
                if abs(position.x - x) + abs(position.y - y) < 1e-6:
                    return
            time.sleep(PERIOD)
        self.fail(f'{child} did not come to ({x}, {y}) in the map; tf has it at {position}')

    def test_1_stage_is_told_the_start_pose_in_its_own_world(self):
        self.assert_at(self.commands[0].wait_for(), -12.0, 6.0, QUARTER_TURN)

    def test_2_everybody_else_is_told_poses_in_the_map(self):
        amcl = Record('/robot_0/amcl_pose', PoseWithCovarianceStamped).wait_for()
        self.assertEqual(amcl.header.frame_id, 'map')
        self.assert_at(amcl.pose.pose, 1.0, 2.0, 0.0)
        self.assert_at(Record('/robot_0/robot_pose', PoseStamped).wait_for().pose, 1.0, 2.0, 0.0)

    def test_3_a_goal_moves_the_robot_in_stage_and_tf_follows_stages_truth(self):
        self.assertEqual(go(self.simple, pose_stamped(4.0, 6.0)), REACHED)
        self.commands[0].wait_for(lambda pose: abs(pose.position.x + 16.0) + abs(pose.position.y - 9.0) < 1e-6)
        self.wait_for_tf('robot_0/base_link', 4.0, 6.0)

    def test_3_stage_is_told_as_an_answer_to_its_truth_only(self):
        self.stages[0].is_silent = True
        time.sleep(1.0)  # until the messages under way have come
        self.commands[0].clear()
        self.assertEqual(go(self.simple, pose_stamped(4.0, 9.0)), REACHED)
        self.assertEqual(self.commands[0].messages, [])
        truths = Record(f'/{self.stages[0].name}/base_pose_ground_truth', Odometry)
        self.stages[0].is_silent = False
        self.wait_for_tf('robot_0/base_link', 4.0, 9.0)
        heard = len(truths.messages)
        truths.wait_for(lambda _: len(truths.messages) > heard + 10)
        self.assertIn(len(self.commands[0].messages), (1, 2, 3))  # some answers may cross; at rest there is none
        self.assertEqual(go(self.simple, pose_stamped(4.0, 6.0)), REACHED)
        self.wait_for_tf('robot_0/base_link', 4.0, 6.0)

    def test_4_what_stage_publishes_is_left_to_it(self):
        published = dict(rosgraph.Master('/test').getSystemState()[0])
        for topic in ('odom', 'base_pose_ground_truth'):
            self.assertEqual(published[f'/robot_0/{topic}'], [rospy.get_name()])
        for parent, child in (('map', 'robot_0/odom'), ('robot_0/odom', 'robot_0/base_link')):
            self.assertTrue(self.buffer.can_transform(parent, child, rospy.Time()))

    def test_5_an_offset_by_tf_is_used_once_it_is_known(self):
        self.assertEqual(self.commands[1].messages, [])
        tf = tf2_ros.StaticTransformBroadcaster()
        tf.sendTransform(to_transform(Pose2D(100.0, 50.0), 'map', 'stage_world', 1))
        self.assert_at(self.commands[1].wait_for(), -97.0, -50.0, 0.0)
        self.wait_for_tf('robot_1/base_link', 3.0, 0.0)
        self.assertTrue(self.stages[1].follows)

    def test_6_a_stage_that_does_not_follow_is_told_of_once(self):
        self.stages[0].follows = False
        go(self.simple, pose_stamped(20.0, 6.0))
        text = warned(self.log, 'robot_0', 'Stage does not follow')
        self.assertIn('16.00 m', text)
        self.assertNotIn('no node subscribes', text)
        time.sleep(3.0)
        told = [entry for entry in self.log.messages if 'does not follow' in entry.msg]
        self.assertEqual(len(told), 1, told)
        self.wait_for_tf('robot_0/base_link', 4.0, 6.0)

    def test_7_a_second_clock_is_warned_about_by_name(self):
        """The node warns at Stage's first message, so before the other tests act on it."""
        found = [entry.msg for entry in self.log.messages if '/clock is published by' in entry.msg]
        self.assertTrue(found, 'no warning')
        for text in found:
            self.assertIn('/time_master', text)
            self.assertIn(rospy.get_name(), text)
            self.assertIn('time_master:=false', text)

    def test_8_a_stage_with_another_clock_is_told_of_and_tf_is_dated_as_it_dates(self):
        text = warned(self.log, 'robot_2: Stage dates its odometry', 's before /clock')
        self.assertGreaterEqual(float(text.split('odometry ')[1].split()[0]), BEHIND_NS // 10 ** 9)
        self.wait_for_tf('robot_2/base_link', 7.0, 0.0)
