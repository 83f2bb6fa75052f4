"""Who begins to listen to robots is told the present, at that instant, and nobody else notices: in rospy and roscpp."""
import re
import unittest

from own_folder import OwnPackage

#: sends robot_0 ten metres along x at 2 s, and prints all that it hears of it from the start
OTHER = """#!/usr/bin/env python3
import functools
print = functools.partial(print, flush=True)
import actionlib, rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
def hear(message):
    print('= other odom', rospy.Time.now(), message.header.stamp, message.header.seq, message.pose.pose.position.x)
def hear_tf(message):
    for one in message.transforms:
        print('= other tf', rospy.Time.now(), one.header.stamp, one.transform.translation.x)
rospy.init_node('other')
rospy.Subscriber('odom', Odometry, hear)
rospy.Subscriber('/tf', TFMessage, hear_tf)
rospy.Subscriber('/first', String, lambda message: print('= other heard', message.data))
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()
rospy.sleep(1.0)
goal = MoveBaseGoal()
goal.target_pose.header.frame_id = 'odom'
goal.target_pose.pose.position.x = goal.target_pose.pose.orientation.w = 10.0
goal.target_pose.pose.orientation.w = 1.0
client.send_goal(goal)
rospy.spin()
"""
#: begins to listen at 4.25 s, and looks at that instant, when others have had a turn
NEWCOMER = """#!/usr/bin/env python3
import functools
print = functools.partial(print, flush=True)
import rospy, tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped
from move_base_msgs.msg import MoveBaseActionFeedback
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
rospy.init_node('newcomer')
rospy.sleep(3.25)
buffer = tf2_ros.Buffer()
def hear(message, topic):
    place = getattr(message, 'feedback', message)
    place = getattr(place, 'base_position', place)
    x = place.pose.pose.position.x if hasattr(place.pose, 'pose') else place.pose.position.x
    print('= py', topic, rospy.Time.now(), message.header.stamp, message.header.seq, round(x, 9))
def hear_scan(message):
    at_scan = buffer.lookup_transform('odom', message.header.frame_id, message.header.stamp)
    print('= py scan', rospy.Time.now(), message.header.stamp, message.header.seq, at_scan.transform.translation.x)
topics = {'odom': Odometry, 'base_pose_ground_truth': Odometry, 'amcl_pose': PoseWithCovarianceStamped,
          'move_base/feedback': MoveBaseActionFeedback}
heard = [rospy.Subscriber(topic, kind, hear, topic) for topic, kind in topics.items()]
listener = tf2_ros.TransformListener(buffer)
scans = rospy.Subscriber('scan', LaserScan, hear_scan)
rospy.ServiceProxy('global_localization', Empty)()
found = buffer.lookup_transform('odom', 'base_link', rospy.Time.now())
print('= py tf', rospy.Time.now(), found.header.stamp, found.transform.translation.x)
"""
#: begins to listen to tf, has the robot tell its pose once more or puts it elsewhere, and looks, all at one instant
DOER = """#!/usr/bin/env python3
import functools
print = functools.partial(print, flush=True)
import rospy, tf2_ros
from geometry_msgs.msg import PoseStamped
from move_base_abstract.srv import SetPose
from std_srvs.srv import Empty
rospy.init_node('doer')
rospy.sleep(rospy.get_param('~at') - 1.0)
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
def look():
    rospy.ServiceProxy('global_localization', Empty)()
    found = buffer.lookup_transform('odom', 'base_link', rospy.Time(0))
    pose = found.transform
    print('=', rospy.get_param('~does'), rospy.Time.now(), found.header.stamp, pose.translation.x,
          round(pose.rotation.z, 9))
look()
if rospy.get_param('~does') == 'tells':
    rospy.ServiceProxy('request_nomotion_update', Empty)()
else:
    pose = PoseStamped()
    pose.pose.position.x, pose.pose.orientation.w = 77.0, 1.0
    rospy.ServiceProxy('set_robot_pose', SetPose)(pose)
look()
"""
#: publishes at once and two rounds later, and then uses a pose of which it has heard nothing
ASKER = """#!/usr/bin/env python3
import functools
print = functools.partial(print, flush=True)
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from std_srvs.srv import Empty
rospy.init_node('asker')
rospy.sleep(3.0)
first = rospy.Publisher('/first', String, queue_size=10)
counts = []
for text in ('at once', 'two rounds later'):
    counts.append(first.get_num_connections())
    first.publish(text)
    rospy.ServiceProxy('global_localization', Empty)()
print('= asker', counts, rospy.get_time())
place = None
rospy.Subscriber('/nowhere', Odometry, lambda message: None)
print(place.pose)
"""
LAUNCH = """<launch>
  <node pkg="move_base_abstract" type="fleet" name="fleet">
    <param name="tell_newcomers" value="{tells}"/>
    <rosparam>{{defaults: {{max_speed: 1.0, scan_rate: 5.0, tf_prefix: ""}}, robots: [{{name: robot_0}}]}}</rosparam>
  </node>
  <group ns="robot_0">
    <node pkg="study_of_others" type="other.py" name="other" output="screen"/>
    <node pkg="study_of_others" type="asker.py" name="asker" output="screen" if="{asks}"/>
    <group if="{come}">
      <node pkg="study_of_others" type="newcomer.py" name="newcomer" output="screen"/>
      <node pkg="move_base_abstract" type="shim_frames" name="cpp" output="screen">
        <param name="arrive" value="4.25"/>
        <param name="ask" value="/robot_0/global_localization"/>
      </node>
    </group>
    <node pkg="study_of_others" type="doer.py" name="teller" output="screen">
      <param name="at" value="5.25"/>
      <param name="does" value="tells"/>
    </node>
    <node pkg="study_of_others" type="doer.py" name="putter" output="screen">
      <param name="at" value="6.25"/>
      <param name="does" value="puts"/>
    </node>
  </group>
</launch>
"""
CAME, TOLD, PUT = '4250000000', '5250000000', '6250000000'  # ns


