"""The launch file and the commands of the README work as they stand there, with a user's package."""
import os
import re
import shlex
import stat
import subprocess
import sys
import time
import unittest

from own_folder import GUARD, OwnFolder
from warm import Loopback

README = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'README.md')
PACKAGE = '<package format="2"><name>my_package</name><version>1.0.0</version><description>x</description>' \
          '<maintainer email="me@example.org">me</maintainer><license>x</license></package>'
COORDINATOR = """#!{python}
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

rospy.init_node('coordinator')
client = actionlib.SimpleActionClient('/robot_1/move_base', MoveBaseAction)
client.wait_for_server()
for x in (10.0, 40.0, 0.0):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = x
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal_and_wait(goal)
rospy.spin()
"""


def blocks(kind):
    """Return the README's code blocks of a kind, such as sh."""
    with open(README, encoding='utf-8') as stream:
        found = re.findall(r'^```(\w*)\n(.*?)^```$', stream.read(), re.DOTALL | re.MULTILINE)
    return [text for its_kind, text in found if its_kind == kind]


def commands(word):
    """Return the README's commands that begin with a word, without their comments."""
    return [shlex.split(line, comments=True) for block in blocks('') for line in block.splitlines()
            if line.startswith(word)]


class Readme(OwnFolder, unittest.TestCase):

    def launch(self, ros, environment, *words):
        """Start roslaunch; return its process, which ends with the test."""
        process = subprocess.Popen(['roslaunch', *words], env=environment, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait, GUARD)
        self.addCleanup(process.terminate)
        return process

    def run_when_there(self, words, environment, wanted):
        """Run a command again until its output has ``wanted``, since nodes may still start; return the output."""
        deadline = time.monotonic() + GUARD
        while True:
            done = subprocess.run(words, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, timeout=GUARD, check=False)
            if done.returncode == 0 and wanted in done.stdout:
                return done.stdout
            self.assertLess(time.monotonic(), deadline, (words, done.stdout))
            time.sleep(0.1)

    def run_of_the_lines(self, log):
        """Run the README's launch file to its last goal; return the outputs of `why` and `set_factor`."""
        text, = blocks('xml')
        self.write('system.launch', '<launch>' + text.replace('/tmp/run.jsonl', log) + '</launch>')
        with Loopback() as ros:
            environment = dict(ros.environment, ROS_PACKAGE_PATH=os.pathsep.join(
                [self.folder, os.environ['ROS_PACKAGE_PATH']]))
            process = self.launch(ros, environment, self.path('system.launch'))
            why, = [words for words in commands('rosrun') if words[2] == 'why']
            said = self.run_when_there(why, environment, 'at 161.000000000 s')  # 80 m at 0.5 m/s, from 1 s on
            factor, = commands('rosservice call /time_master/set_factor')
            said += self.run_when_there(factor, environment, 'success')
            process.terminate()
            process.wait(GUARD)
        return said

    def test_the_lines_for_a_launch_file_run_and_two_runs_are_identical(self):
        self.write('package.xml', PACKAGE)
        self.write('coordinator.py', COORDINATOR.format(python=sys.executable), stat.S_IRWXU)
        logs = [self.path('A.jsonl'), self.path('B.jsonl')]
        for log in logs:
            said = self.run_of_the_lines(log)
            self.assertIn('repeatable so far', said)
            self.assertIn('success: True', said)
            with open(log) as stream:
                text = stream.read()
            self.assertEqual(text.count('"Goal reached."'), 3)
            self.assertIn('"repeatable":true', text)
        compare, = [words for words in commands('rosrun') if words[2] == 'compare']
        done = subprocess.run([*compare[:3], *logs], stdout=subprocess.PIPE, text=True, timeout=GUARD, check=False)
        self.assertEqual((done.returncode, done.stdout.split()[0]), (0, 'identical'), done.stdout)

    def test_the_commands_without_a_setup_of_ones_own_bring_a_robot_to_its_goal(self):
        launch, = commands('roslaunch')
        publish, = commands('rostopic pub')
        echo, = commands('rostopic echo')
        with Loopback() as ros:
            process = self.launch(ros, ros.environment, *launch[1:])
            self.run_when_there(echo, ros.environment, 'x: 4.0')  # the robot is there
            self.run_when_there(publish, ros.environment, '')
            self.run_when_there(echo, ros.environment, 'x: 20.0')
            process.terminate()
            process.wait(GUARD)

