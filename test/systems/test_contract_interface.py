"""Names, services, dynamic_reconfigure, frames and hopeless goals of two robots, each in a namespace of its own."""
import math
import unittest

import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus
from dynamic_reconfigure.client import Client
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped, Twist
from move_base_msgs.msg import RecoveryStatus
from nav_msgs.msg import OccupancyGrid, Odometry
from nav_msgs.srv import GetPlan, SetMap
from robot_harness import GUARD, NO_PLAN, REACHED, RawClient, Record, active_since_ns, go, pose_stamped, simple_client
from std_srvs.srv import Empty

LAUNCH_FILE = """
<launch>
  <!-- two robots under namespaces: names, services, dynamic_reconfigure, frames, goals that cannot be reached -->
  <group ns="robot_0">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        base_local_planner: dwa_local_planner/DWAPlannerROS
        base_global_planner: global_planner/GlobalPlanner
        DWAPlannerROS: {max_vel_x: 2.0, xy_goal_tolerance: 0.0}
        tf_prefix: robot_0
        world_bounds: [-1000.0, -1000.0, 1000.0, 1000.0]
      </rosparam>
    </node>
  </group>
  <group ns="robot_1">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <rosparam>
        max_speed: 2.0
        tf_prefix: robot_1
        bad_frame_policy: wait
        abort_policy: upstream
        world_bounds: [-1000.0, -1000.0, 1000.0, 1000.0]
      </rosparam>
    </node>
  </group>
</launch>
"""
FACTOR = 50
OWN_NODE = 'contract_interface_test'

OUTSIDE = 1010.0  # m, x; the world ends at 1000


def call(name, kind, *arguments):
    """Call a service that must be there."""
    rospy.wait_for_service(name, GUARD * 50)
    return rospy.ServiceProxy(name, kind)(*arguments)


