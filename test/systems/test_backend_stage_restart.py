"""A process of Stage is killed and started again: the robots notice it, goals end, and the robots go on."""
import os
import subprocess
import sys
import threading
import unittest

import rospy
import tf2_ros
from actionlib_msgs.msg import GoalID, GoalStatus
from nav_msgs.msg import Odometry
from robot_harness import REACHED, RawClient, Record, pose_stamped, warned
from rosgraph_msgs.msg import Clock, Log
from tf2_msgs.msg import TFMessage

from move_base_abstract.msg import PlaceTaskActionGoal, PlaceTaskActionResult
from move_base_abstract_ros.messages import conversions

LAUNCH_FILE = """
<launch>  <!-- a Stage that dies and is started again; a process of the test stands in for it -->
  <param name="/use_sim_time" value="true"/>
  <node pkg="move_base_abstract" type="fleet" name="fleet" required="true">
    <rosparam>
      backend: stage_ros
      defaults: {max_speed: 2.0}
      robots:
        - {name: robot_0, start_x: 4.0, start_y: 4.0}
        - {name: robot_1, start_x: 4.0, start_y: 6.0}
        - {name: bystander, start_x: 7.0, backend: builtin}   # in nobody's simulator, by the same clock
    </rosparam>
  </node>
  <node pkg="move_base_abstract" type="task_server" name="task_server" required="true">
    <rosparam>{robots: [robot_1], task: load, duration: 1000.0}</rosparam>
  </node>
</launch>
"""
OWN_NODE = 'backend_stage_restart_test'

HERE = os.path.dirname(os.path.abspath(__file__))
RESTARTED = 'Aborting on the goal because simulated time has started anew'
OLD = 1000.0  # s, simulated
STARTS = {'robot_0': (4.0, 4.0), 'robot_1': (4.0, 6.0)}


def start_stage(begin=0.0):
    """Start the stand-in at ``begin`` [s, simulated], with each robot at its start; return the process."""
    words = [word for name, pose in STARTS.items() for word in (name, *map(str, pose))]
    return subprocess.Popen([sys.executable, os.path.join(HERE, 'stage_stand_in.py'), str(begin), *words])


class Restart(unittest.TestCase):
    """The tests build on each other: a goal is under way when Stage is killed."""

    @classmethod
    def setUpClass(cls):
        cls.stage = start_stage(OLD)  # as if it had run for a long time
        cls.log = Record('/rosout', Log)
        cls.truth = Record('/robot_0/base_pose_ground_truth', Odometry)
        cls.client = RawClient('/robot_0')
        cls.task_result = Record('/robot_1/load/result', PlaceTaskActionResult)
        cls.task_goal = rospy.Publisher('/robot_1/load/goal', PlaceTaskActionGoal, queue_size=1, latch=True)

    @classmethod
    def tearDownClass(cls):
        cls.stage.kill()
        cls.stage.wait()

    def test_1_a_stage_that_dies_is_told_of(self):
        type(self).goal = self.client.send(pose_stamped(1000.0, 4.0))
        self.task_goal.publish(PlaceTaskActionGoal(goal_id=GoalID(rospy.Time(), 'sacks')))
        self.client.wait_for_state(self.goal, GoalStatus.ACTIVE)
        self.truth.wait_for(lambda message: message.pose.pose.position.x > 10.0)
        self.stage.kill()
        self.stage.wait()
        type(self).left = self.truth.messages[-1]
        for robot in ('/robot_0', '/robot_1'):  # one message for both robots, or two on a busy machine
            warned(self.log, '/fleet', 'Stage has fallen silent', robot + '/base_pose_ground_truth')
        self.assertEqual(self.client.endings(self.goal), [])

    def test_2_a_stage_that_starts_anew_ends_goals_and_tasks_and_that_is_told_of(self):
        self.truth.clear()
        type(self).stage = start_stage()
        ending = self.client.ending(self.goal)
        self.assertEqual((ending.status.status, ending.status.text), (GoalStatus.ABORTED, RESTARTED))
        self.assertLess(ending.header.stamp.to_sec(), OLD)
        self.assertEqual(self.task_result.wait_for().status.text, RESTARTED)
        for node in ('/fleet', '/task_server'):
            warned(self.log, node, '/clock went back', '/stageros has started anew')

    def test_3_stage_puts_the_robot_where_it_was_not_where_its_world_has_it(self):
        was = self.left.pose.pose.position.x
        self.truth.wait_for(lambda message: message.pose.pose.position.x >= was - 1e-6)

    def test_4_goals_are_reached_by_the_new_time(self):
        goal = self.client.send(pose_stamped(20.0, 4.0))
        ending = self.client.ending(goal)
        self.assertEqual((ending.status.status, ending.status.text), REACHED)
        self.truth.wait_for(lambda message: abs(message.pose.pose.position.x - 20.0) < 1e-6)

    def test_5_tf_has_the_new_time_too(self):
        buffer = tf2_ros.Buffer(debug=False)

        def all_known(message):
            for transform in message.transforms:
                if transform.header.stamp.to_sec() < OLD:
                    buffer.set_transform(transform, 'test')
            return all(buffer.can_transform('map', name + '/base_link', rospy.Time())
                       for name in ('robot_0', 'bystander'))
        Record.fresh('/tf', TFMessage).wait_for(all_known)
        for name, x in (('robot_0', 20.0), ('bystander', 7.0)):
            found = buffer.lookup_transform('map', name + '/base_link', rospy.Time()).transform
            self.assertAlmostEqual(conversions.from_transform(found).x, x, places=6)

    def test_6_a_second_clock_that_is_behind_is_ignored_and_both_are_named(self):
        self.log.clear()
        clock = rospy.Publisher('/clock', Clock, queue_size=1)
        ended = threading.Event()

        def tick():
            while not ended.wait(0.05):
                clock.publish(Clock(rospy.Time(0, 50_000_000)))
        ticking = threading.Thread(target=tick, daemon=True)
        ticking.start()
        try:
            warned(self.log, '/fleet: two clocks are running', 's by /stageros', '0.050 s that ' + rospy.get_name())
        finally:
            ended.set()
            ticking.join()
            clock.unregister()
