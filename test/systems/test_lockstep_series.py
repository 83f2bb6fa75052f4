"""An unchanged script that starts launch files by ROSLaunchParent: each becomes a run in lockstep, with its own log."""
import json
import os
import shutil
import unittest

from own_folder import OwnFolder
from own_nodes import NODES

PACKAGE = """<package format="2"><name>study_of_others</name><version>1.0.0</version><description>x</description>
<maintainer email="a@b.c">a</maintainer><license>BSD</license></package>
"""
HEAD = """import os, sys, time, rospy, roslaunch
from geometry_msgs.msg import PoseStamped
from move_base_abstract.srv import SetPose, SetPoseResponse
file = os.path.join(os.path.dirname(sys.argv[0]), 'trials.launch')
"""
ENDS_BY_ITSELF = HEAD + """
def start():
    parent = roslaunch.parent.ROSLaunchParent('x', [(file, ['trial:=1', 'budget:=30'])])
    parent.start()
    return parent

start()
try:
    start()
except roslaunch.RLException as error:
    print('refused:', error)
time.sleep(1.5)
print('slept until', rospy.Time.now().to_sec(), rospy.get_param('/robot_0/lacking', 'default'))
try:
    rospy.sleep(100.0)
except rospy.ROSInterruptException as error:
    print('then', error, rospy.is_shutdown())
parent = start()
print('and begins again at', rospy.get_time(), rospy.is_shutdown())
heard = []
def hear(message, heard):
    heard.append(round(message.pose.position.x, 3))
    raise ValueError('nobody cares')
def place(request):
    return SetPoseResponse(success=True, message='asked at {}'.format(rospy.get_time()))
rospy.Subscriber('/robot_0/robot_pose', PoseStamped, hear, callback_args=heard)
service = rospy.Service('/place', SetPose, place)
print(rospy.ServiceProxy('/place', SetPose)(PoseStamped()).message)
parent.spin()
print('heard', sorted(set(heard)))
start()
"""
ENDS_IN_A_CALLBACK = HEAD + """
def end(message):
    parent.shutdown()

parent = roslaunch.parent.ROSLaunchParent('x', [(file, ['trial:=1', 'budget:=30'])])
parent.start()
try:
    rospy.ServiceProxy('/robot_0/lacking', SetPose)(PoseStamped())
except rospy.ServiceException as error:
    print('refused:', error)
rospy.Subscriber('/robot_0/robot_pose', PoseStamped, end)
try:
    rospy.sleep(100.0)
except rospy.ROSInterruptException as error:
    print('then', error, rospy.is_shutdown())
"""
REFUSED = HEAD + """
Parent = roslaunch.parent.ROSLaunchParent
for make in (roslaunch.scriptapi.ROSLaunch, lambda: Parent('x', [], roslaunch_strs=['']), lambda: rospy.sleep(1.0)):
    try:
        make()
    except (roslaunch.RLException, rospy.ROSException) as error:
        print('refused:', error)
print('hashed by', os.environ['PYTHONHASHSEED'])
sys.exit(7)
"""


class LockstepSeries(OwnFolder, unittest.TestCase):
    """The study is a package of its own, in a temporary folder for each test."""

    def setUp(self):
        super().setUp()
        shutil.copytree(os.path.join(NODES, 'series'), self.path('study_of_others'))
        self.write('study_of_others/package.xml', PACKAGE)
        self.environment['ROS_PACKAGE_PATH'] = os.pathsep.join([self.folder, os.environ['ROS_PACKAGE_PATH']])
        self.environment.pop('PYTHONHASHSEED', None)

    def run_script(self, name, text='', words=(), options=()):
        """Run a script of the study, maybe a new one, by lockstep_launch --script; return (exit code, output)."""
        path = self.path('study_of_others/' + name)
        if text:
            self.write(path, text)
        return self.run_it('lockstep_launch', '--script', '--logs', self.path('logs'), *options, path, *words)

    def log(self, number):
        """Return the event log of a run [bytes]."""
        with open(self.path('logs/run_{:03d}.jsonl'.format(number)), 'rb') as stream:
            return stream.read()

    def test_each_trial_is_a_run_that_ends_where_the_script_ends_it_and_has_the_same_bytes_again(self):
        code, said = self.run_script('run_trials.py', words=('1', '1'), options=(
            '--param', '/compatible_with=move_base_abstract', '--sleep', 'simulated'))
        self.assertEqual(code, 0, said)
        self.assertEqual(said.count('trial 1 over at 31.100 s, at 10.0'), 2, said)
        self.assertNotIn('has died', said)  # the deputy leaves with the script, as it should
        first = self.log(1)
        self.assertEqual(first, self.log(2))
        rows = [json.loads(line) for line in first.splitlines()]
        # 10 m at 2 m/s with 0.1 m/s^2 take 15 s by the original's formula
        self.assertEqual([row['time_ns'] for row in rows if row.get('kind') == 'ended'], [16_000_000_000])
        end = rows[-1]['end']
        self.assertEqual((end['node'], end['at_ns'], end['repeatable']), ('/run_trials', 31_100_000_000, True))

    def test_a_run_that_ends_by_itself_is_over_for_the_script(self):
        code, said = self.run_script('ends.py', ENDS_BY_ITSELF, options=('--until', '20'))
        self.assertEqual(code, 0, said)
        self.assertIn('slept until 2.5 default', said)
        self.assertIn('then the run is over True', said)
        self.assertIn('and begins again at 1.0 False', said)
        self.assertIn('refused: another run is under way', said)
        self.assertIn('asked at 1.0', said)
        self.assertIn('ValueError: nobody cares', said)
        self.assertIn('heard [0.0, 5.0]', said)  # at 1 s, and half-way at 11 s, by its rate of 0.1 Hz
        self.assertEqual(json.loads(self.log(2).splitlines()[-1])['end']['at_ns'], 20_000_000_000)
        self.assertEqual(json.loads(self.log(3).splitlines()[-1])['end']['node'], '/ends')
        self.assertEqual(json.loads(self.log(1).splitlines()[-1])['end']['at_ns'], 20_000_000_000)

    def test_a_callback_may_end_the_run(self):
        code, said = self.run_script('ends.py', ENDS_IN_A_CALLBACK)
        self.assertEqual(code, 0, said)
        self.assertIn('refused: service [/robot_0/lacking] unavailable', said)
        self.assertIn('then the run is over False', said)
        end = json.loads(self.log(1).splitlines()[-1])['end']
        self.assertEqual((end['node'], end['at_ns']), ('/ends', 1_000_000_000))

    def test_what_is_no_run_is_refused_and_the_scripts_exit_code_is_the_series(self):
        code, said = self.run_script('refused.py', REFUSED)
        self.assertEqual(code, 7, said)
        for text in ('starts nodes one by one', 'got roslaunch_strs; allowed', 'no run is under way'):
            self.assertIn(text, said)
        self.assertEqual(said.count('refused: '), 3)
        self.assertIn('hashed by 0', said)
        code, said = self.run_script('nothing.py')
        self.assertEqual(code, 2, said)
        self.assertIn('a Python script must follow the options', said)
