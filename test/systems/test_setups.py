"""Existing set-ups: without a map, with remaps, with planners' groups, with rivals in tf."""
import itertools
import unittest

import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus
from dynamic_reconfigure.client import Client
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from move_base_msgs.msg import RecoveryStatus
from robot_harness import GUARD, NO_PLAN, REACHED, RawClient, Record, go, pose_stamped, simple_client
from robot_process import RobotProcess
from tf2_msgs.msg import TFMessage

LAUNCH_FILE = """
<launch>  <!-- parameters and remaps as existing move_base set-ups have them -->
  <group ns="husky">  <!-- without a map -->
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        max_speed: 2.0
        start_x: 1.0
        global_costmap: {global_frame: odom, robot_base_frame: base_link}
        local_costmap: {global_frame: odom, robot_base_frame: base_link}
      </rosparam>
    </node>
  </group>
  <group ns="remapped">  <!-- many set-ups remap the one map for the namespace of each robot like this -->
    <remap from="map" to="/maps/blocks"/>
    <param name="navigate/base_global_planner" value="global_planner/GlobalPlanner"/>
    <param name="navigate/max_speed" value="9.0"/>  <!-- the node's own name comes first -->
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <remap from="move_base" to="navigate"/>
      <rosparam>{max_speed: 2.0, use_map: true, frame_timeout: 20.0, tf_prefix: remapped}</rosparam>
    </node>
  </group>
  <group ns="maps">
    <node pkg="move_base_abstract" type="map_server" name="map_server" required="true"
          args="$(find move_base_abstract)/test/data/blocks.yaml">
      <remap from="map" to="blocks"/>
    </node>
  </group>
  <group ns="quick">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        {max_speed: 2.0, abort_policy: upstream, clearing_rotation_allowed: false, max_planning_retries: -1.0,
         world_bounds: [-10, -10, 10, 10], tf_prefix: quick}
      </rosparam>
    </node>
  </group>
</launch>
"""
FACTOR = 20
OWN_NODE = 'setups_test'

REFUSED = (GoalStatus.ABORTED, NO_PLAN)
DWA = 'dwa_local_planner/DWAPlannerROS'
_names = ('/r{}'.format(number) for number in itertools.count())


class WithoutAMap(unittest.TestCase):
    """The robot husky, whose global frame is odom."""

    def test_tf_has_one_chain_and_no_frame_is_its_own_parent(self):
        transforms = Record('/tf', TFMessage)
        buffer = tf2_ros.Buffer(debug=False)
        tf2_ros.TransformListener(buffer)
        self.assertEqual(go(simple_client('/husky'), pose_stamped(2.0, frame='odom')), REACHED)
        # Later than the first tf after the arrival: tf2 interpolates between it and the last one on the way.
        later = rospy.Time.now() + rospy.Duration(5.0)
        found = buffer.lookup_transform('odom', 'base_link', later, rospy.Duration(100.0))
        self.assertAlmostEqual(found.transform.translation.x, 2.0)
        pairs = {(transform.header.frame_id, transform.child_frame_id)
                 for message in transforms.messages for transform in message.transforms}
        self.assertIn(('odom', 'base_link'), pairs)
        self.assertEqual([pair for pair in pairs if pair[0] == pair[1] or pair[1] == 'odom'], [])
        transforms.close()

    def test_goals_in_odom_and_in_the_base_frame_are_reached(self):
        client = simple_client('/husky')
        self.assertEqual(go(client, pose_stamped(3.0, 1.0, frame='odom')), REACHED)
        self.assertEqual(go(client, pose_stamped(2.0, 0.0, frame='base_link')), REACHED)
        poses = Record('/husky/amcl_pose', PoseWithCovarianceStamped)
        message = poses.wait_for(lambda message: message.pose.pose.position.x == 5.0)
        self.assertEqual((message.header.frame_id, message.pose.pose.position.y), ('odom', 1.0))


class Remaps(unittest.TestCase):
    """The robot remapped, whose map has another name."""

    def test_the_map_is_taken_from_where_it_is_remapped_to(self):
        client = simple_client('/remapped', 'navigate')
        self.assertEqual([go(client, pose_stamped(*place)) for place in ((1.25, 0.25), (2.25, 0.25))],
                         [REACHED, REFUSED])


    def test_a_remap_of_move_base_renames_the_action_and_leaves_the_node_its_parameters(self):
        topics = {name for name, _ in rospy.get_published_topics('/remapped')}
        self.assertIn('/remapped/navigate/result', topics)
        self.assertNotIn('/remapped/move_base/result', topics)
        self.assertIn('/remapped/move_base/current_goal', topics)  # a private topic

    def test_parameters_under_the_name_that_the_remap_gives_count_behind_the_nodes_own(self):
        topics = {name for name, _ in rospy.get_published_topics('/remapped')}
        self.assertIn('/remapped/move_base/GlobalPlanner/plan', topics)
        planner = Client('/remapped/move_base/TrajectoryPlannerROS', timeout=GUARD)
        self.assertEqual(planner.get_configuration(GUARD)['max_vel_x'], 2.0)


class Recoveries(unittest.TestCase):
    """The robot quick, which may not rotate to clear its costmaps."""

    def test_giving_up_takes_no_rotations(self):
        client = RawClient('/quick')
        announced = Record.fresh('/quick/move_base/recovery_status', RecoveryStatus)
        for _ in range(2):
            self.assertEqual(client.drive(pose_stamped(50.0))[1], 15_000_000_000)
            announced.wait_for(lambda message: message.recovery_behavior_name == 'aggressive_reset')
            self.assertEqual([message.recovery_behavior_name for message in announced.messages],
                             ['conservative_reset', 'aggressive_reset'])
            announced.clear()
            # A change of another parameter does not bring rotations back.
            Client('/quick/move_base', timeout=GUARD).update_configuration({'conservative_reset_dist': 2.0})


