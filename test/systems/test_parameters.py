"""Parameters and arguments of a robot: start-up lines, warnings, errors, exit codes, last words."""
import itertools
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from robot_harness import GUARD, RawClient, Record, pose_stamped
from robot_process import RobotProcess

LAUNCH_FILE = '<launch></launch>'
FACTOR = 20
OWN_NODE = 'parameters_test'

_names = ('/r{}'.format(number) for number in itertools.count())


class Parameters(unittest.TestCase):
    """Each test starts robots under names of their own."""

    def start(self, executable, parameters=None, arguments=(), namespace=None):
        """Start a node that is ended with the test."""
        node = RobotProcess(executable, parameters, arguments, next(_names) if namespace is None else namespace)
        self.addCleanup(node.end)
        return node

    def refused(self, parameters, *words):
        """Assert that a robot with ``parameters`` ends with a fatal error that holds ``words``."""
        node = self.start('move_base', parameters)
        self.assertEqual(node.exit_code(), 1, node.output)
        line = node.wait_for_line('FATAL')
        for word in (node.private, *words):
            self.assertIn(word, line)
        self.assertNotIn('Traceback', node.output)

    def test_the_start_line_says_where_speed_and_acceleration_come_from(self):
        for parameters, words in (
                ({}, ('speed 0.5 m/s (default)', 'acceleration unlimited (default)')),
                ({'max_speed': 3, 'acceleration': 1.5}, ('speed 3 m/s (~max_speed)', '1.5 m/s^2 (~acceleration)')),
                ({'base_local_planner': 'dwa_local_planner/DWAPlannerROS',
                  'DWAPlannerROS': {'max_vel_trans': 0.8, 'acc_lim_x': 2.5}},
                 ('speed 0.8 m/s (~DWAPlannerROS/max_vel_trans)', '2.5 m/s^2 (~DWAPlannerROS/acc_lim_x)')),
                ({'TrajectoryPlannerROS': {'max_vel_x': 0.45}}, ('speed 0.45 m/s (~TrajectoryPlannerROS/max_vel_x)',))):
            line = self.start('move_base', parameters).wait_for_line('abstract robot')
            for word in words:
                self.assertIn(word, line)

    def test_upstreams_parameters_are_counted_once_and_mistakes_are_named(self):
        node = self.start('move_base', {
            'global_costmap': {'width': 10, 'inflation_layer': {'inflation_radius': 0.5}}, 'shutdown_costmaps': False,
            'DWAPlannerROS': {'max_vel_x': 1.0, 'sim_time': 1.7}, 'max_sped': 2.0})
        self.assertIn(': 4 parameters of costmaps', node.wait_for_line('are ignored'))
        self.assertIn("/max_sped: unknown, not used; did you mean 'max_speed'?", node.wait_for_line('max_sped'))

    def test_wrong_types_and_impossible_values_are_fatal_and_say_what_is_allowed(self):
        self.refused({'max_speed': 'fast'}, '/max_speed', "'fast'", 'a finite number > 0')
        self.refused({'DWAPlannerROS': {'max_vel_x': -1.0}}, '/DWAPlannerROS/max_vel_x', '-1.0')
        self.refused({'backend': 'gazeboo'}, '/backend', "'gazeboo'", 'builtin')

    def test_a_planners_parameter_of_a_wrong_type_that_is_not_used_does_no_harm(self):
        node = self.start('move_base', {'TrajectoryPlannerROS': {'sim_time': 'long'}, 'oscillation_timeout': 'never'})
        RawClient(node.namespace)
        self.assertIn("'long'", node.wait_for_line('sim_time'))

    def test_a_killed_node_says_so_to_its_client(self):
        node = self.start('move_base', {'max_speed': 1.0})
        client = RawClient(node.namespace)
        goal_id = client.send(pose_stamped(1000.0))
        client.wait_for_state(goal_id, GoalStatus.ACTIVE)
        node.end()
        ended = client.ending(goal_id)
        self.assertEqual((ended.status.status, ended.status.text),
                         (GoalStatus.ABORTED, 'Aborting on the goal because the node has been killed'))

    def test_the_original_packages_seven_arguments_and_any_prefix_of_them(self):
        arguments = ('bot', 'virtual_robots', '4.0', '1.0', '2.0', '0', '0.0')
        for count in (0, 1, 3, 5, 7):
            namespace = next(_names)
            node = self.start('move_base_abstract_actionserver', None, arguments[:count], namespace)
            pose = rospy.wait_for_message(namespace + '/amcl_pose', PoseWithCovarianceStamped, GUARD).pose.pose
            self.assertEqual((pose.position.x, pose.position.y), (1.0 if count > 3 else 0.0,
                                                                  2.0 if count > 4 else 0.0))
            speed = 4.0 if count > 2 else 0.5
            client = RawClient(namespace)
            self.assertEqual(client.drive(pose_stamped(pose.position.x + 8.0, pose.position.y))[1], int(8e9 / speed))
            node.end()

    def test_with_the_originals_profile_legs_take_as_long_as_there_and_robot_pose_is_heard(self):
        namespace = next(_names)
        rospy.set_param(namespace + '/compatible_with', 'move_base_abstract')
        node = self.start('move_base_abstract_actionserver', None, ('bot', 'virtual_robots', '2.0', '0', '0', '0.1',
                                                                    '0.1'), namespace)
        poses = Record(namespace + '/robot_pose', PoseStamped)
        self.addCleanup(poses.close)
        poses.wait_for()
        place = rospy.Publisher(namespace + '/robot_pose', PoseStamped, queue_size=1, latch=True)
        place.publish(pose_stamped(10.0))
        amcl = Record(namespace + '/amcl_pose', PoseWithCovarianceStamped)
        self.addCleanup(amcl.close)
        amcl.wait_for(lambda message: message.pose.pose.position.x == 10.0)
        client = RawClient(namespace)
        self.assertEqual(client.drive(pose_stamped(50.0))[1], 30_000_000_000)
        node.wait_for_line("40.0 m at 2 m/s with 0.1 m/s^2: 30.0 s by the original's formula, 40.0 s exact")

    def test_the_profile_of_the_originals_branch_has_poses_without_a_header(self):
        node = self.start('move_base', {'compatible_with': 'move_base_abstract_rasberry', 'start_x': 3.0})
        self.assertEqual(rospy.wait_for_message(node.namespace + '/robot_pose', Pose, GUARD).position.x, 3.0)
        place = rospy.Publisher(node.namespace + '/robot_pose', Pose, queue_size=1, latch=True)
        place.publish(pose_stamped(7.0).pose)
        amcl = Record(node.namespace + '/amcl_pose', PoseWithCovarianceStamped)
        self.addCleanup(amcl.close)
        amcl.wait_for(lambda message: message.pose.pose.position.x == 7.0)

    def test_bad_arguments_are_fatal(self):
        for arguments, word in ((('bot', 'virtual_robots', 'quick'), "'quick'"), (('bot',) * 8, 'at most 7'),
                                (('bot', 'morse'), "'morse'")):
            node = self.start('move_base_abstract_actionserver', None, arguments, next(_names))
            self.assertEqual(node.exit_code(), 1, node.output)
            node.wait_for_line(word)
            self.assertNotIn('Traceback', node.output)
