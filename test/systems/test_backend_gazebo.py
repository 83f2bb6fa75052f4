"""The backend for Gazebo, with a stand-in for Gazebo's service that is late, is slow, refuses, or is not installed."""
import importlib.util
import os
import sys
import threading
import unittest

import rospy
import warm
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from robot_harness import GUARD, REACHED, Record, go, pose_stamped, simple_client, warned
from rosgraph_msgs.msg import Log

from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = """
<launch>  <!-- the backend gazebo with a stand-in for its service in the test, since Debian has neither simulator -->
  <group ns="robot_0">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <env name="PYTHONPATH" value="$(find move_base_abstract)/test/data/gazebo_fake:$(env PYTHONPATH)"/>
      <rosparam>{backend: gazebo, tf_prefix: robot_0, max_speed: 2.0, start_x: 1.0, start_y: 2.0}</rosparam>
    </node>
  </group>
  <group ns="robot_1">
    <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
      <env name="PYTHONPATH" value="$(find move_base_abstract)/test/data/gazebo_fake:$(env PYTHONPATH)"/>
      <rosparam>
        backend: gazebo
        tf_prefix: robot_1
        max_speed: 2.0
        gazebo_model: husky
        gazebo_reference_frame: field
        gazebo_z: 0.25
        buggify: {jump: 1.0}
        buggify_seed: 1
      </rosparam>
    </node>
  </group>
</launch>
"""
FACTOR = 10
OWN_NODE = 'gazebo'

INSTALLED = importlib.util.find_spec('gazebo_msgs') is not None
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'data', 'gazebo_fake'))
SERVICE = '/gazebo/set_model_state'


class Gazebo:
    """A stand-in for the service of Gazebo, which knows the models ``models``."""

    def __init__(self):
        from gazebo_msgs.srv import SetModelState
        self.answers = threading.Event()  # cleared for a slow Gazebo
        self.answers.set()
        self.models = {'robot_0'}
        self.states = []
        self._changed = threading.Condition()
        self._response = SetModelState._response_class
        rospy.Service(SERVICE, SetModelState, self._serve)

    def _serve(self, request):
        self.answers.wait(GUARD)
        state = request.model_state
        if state.model_name not in self.models:
            return self._response(False, 'SetModelState: model [{}] does not exist'.format(state.model_name))
        with self._changed:
            self.states.append(state)
            self._changed.notify_all()
        return self._response(True, 'SetModelState: set model state done')

    def wait_for(self, model, x, y):
        """Return the first state that puts ``model`` at (x, y)."""
        def there():
            return [state for state in self.states if state.model_name == model
                    and abs(state.pose.position.x - x) + abs(state.pose.position.y - y) < 1e-9]
        with self._changed:
            assert self._changed.wait_for(there, GUARD), '{} did not come to ({}, {}); last: {}'.format(
                model, x, y, self.states[-1:])
            return there()[0]


class GazeboBackend(unittest.TestCase):
    """The tests run in the order of their numbers; Gazebo starts in the second one."""

    @classmethod
    def setUpClass(cls):
        cls.log = Record('/rosout', Log)
        cls.robots = [simple_client(f'/robot_{k}') for k in (0, 1)]

    def test_1_robots_work_and_warn_while_there_is_no_gazebo(self):
        warned(self.log, "model 'robot_0' could not be placed", SERVICE)
        self.assertEqual(go(self.robots[0], pose_stamped(3.0, 4.0)), REACHED)

    def test_2_a_gazebo_that_comes_late_learns_where_the_robot_is(self):
        type(self).gazebo = Gazebo()
        state = self.gazebo.wait_for('robot_0', 3.0, 4.0)
        self.assertEqual((state.reference_frame, state.pose.position.z), ('world', 0.0))

    def test_3_a_model_that_gazebo_does_not_know_is_warned_about_and_holds_nobody_up(self):
        warned(self.log, "model 'husky' could not be placed", 'does not exist')
        self.assertEqual(go(self.robots[0], pose_stamped(5.0, 4.0)), REACHED)
        self.gazebo.wait_for('robot_0', 5.0, 4.0)
        self.gazebo.models.add('husky')
        state = self.gazebo.wait_for('husky', 0.0, 0.0)
        self.assertEqual((state.reference_frame, state.pose.position.z), ('field', 0.25))

    def test_4_poses_come_on_the_way_and_the_pose_topics_tell_the_same(self):
        truth = Record('/robot_1/base_pose_ground_truth', Odometry)
        amcl = Record('/robot_1/amcl_pose', PoseWithCovarianceStamped)
        amcl.wait_for()
        truth.wait_for(lambda message: message.pose.pose.position.x == 0.0)  # latched; after it, all messages are heard
        self.assertEqual(go(self.robots[1], pose_stamped(20.0)), REACHED)
        self.gazebo.wait_for('husky', 20.0, 0.0)
        truth.wait_for(lambda message: message.pose.pose.position.x == 20.0)
        told = {message.pose.pose.position.x for message in truth.messages}
        shown = {state.pose.position.x for state in self.gazebo.states if state.model_name == 'husky'}
        self.assertTrue([x for x in shown if 0.0 < x < 20.0])
        self.assertEqual(shown - told - {0.0}, set())
        self.assertTrue([one for one in amcl.messages if one.pose.pose.position.y != 0.0], 'no jump is told')

    def test_5_a_slow_gazebo_holds_no_robot_up(self):
        self.gazebo.answers.clear()
        self.addCleanup(self.gazebo.answers.set)
        before = len(self.gazebo.states)
        for x in (25.0, 30.0):
            self.assertEqual(go(self.robots[0], pose_stamped(x, 4.0)), REACHED)
        self.assertEqual(len(self.gazebo.states), before, 'Gazebo has answered')
        self.gazebo.answers.set()
        self.gazebo.wait_for('robot_0', 30.0, 4.0)
        self.assertLess(len(self.gazebo.states) - before, 5, 'of what could not be told only the latest is')

    @unittest.skipIf(INSTALLED, 'gazebo_msgs is installed')
    def test_6_without_gazebo_msgs_the_node_says_what_to_install(self):
        rospy.set_param('/robot_2/move_base/backend', 'gazebo')
        command = [find_executable('move_base'), '__ns:=/robot_2', '__name:=move_base']
        done = warm.run(command)
        self.assertEqual(done.returncode, 1, done.stdout)
        for words in ('/robot_2/move_base/backend', "got 'gazebo'", 'gazebo_msgs', 'ros-noetic-gazebo-msgs'):
            self.assertIn(words, done.stdout)
