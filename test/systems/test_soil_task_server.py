"""The node task_server with stock clients: durations, feedback, cancels, texts, two robots in one process.

GUARD [s, simulated] only ends a test that would never end.
"""
import unittest

import rospy
import warm
from actionlib import GoalStatus, SimpleActionClient
from geometry_msgs.msg import Pose, Quaternion
from std_msgs.msg import Header

from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task
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


def task_of(seconds):
    """Return a goal: a task of that duration where the robot stands."""
    return PlaceTaskGoal(Task(duration=rospy.Duration(seconds)))


class TaskServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('soil_task_server_test')
        cls.clients = [SimpleActionClient('/robot_{}/take_sample'.format(robot), PlaceTaskAction) for robot in range(2)]
        for client in cls.clients:
            assert client.wait_for_server(GUARD)

    def do(self, client, seconds, feedback_cb=None):
        """Have a task of ``seconds`` done; return how long the robot worked [s]."""
        client.send_goal(task_of(seconds), feedback_cb=feedback_cb)
        self.assertTrue(client.wait_for_result(GUARD))
        return client.get_result().worked.to_sec()

    def test_a_task_takes_the_time_that_its_goal_says(self):
        self.assertEqual(self.do(self.clients[0], 3.0), 3.0)
        self.assertEqual(self.clients[0].get_state(), GoalStatus.SUCCEEDED)
        self.assertEqual(self.clients[0].get_goal_status_text(), 'Task done.')

    def test_a_task_without_a_duration_takes_that_of_the_server(self):
        for client in self.clients:
            self.assertTrue(1.5 <= self.do(client, 0.0) <= 2.5)

    def test_feedback_tells_the_share_that_is_done(self):
        shares = []
        self.do(self.clients[0], 10.0, lambda feedback: shares.append(feedback.progress))
        self.assertGreater(len(shares), 3)
        self.assertEqual(shares, sorted(shares))
        self.assertLessEqual(shares[-1], 1.0)

    def test_a_cancelled_task_says_how_long_it_was_worked_on(self):
        client = self.clients[1]
        client.send_goal(task_of(500.0))
        rospy.sleep(5.0)
        client.cancel_goal()
        self.assertTrue(client.wait_for_result(GUARD))
        self.assertEqual(client.get_state(), GoalStatus.PREEMPTED)
        self.assertTrue(0.0 < client.get_result().worked.to_sec() < 100.0)

    def test_at_a_place_with_room_for_one_the_second_waits_and_says_so(self):
        heard = []
        clients = self.clients
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
                             'duration must be >= 0 s, got -1 s'),
                            (Task(pose=Pose(orientation=Quaternion(x=1.0))), 'pose: ')):
            clients[0].send_goal(PlaceTaskGoal(wrong))
            self.assertTrue(clients[0].wait_for_result(GUARD))
            self.assertEqual(clients[0].get_state(), GoalStatus.ABORTED)
            self.assertIn(text, clients[0].get_goal_status_text())

    def test_parameters_that_cannot_be_used_are_fatal(self):
        for parameter, text in (('_spread:=5.0', '/spread: got 5; allowed: at most the duration, 1'),
                                ('_duration:=soon', "got 'soon'; allowed: a number in 0..2147483647 [s, simulated]"),
                                ('_robots:=[a, a]', 'allowed: a list of different namespaces')):
            name = 'wrong_' + parameter[1:4]
            done = warm.run([find_executable('task_server'), parameter, '__name:=' + name])
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(text, done.stdout)