class ContractInterface(unittest.TestCase):
    """robot_0 has the useful defaults, robot_1 those of upstream; both can go to x, y = -1000..1000 m."""

    @classmethod
    def setUpClass(cls):
        cls.client, cls.upstream = RawClient('/robot_0'), RawClient('/robot_1')
        cls.simple, cls.simple_upstream = simple_client('/robot_0'), simple_client('/robot_1')
        cls.buffer = tf2_ros.Buffer(debug=False)
        cls.listener = tf2_ros.TransformListener(cls.buffer)

    def home(self):
        """Drive robot_0 to the origin, heading east."""
        self.assertEqual(go(self.simple, pose_stamped()), REACHED)

    def test_make_plan_leads_from_the_robot_to_the_goal_while_idle(self):
        self.home()
        plan = call('/robot_0/move_base/make_plan', GetPlan, PoseStamped(), pose_stamped(10.0, 0.0, 1.0), 0.0).plan
        self.assertEqual((plan.header.frame_id, plan.poses[0].pose.position.x), ('', 0.0))
        self.assertEqual(plan.poses[-1].pose.position.x, 10.0)
        self.assertEqual(plan.poses[-1].header.frame_id, 'map')

    def test_make_plan_starts_where_it_is_told(self):
        plan = call('/robot_0/move_base/make_plan', GetPlan, pose_stamped(5.0, 6.0), pose_stamped(8.0, 6.0), 0.0).plan
        first = plan.poses[0].pose.position
        self.assertEqual((first.x, first.y), (5.0, 6.0))

    def test_make_plan_is_refused_while_a_goal_is_active_but_not_the_planners_own(self):
        goal_id = self.client.send(pose_stamped(900.0))
        self.client.wait_for_state(goal_id, GoalStatus.ACTIVE)
        with self.assertRaisesRegex(rospy.ServiceException, 'must be in an inactive state to make a plan'):
            call('/robot_0/move_base/make_plan', GetPlan, PoseStamped(), pose_stamped(1.0), 0.0)
        plan = call('/robot_0/move_base/GlobalPlanner/make_plan', GetPlan, PoseStamped(), pose_stamped(1.0), 0.0).plan
        self.assertEqual(plan.poses[-1].pose.position.x, 1.0)
        call('/robot_0/move_base/clear_costmaps', Empty)
        self.assertEqual(self.client.endings(goal_id), [])
        self.client.cancel(goal_id)
        self.client.ending(goal_id)

    def test_make_plan_refuses_poses_that_are_none(self):
        for bad in (pose_stamped(math.nan), pose_stamped(frame='moon'), pose_stamped(quaternion=(0, 0, 0, 0))):
            with self.assertRaises(rospy.ServiceException):
                call('/robot_0/move_base/make_plan', GetPlan, PoseStamped(), bad, 0.0)

    def test_a_reconfigured_speed_counts_at_once_and_tolerances_on_the_next_leg(self):
        self.home()
        planner = Client('/robot_0/move_base/DWAPlannerROS', timeout=GUARD)
        goal_id = self.client.send(pose_stamped(400.0))
        start_ns = active_since_ns(self.client, goal_id)
        planner.update_configuration({'max_vel_x': 4.0, 'xy_goal_tolerance': 20.0, 'yaw_goal_tolerance': 6.28})
        took_ns = self.client.ending(goal_id).header.stamp.to_nsec() - start_ns
        self.assertTrue(95_000_000_000 <= took_ns < 190_000_000_000, took_ns)  # 400 m at 2 m/s, the rest but 20 m at 4
        self.assertEqual(self.client.drive(pose_stamped(0.0))[1], 90_000_000_000)  # 380 m, less 20
        answer = planner.update_configuration({'max_vel_x': 0.0})
        self.assertEqual(answer['max_vel_x'], 4.0, 'a speed of 0 is refused')
        planner.update_configuration({'max_vel_trans': 2.0, 'xy_goal_tolerance': 0.0, 'yaw_goal_tolerance': 0.0,
                                      'acc_lim_x': 0.0})

    def test_all_fields_that_clients_set_are_accepted(self):
        move_base = Client('/robot_1/move_base', timeout=GUARD)
        answer = move_base.update_configuration({'planner_frequency': 1.0, 'oscillation_timeout': 10.0,
                                                 'controller_frequency': 10.0, 'clearing_rotation_allowed': False})
        self.assertEqual((answer['controller_frequency'], answer['oscillation_timeout']), (10.0, 10.0))
        planner = Client('/robot_1/move_base/TrajectoryPlannerROS', timeout=GUARD)
        answer = planner.update_configuration({'max_vel_theta': 1.5, 'min_in_place_vel_theta': 0.2, 'sim_time': 2.0})
        self.assertEqual((answer['max_vel_theta'], answer['max_vel_x']), (1.5, 2.0))
        dwa = Client('/robot_0/move_base/DWAPlannerROS', timeout=GUARD)
        self.assertEqual(dwa.update_configuration({'max_vel_theta': 0.9, 'vx_samples': 5})['vx_samples'], 5)

    def test_a_goal_in_a_frame_of_tf_is_transformed(self):
        self.home()
        broadcaster = tf2_ros.StaticTransformBroadcaster()
        dock = TransformStamped(child_frame_id='dock')
        dock.header.frame_id = 'map'
        dock.transform.translation.x, dock.transform.rotation.w = 5.0, 1.0
        broadcaster.sendTransform(dock)
        odom = Record('/robot_0/odom', Odometry)
        self.assertEqual(go(self.simple, pose_stamped(1.0, 2.0, frame='dock')), REACHED)
        odom.wait_for(lambda message: (message.pose.pose.position.x, message.pose.pose.position.y) == (6.0, 2.0))

    def test_current_goal_has_the_height_and_the_orientation_that_were_sent(self):
        self.home()
        shown = Record.fresh('/robot_0/move_base/current_goal', PoseStamped)
        self.addCleanup(shown.close)
        goal = pose_stamped(2.0, quaternion=(0.01, 0.0, 0.0, 2.0))
        goal.pose.position.z = 0.75
        self.assertEqual(go(self.simple, goal), REACHED)
        told = shown.wait_for()
        self.assertEqual(told.pose, goal.pose)
        self.assertEqual(told.header.frame_id, 'map')

    def test_the_services_of_amcl_tell_the_pose_once_more_and_place_the_robot(self):
        self.home()
        poses = Record('/robot_0/amcl_pose', PoseWithCovarianceStamped)
        self.addCleanup(poses.close)
        before = poses.wait_for().header.stamp
        call('/robot_0/global_localization', Empty)
        call('/robot_0/request_nomotion_update', Empty)
        again = poses.wait_for(lambda message: message.header.stamp > before).pose.pose.position
        self.assertEqual((again.x, again.y), (0.0, 0.0))
        there = PoseWithCovarianceStamped()
        there.header.frame_id, there.pose.pose.position.x, there.pose.pose.orientation.w = 'map', 7.0, 1.0
        self.assertTrue(call('/robot_0/set_map', SetMap, OccupancyGrid(), there).success)
        poses.wait_for(lambda message: message.pose.pose.position.x == 7.0)
        there.header.frame_id = 'moon'
        self.assertFalse(call('/robot_0/set_map', SetMap, OccupancyGrid(), there).success)

    def test_unknown_frames_abort_with_a_text_that_names_them(self):
        for frame, hint in (('moon', 'moon'), ('/map', "did you mean 'map'"), ('', 'the frame_id is empty')):
            state, text = go(self.simple, pose_stamped(1.0, frame=frame))
            self.assertEqual(state, GoalStatus.ABORTED)
            self.assertIn("Failed to transform the goal pose from '{}' into the 'map' frame".format(frame), text)
            self.assertIn(hint, text)

    def test_a_goal_out_of_reach_takes_upstreams_time_where_that_is_configured(self):
        recoveries = Record.fresh('/robot_1/move_base/recovery_status', RecoveryStatus)
        self.addCleanup(recoveries.close)
        two_turns_ns = 2 * round(2e9 * math.pi)
        self.assertEqual(self.upstream.drive(pose_stamped(OUTSIDE)),
                         ((GoalStatus.ABORTED, NO_PLAN), 25_000_000_000 + two_turns_ns))
        recoveries.wait_for(lambda status: status.current_recovery_number == 3)
        self.assertEqual([(status.current_recovery_number, status.total_number_of_recoveries,
                           status.recovery_behavior_name) for status in recoveries.messages],
                         [(0, 4, 'conservative_reset'), (1, 4, 'rotate_recovery'), (2, 4, 'aggressive_reset'),
                          (3, 4, 'rotate_recovery')])

    def test_without_recoveries_a_goal_out_of_reach_takes_the_patience_only(self):
        move_base = Client('/robot_1/move_base', timeout=GUARD)
        move_base.update_configuration({'recovery_behavior_enabled': False})
        self.assertEqual(self.upstream.drive(pose_stamped(OUTSIDE))[1], 5_000_000_000)
        move_base.update_configuration({'recovery_behavior_enabled': True})

    def test_robots_do_not_hear_each_others_goals(self):
        self.home()
        other = Record('/robot_1/odom', Odometry)
        stood = other.wait_for().pose.pose
        self.assertEqual(go(self.simple, pose_stamped(3.0)), REACHED)
        arrived = rospy.Time.now()
        other.wait_for(lambda message: message.header.stamp > arrived)
        self.assertEqual({str(message.pose.pose) for message in other.messages}, {str(stood)})
        self.assertEqual({str(message.twist.twist) for message in other.messages}, {str(Twist())})