class NewcomersTest(OwnPackage, unittest.TestCase):
    """A robot departs at 2 s with 1 m/s."""

    FILES = {'other.py': OTHER, 'newcomer.py': NEWCOMER, 'doer.py': DOER, 'asker.py': ASKER}

    def _run(self, *words, tells=True, come=True, code=0):
        """Return ({who: the words of each of its lines}, text of the event log, output)."""
        path = self.write('newcomers.launch', LAUNCH.format(
            tells=str(tells).lower(), come=str(come).lower(), asks=str(not tells).lower()))
        said, log, _ = self.launch('newcomers.jsonl', '--log-messages', '--until', '8', *words, path, code=code)
        self.assertTrue(log.end['repeatable'], log.end)
        heard = {who: [] for who in ('py', 'cpp', 'other', 'asker', 'tells', 'puts')}
        for who, words in re.findall(r'= (\w+) (.+)', said):  # other processes write into the same lines
            heard[who].append(words.split())
        with open(self.path('newcomers.jsonl'), encoding='utf-8') as text:
            return heard, text.read(), said

    def test_all_kinds_are_heard_at_the_instant_and_nobody_else_notices_in_each_run(self):
        heard, log, said = self._run()
        self.assertEqual(heard['py'], [
            ['odom', CAME, CAME, '24', '2.25'],  # the number of the message that the other one heard last
            *([topic, CAME, CAME, '0', '2.25']
              for topic in ('base_pose_ground_truth', 'amcl_pose', 'move_base/feedback', 'scan')),
            ['tf', CAME, CAME, '2.25']], said)
        self.assertEqual(heard['cpp'], [['tf', '4.250000000', '4.250000000', '2.250000000'],
                                        ['odom', '4.250000000', '4.250000000', '24', '2.250000000']], said)
        self.assertEqual(heard['tells'], 2 * [[TOLD, TOLD, '3.25', '0.0']])
        # The robot turns towards its goal at the same instant.
        self.assertEqual(heard['puts'], [[PUT, PUT, '4.25', '0.0'], [PUT, PUT[:-1] + '2', '77.0', '1.0']])
        self.assertIn(['tf', TOLD, TOLD, '3.25'], heard['other'])
        self.assertIn(['tf', PUT, PUT, '77.0'], heard['other'])
        self.assertNotIn('TF_REPEATED_DATA', said)
        self.assertEqual(self._run(come=False)[0]['other'], heard['other'])
        self.assertEqual([self._run()[1] == log for _ in range(2)], [True, True])

    def test_with_a_lookahead_it_is_the_present_at_which_the_robots_know_of_the_newcomer(self):
        # Each message takes 0.05 s, so there is no transform of the instant at which the newcomers look.
        heard, _, said = self._run('--lookahead', '0.05', code=3)
        self.assertEqual(heard['py'][0], ['odom', '4350000000', '4300000000', '23', '2.15'], said)
        self.assertNotIn('it began to listen', said)

    def test_without_the_switch_it_is_what_was_told_last_and_a_crash_names_the_cause_and_the_option(self):
        heard, _, said = self._run(tells=False, code=3)
        last = '4200000000'
        self.assertEqual([row[:3] for row in heard['py'] if row[0] == 'odom'][0], ['odom', CAME, last])
        # As by the wall clock, the first message of a new publisher is lost.
        self.assertEqual(heard['asker'], [['[0,', '1]', '4.0']])
        self.assertEqual([row[1:] for row in heard['other'] if row[0] == 'heard'], [['two', 'rounds', 'later']])
        self.assertIn('asker crashed at 4.000000000 s: exit code 1; AttributeError in the main thread, asker.py, line '
                      '19\n    it began to listen to /nowhere at this instant', said)
        end = ' to listen to /tf at this instant, and messages take no time; with --lookahead 0.05 they do\n'
        for crash in ('newcomer crashed at 4.250000000 s: exit code 1; ExtrapolationException in the main thread, '
                      'newcomer.py, line 27\n    it began', 'cpp crashed at 4.250000000 s: ended by SIGABRT\n'
                      '    it may have begun'):
            self.assertIn('/robot_0/' + crash + end, said)
