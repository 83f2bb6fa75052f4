"""The node task_server with stock clients: durations, feedback, cancels, texts, two robots in one process.

GUARD [s, simulated] only ends a test that would never end.
"""
import unittest

import rospy
import warm
from actionlib import GoalStatus, SimpleActionClient
from geometry_msgs.msg import Pose, Quaternion
from std_msgs.msg import Header

from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task, TimedTaskAction, TimedTaskGoal
from move_base_abstract.tasks.timed_task import DrawnDurations
from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = """
<launch>  <!-- two robots with tasks, at 10 times real time -->
  <include file="$(find move_base_abstract)/launch/time_master.launch">
    <arg name="factor" value="10"/>
  </include>
  <node pkg="move_base_abstract" type="task_server" name="task_server" required="true" output="screen">
    <rosparam>
      robots: [robot_0, robot_1]
      task: take_sample
      duration: 2.0
      spread: 0.5
      seed: 3
      feedback_freq: 10.0
      places: [{name: dock, capacity: 1, duration: 4.0}]
    </rosparam>
  </node>
</launch>
"""

GUARD = rospy.Duration(600.0)


class TaskServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('soil_task_server_test')
        cls.clients = [SimpleActionClient('/robot_{}/take_sample'.format(robot), TimedTaskAction) for robot in range(2)]
        for client in cls.clients:
            assert client.wait_for_server(GUARD)

    def do(self, client, seconds, feedback_cb=None):
        """Have a task of ``seconds`` done; return the result's duration [s]."""
        client.send_goal(TimedTaskGoal(duration=rospy.Duration(seconds)), feedback_cb=feedback_cb)
        self.assertTrue(client.wait_for_result(GUARD))
        return client.get_result().duration.to_sec()

    def test_a_task_takes_the_time_that_its_goal_says(self):
        self.assertEqual(self.do(self.clients[0], 3.0), 3.0)
        self.assertEqual(self.clients[0].get_state(), GoalStatus.SUCCEEDED)
        self.assertEqual(self.clients[0].get_goal_status_text(), 'Task done.')

    def test_the_servers_own_durations_are_those_of_the_seed_robot_by_robot(self):
        # This is the only test in which the server draws.
        for robot, client in enumerate(self.clients):
            drawn = DrawnDurations(2.0, 0.5, 3, robot)
            expected = [drawn.draw_ns() for _ in range(3)]
            took = []
            for _ in expected:
                self.do(client, 0.0)
                took.append(client.get_result().duration.to_nsec())
            self.assertEqual(took, expected)

    def test_feedback_tells_the_share_that_is_done(self):
        shares = []
        self.do(self.clients[0], 10.0, lambda feedback: shares.append(feedback.progress))
        self.assertGreater(len(shares), 3)
        self.assertEqual(shares, sorted(shares))
        self.assertLessEqual(shares[-1], 1.0)

    def test_a_cancelled_task_says_how_long_it_was_worked_on(self):
        client = self.clients[1]
        client.send_goal(TimedTaskGoal(duration=rospy.Duration(500.0)))
        rospy.sleep(5.0)
        client.cancel_goal()
        self.assertTrue(client.wait_for_result(GUARD))
        self.assertEqual(client.get_state(), GoalStatus.PREEMPTED)
        self.assertTrue(0.0 < client.get_result().duration.to_sec() < 100.0)

    def test_two_robots_work_at_the_same_time(self):
        began = rospy.get_time()
        for client in self.clients:
            client.send_goal(TimedTaskGoal(duration=rospy.Duration(20.0)))
        for client in self.clients:
            self.assertTrue(client.wait_for_result(GUARD))
        self.assertLess(rospy.get_time() - began, 40.0)

    def test_a_negative_duration_is_refused_with_a_text(self):
        self.do(self.clients[0], -1.0)
        self.assertEqual(self.clients[0].get_state(), GoalStatus.ABORTED)
        self.assertEqual(self.clients[0].get_goal_status_text(), 'duration must be >= 0 s, got -1 s')

    def test_at_a_place_with_room_for_one_the_second_waits_and_says_so(self):
        heard = []
        clients = [SimpleActionClient('/robot_{}/work'.format(robot), PlaceTaskAction) for robot in range(2)]
        for client in clients:
            self.assertTrue(client.wait_for_server(GUARD))
        goal = PlaceTaskGoal(Task(place='dock', duration=rospy.Duration(20.0)))
        clients[0].send_goal(goal)
        while clients[0].get_state() != GoalStatus.ACTIVE:
            rospy.sleep(0.1)
        clients[1].send_goal(PlaceTaskGoal(Task(place='dock')), feedback_cb=heard.append)
        for client in clients:
            self.assertTrue(client.wait_for_result(GUARD))
        first, second = (client.get_result() for client in clients)
        self.assertEqual((first.waited.to_sec(), first.worked.to_sec(), second.worked.to_sec()), (0.0, 20.0, 4.0))
        self.assertTrue(0.0 < second.waited.to_sec() <= 20.0)
        self.assertEqual([heard[0].is_waiting, heard[-1].is_waiting], [True, False])
        for wrong, text in ((Task(place='moon'), 'place: got moon; allowed: dock'),
                            (Task(header=Header(frame_id='odom'), pose=Pose(orientation=Quaternion(w=1.0))),
                             'frame: got odom; allowed: map'),
                            (Task(place='dock', duration=rospy.Duration(-1.0)),
                             'duration must be >= 0 s, got -1 s'), (Task(), 'pose: ')):
            clients[0].send_goal(PlaceTaskGoal(wrong))
            self.assertTrue(clients[0].wait_for_result(GUARD))
            self.assertEqual(clients[0].get_state(), GoalStatus.ABORTED)
            self.assertIn(text, clients[0].get_goal_status_text())

    def test_parameters_that_cannot_be_used_are_fatal(self):
        for parameter, text in (('_spread:=5.0', 'the spread must lie in 0..1 s, the duration; got 5.0'),
                                ('_duration:=soon', "got 'soon'; allowed: a number in 0..2147483647 [s, simulated]"),
                                ('_robots:=[a, a]', 'allowed: a list of different namespaces')):
            name = 'wrong_' + parameter[1:4]
            done = warm.run([find_executable('task_server'), parameter, '__name:=' + name])
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(text, done.stdout)