class ParameterServer(unittest.TestCase):
    """A robot that is started, reconfigured and started again."""

    def start(self, parameters=None):
        """Start a robot that ends with the test, and return it."""
        self.namespace = getattr(self, 'namespace', None) or next(_names)
        robot = RobotProcess('move_base', parameters, (), self.namespace)
        self.addCleanup(robot.end)
        return robot

    def test_a_start_writes_nothing_and_a_restart_finds_what_the_user_wrote(self):
        group = {'max_vel_x': 1.0, 'max_vel_trans': 0.5, 'acc_lim_x': 2, 'min_vel_x': 'slow'}
        parameters = {'base_local_planner': DWA, 'DWAPlannerROS': group, 'controller_frequency': 200.0,
                      'max_planning_retries': -1.0, 'xy_goal_tolerance': 0.3}
        for given in (parameters, None):
            robot = self.start(given)
            self.assertIn('speed 0.5 m/s (~DWAPlannerROS/max_vel_trans), acceleration 2 m/s^2',
                          robot.wait_for_line('abstract robot'))
            Client(robot.private + '/DWAPlannerROS', timeout=GUARD)
            self.assertEqual(rospy.get_param(robot.private), parameters)
            robot.end()

    def test_of_dwas_two_speeds_the_smaller_counts_by_reconfigure_too(self):
        robot = self.start({'base_local_planner': DWA, 'DWAPlannerROS': {'max_vel_x': 1.0, 'max_vel_trans': 0.5}})
        client = RawClient(robot.namespace)
        planner = Client(robot.private + '/DWAPlannerROS', timeout=GUARD)
        self.assertEqual(planner.get_configuration(GUARD)['max_vel_x'], 1.0)
        place = 0.0
        for change, speed in (({}, 0.5), ({'max_vel_x': 4.0}, 0.5), ({'max_vel_trans': 8.0}, 4.0),
                              ({'max_vel_trans': 2.0}, 2.0), ({'restore_defaults': True}, 0.5)):
            if change:
                planner.update_configuration(change)
            place += 8.0
            self.assertEqual(client.drive(pose_stamped(place))[1], int(8e9 / speed), change)
        self.assertEqual(rospy.get_param(robot.private + '/DWAPlannerROS'), {'max_vel_x': 1.0, 'max_vel_trans': 0.5})

    def test_what_is_set_by_reconfigure_is_there_after_a_restart_and_nothing_else_is(self):
        robot = self.start({'base_local_planner': DWA, 'DWAPlannerROS': {'max_vel_x': 1.0}})
        planner = Client(robot.private + '/DWAPlannerROS', timeout=GUARD)
        answer = planner.update_configuration({'max_vel_x': 3.0, 'xy_goal_tolerance': 0.25})
        self.assertEqual(answer['max_vel_trans'], 3.0)
        self.assertEqual(rospy.get_param(robot.private + '/DWAPlannerROS'),
                         {'max_vel_x': 3.0, 'xy_goal_tolerance': 0.25})
        robot.end()
        self.start().wait_for_line('speed 3 m/s (~DWAPlannerROS/max_vel_x)')


class TfRivals(unittest.TestCase):
    """Another node that publishes a robot's frame."""

    def test_another_publisher_of_a_robots_frame_is_named(self):
        rival = tf2_ros.StaticTransformBroadcaster()
        transform = TransformStamped(child_frame_id='rivalled/odom')
        transform.header.frame_id, transform.header.stamp = 'map', rospy.Time.now()
        transform.transform.rotation.w = 1.0
        rival.sendTransform(transform)
        robot = RobotProcess('move_base', {'tf_prefix': 'rivalled'}, (), next(_names))
        self.addCleanup(robot.end)
        line = robot.wait_for_line('look-ups jump')
        for word in (rospy.get_name() + ' also', "'rivalled/odom'", "below 'map'"):
            self.assertIn(word, line)


class SevenArguments(unittest.TestCase):
    """The server of the original with the original's launch file, which gives all robots the same name."""

    def test_names_and_frames_come_from_the_namespace(self):
        buffer = tf2_ros.Buffer(debug=False)
        tf2_ros.TransformListener(buffer)
        for namespace, x in (('/thorvald_001', '1.0'), ('/thorvald_002', '2.0')):
            robot = RobotProcess('move_base_abstract_actionserver', None,
                                 ('thorvald_001', 'virtual_robots', '2.0', x), namespace)
            self.addCleanup(robot.end)
            self.assertEqual(go(simple_client(namespace), pose_stamped(5.0 + float(x))), REACHED)
            place = buffer.lookup_transform('map', namespace.strip('/') + '/base_link', rospy.Time(),
                                            rospy.Duration(100.0)).transform.translation.x
            self.assertGreater(place, float(x))

    def test_stage_without_offsets_is_told_of(self):
        for arguments, parameters in ((('bot', 'stage_ros'), {}), (('bot', 'stage'), {})):
            robot = RobotProcess('move_base_abstract_actionserver', parameters, arguments, next(_names))
            self.addCleanup(robot.end)
            self.assertIn('-162, -110', robot.wait_for_line('the original adds'))
        robot = RobotProcess('move_base_abstract_actionserver', {'stage_offset_x': 0.0}, ('bot', 'stage'), next(_names))
        self.addCleanup(robot.end)
        robot.wait_for_line('abstract robot')
        self.assertNotIn('the original adds', robot.output)
