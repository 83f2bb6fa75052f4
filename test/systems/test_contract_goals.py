"""States, texts and stamps of goals: accepted, reached, cancelled, replaced, stale, repeated, faulty."""
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import MoveBaseActionFeedback
from nav_msgs.msg import Odometry
from robot_harness import (
    ACCEPTED,
    ANOTHER_GOAL,
    BAD_QUATERNION,
    REACHED,
    SPEED,
    RawClient,
    Record,
    active_since_ns,
    go,
    pose_stamped,
    simple_client,
)

LAUNCH_FILE = """
<launch>  <!-- the life cycle of goals as move_base's clients know it, by raw topics and stock clients -->
  <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
    <param name="max_speed" value="2.0"/>
  </node>
</launch>
"""
FACTOR = 20
OWN_NODE = 'contract_goals_test'

NAN = float('nan')
FAR = 2000.0  # m; long enough to be still under way when the test acts


class ContractGoals(unittest.TestCase):
    """One robot at 2 m/s, constant speed."""

    @classmethod
    def setUpClass(cls):
        cls.client = RawClient()
        cls.simple = simple_client()

    def setUp(self):
        self.assertEqual(go(self.simple, pose_stamped()), REACHED)
        # The result may overtake earlier messages of other topics, since it has its own connection: begin anew.
        self.odom = self.fresh('/odom', Odometry)
        self.odom.wait_for()  # latched
        self.cmd_vel = self.fresh('/cmd_vel', Twist)
        self.current_goal = self.fresh('/move_base/current_goal', PoseStamped)
        for record in (self.client.status, self.client.result, self.odom):
            record.clear()

    def fresh(self, topic, kind):
        """Return a record of the messages from now on, for the length of the test."""
        record = Record.fresh(topic, kind)
        self.addCleanup(record.close)
        return record

    def test_a_goal_is_accepted_and_reached_after_exactly_distance_over_speed(self):
        goal_id = 'a goal'
        self.assertEqual(self.client.drive(pose_stamped(20.0), goal_id), (REACHED, 10_000_000_000))
        self.client.wait_for_state(goal_id, GoalStatus.SUCCEEDED)
        self.assertEqual(self.client.states(goal_id), [GoalStatus.ACTIVE, GoalStatus.SUCCEEDED])
        _, entry = self.client.wait_for_state(goal_id, GoalStatus.ACTIVE)
        self.assertEqual(entry.text, ACCEPTED)

    def test_the_pose_of_the_arrival_bears_the_stamp_of_the_result(self):
        goal_id = self.client.send(pose_stamped(7.0, 3.0, 1.0))
        result = self.client.ending(goal_id)
        arrival = self.odom.wait_for(lambda odom: odom.header.stamp == result.header.stamp)
        self.assertEqual((arrival.pose.pose.position.x, arrival.pose.pose.position.y), (7.0, 3.0))
        self.assertEqual(arrival.twist.twist.linear.x, 0.0)

    def test_cancel_ends_preempted_with_an_empty_text_at_the_exact_pose(self):
        goal_id = self.client.send(pose_stamped(FAR))
        start_ns = active_since_ns(self.client, goal_id)
        self.client.cancel(goal_id)
        result = self.client.ending(goal_id)
        self.assertEqual((result.status.status, result.status.text), (GoalStatus.PREEMPTED, ''))
        elapsed_ns = result.header.stamp.to_nsec() - start_ns
        stop = self.odom.wait_for(lambda odom: odom.header.stamp == result.header.stamp)
        self.assertAlmostEqual(stop.pose.pose.position.x, SPEED * elapsed_ns * 1e-9, places=9)
        self.assertIn(GoalStatus.PREEMPTING, self.client.states(goal_id))

    def test_cancel_by_time_cancels_goals_stamped_at_or_before_it(self):
        stamp = rospy.Time.now()
        goal_id = self.client.send(pose_stamped(FAR), stamp=stamp)
        self.client.wait_for_state(goal_id, GoalStatus.ACTIVE)
        self.client.cancel(stamp=stamp)
        self.assertEqual(self.client.ending(goal_id).status.status, GoalStatus.PREEMPTED)

    def assert_stood(self):
        """Assert that no odometry since the last clearing has another pose than the start, or any speed."""
        for odom in self.odom.messages:
            place, speed = odom.pose.pose.position, odom.twist.twist
            self.assertEqual((place.x, place.y), (0.0, 0.0), 'the robot moved')
            self.assertEqual((speed.linear.x, speed.angular.z), (0.0, 0.0), 'the robot moves')

    def test_a_cancel_before_its_goal_recalls_the_goal(self):
        self.client.cancel('early_bird')
        self.client.wait_for_state('early_bird', GoalStatus.RECALLING)
        self.client.send(pose_stamped(FAR), 'early_bird')
        self.assertEqual(self.client.ending('early_bird').status.status, GoalStatus.RECALLED)
        self.assert_stood()

    def test_a_new_goal_preempts_the_old_one_and_starts_at_its_exact_pose(self):
        first = self.client.send(pose_stamped(FAR))
        first_ns = active_since_ns(self.client, first)
        second = self.client.send(pose_stamped(FAR, 10.0))
        second_ns = active_since_ns(self.client, second)
        ended = self.client.ending(first)
        self.assertEqual((ended.status.status, ended.status.text), (GoalStatus.PREEMPTED, ANOTHER_GOAL))
        self.assertEqual(ended.header.stamp.to_nsec(), second_ns)
        turn = self.odom.wait_for(lambda odom: odom.header.stamp.to_nsec() == second_ns)
        self.assertAlmostEqual(turn.pose.pose.position.x, SPEED * (second_ns - first_ns) * 1e-9, places=9)
        self.client.cancel(second)
        self.client.ending(second)
        self.current_goal.wait_for(lambda goal: goal.pose.position.y == 10.0)
        self.assertEqual([goal.pose.position.y for goal in self.current_goal.messages], [0.0, 10.0])

    def test_a_goal_without_id_gets_one_with_the_present_as_its_stamp(self):
        self.client.send(pose_stamped(2.0), goal_id='')
        result = self.client.result.wait_for()
        self.assertTrue(result.status.goal_id.id.startswith('/move_base-'), result.status.goal_id.id)
        self.assertEqual(result.header.stamp.to_nsec() - result.status.goal_id.stamp.to_nsec(), 1_000_000_000)

    def test_a_bad_quaternion_while_a_goal_is_active_ends_both_without_stopping_the_wheels(self):
        first = self.client.send(pose_stamped(FAR))
        self.client.wait_for_state(first, GoalStatus.ACTIVE)
        self.cmd_vel.wait_for()
        self.cmd_vel.clear()
        second = self.client.send(pose_stamped(1.0, quaternion=(0.0, 0.0, 0.0, 0.0)))
        ended = self.client.ending(second)
        self.assertEqual((ended.status.status, ended.status.text), (GoalStatus.ABORTED, BAD_QUATERNION))
        self.assertEqual(self.client.endings(first), [(GoalStatus.PREEMPTED, ANOTHER_GOAL)])
        third = self.client.send(pose_stamped(0.0))
        self.client.ending(third)
        self.cmd_vel.wait_for(lambda _twist: len(self.cmd_vel.messages) >= 2)
        self.assertEqual(len(self.cmd_vel.messages), 2, 'only the third goal stops the wheels, at start and end')

    def test_wheels_are_stopped_at_start_and_at_the_end(self):
        self.client.ending(self.client.send(pose_stamped(2.0)))
        self.cmd_vel.wait_for(lambda _twist: len(self.cmd_vel.messages) >= 2)
        self.assertEqual(self.cmd_vel.messages, [Twist(), Twist()])

    def test_rviz_goals_go_through_the_action(self):
        publisher = rospy.Publisher('/move_base_simple/goal', PoseStamped, queue_size=1, latch=True)
        publisher.publish(pose_stamped(3.0))
        result = self.client.result.wait_for()
        self.assertEqual((result.status.status, result.status.text), REACHED)
        self.assertEqual(self.current_goal.wait_for().pose.position.x, 3.0)
        publisher.unregister()

    def test_feedback_is_in_the_map_on_the_grid_of_20_hz_of_simulated_time_and_ends_at_the_goal(self):
        feedback = Record('/move_base/feedback', MoveBaseActionFeedback)
        self.client.ending(self.client.send(pose_stamped(0.5)))
        goal_id = self.client.send(pose_stamped(40.0))
        start_ns = active_since_ns(self.client, goal_id)
        end_ns = self.client.ending(goal_id).header.stamp.to_nsec()
        last = feedback.wait_for(lambda message: message.header.stamp.to_nsec() == end_ns)
        self.assertEqual(last.feedback.base_position.pose.position.x, 40.0)
        self.assertEqual(last.status.status, GoalStatus.ACTIVE)
        mine = [message for message in feedback.messages if message.status.goal_id.id == goal_id]
        self.assertEqual(mine[-1], last)
        for message in mine:
            position = message.feedback.base_position
            elapsed_ns = position.header.stamp.to_nsec() - start_ns
            self.assertEqual(position.header.frame_id, 'map')
            self.assertEqual(elapsed_ns % 50_000_000, 0)
            self.assertAlmostEqual(position.pose.position.x, 0.5 + SPEED * elapsed_ns * 1e-9, places=9)
