"""Chaos with a coordinator that works only in the stated order, in Python and C++: found, shrunk, replayed exactly."""
import json
import os
import unittest

from own_folder import OwnPackage
from own_nodes import NODES

FILES = {'worker.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32
rospy.init_node('worker')
done = rospy.Publisher('~done', Int32, queue_size=10)
for task in range(12):
    rospy.sleep(1.0)
    done.publish(task)
""", 'coordinator.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32
rospy.init_node('coordinator')
last = []
def second(done):
    if done.data not in last:
        raise RuntimeError('worker 2 is done with task %d before worker 1' % done.data)
rospy.Subscriber('/worker_1/done', Int32, lambda done: last.append(done.data))
rospy.Subscriber('/worker_2/done', Int32, second)
rospy.spin()
""", 'patrol.py': """#!/usr/bin/env python3
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
rospy.init_node('patrol')
client = actionlib.SimpleActionClient('/robot/move_base', MoveBaseAction)
client.wait_for_server()
for number in range(4):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = 5.0 * (number % 2 + 1)
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal_and_wait(goal)
    assert client.get_state() == actionlib.GoalStatus.SUCCEEDED, 'it takes it that each goal is reached'
""", 'watch.py': """#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from move_base_abstract.properties import always
from move_base_msgs.msg import MoveBaseActionFeedback
from nav_msgs.msg import Odometry
rospy.init_node('watch')
truth, told, heard = {}, {}, {}
def compare(at):
    if at in truth and at in told:
        true, said = truth[at].pose.pose.position, told[at].pose.pose.position
        always(abs(true.x - said.x) + abs(true.y - said.y) < 0.001, 'amcl is right')
def take(into, topic, message):
    at = message.header.stamp
    into[at] = message
    compare(at)
    goes_on(topic, at)
def goes_on(topic, at):
    always(at - heard.get(topic, at) <= rospy.Duration(0.6), topic + ' goes on')
    heard[topic] = at
rospy.Subscriber('/robot/base_pose_ground_truth', Odometry, lambda message: take(truth, 'truth', message))
rospy.Subscriber('/robot/amcl_pose', PoseWithCovarianceStamped, lambda message: take(told, 'pose', message))
rospy.Subscriber('/robot/move_base/feedback', MoveBaseActionFeedback,
                 lambda message: goes_on('feedback', message.header.stamp))
rospy.spin()
"""}
SYSTEM = """<launch>
<node pkg="study_of_others" type="worker.py" name="worker_1"/>
<node pkg="study_of_others" type="worker.py" name="worker_2"/>
<node pkg="{}" type="{}" name="coordinator"/>
</launch>
"""
ROBOT = """<launch>
<node pkg="move_base_abstract" type="fleet" name="fleet">
  <rosparam>robots: [{name: robot, buggify: {abort: 0.2, stop: 0.5}}]</rosparam>
</node>
<node pkg="study_of_others" type="patrol.py" name="patrol" required="true"/>
</launch>
"""
LAPSES = ROBOT.replace('abort: 0.2, stop: 0.5', 'jump: 0.4, mute: 1.0').replace('</launch>', """
<node pkg="study_of_others" type="watch.py" name="watch"/>
</launch>""")
COORDINATORS = os.path.join(NODES, 'coordinators', 'coordinators.launch')
SAID = "/worker_2's message on /worker_2/done reached /coordinator before /worker_1's message on /worker_1/done, at "


class ChaosTest(OwnPackage, unittest.TestCase):
    FILES = FILES

    def test_a_bug_is_found_shrunk_and_replayed(self):
        for package, kind, crash in (('study_of_others', 'coordinator.py', 'RuntimeError'),
                                     ('move_base_abstract', 'shim_order', 'exit code 3')):
            path = self.write('system.launch', SYSTEM.format(package, kind))
            code, said = self.run_it('chaos', '--seeds', '1:50', '--workers', '1', '--output', 'found.json', path)
            self.assertEqual(code, 1, said)
            with open(self.path('found.json')) as stream:
                found = json.load(stream)
            self.assertEqual(found['failure'], 'crash /coordinator', said)
            self.assertIn(crash, found['text'])
            self.assertEqual(len(found['only']), 1, said)
            self.assertTrue(found['happened'][0].startswith(SAID), said)
            self.assertIn(found['happened'][0], said)
            code, said = self.run_it('chaos', '--replay', 'found.json')
            self.assertEqual(code, 1, said)
            self.assertIn('the same bytes as before', said)
        code, said = self.run_it('verify', '--runs', '2', '--chaos', 'found.json')
        self.assertIn('identical: 2 runs', said)

    def test_a_late_start_is_found_and_counted_before_and_after_a_repair(self):
        words = ('--count', '--seeds', '1:20', '--starts', '0.5', '--workers', '1', COORDINATORS,
                 'coordinator:=early_call')
        code, said = self.run_it('chaos', *words)
        self.assertEqual(code, 1, said)
        with open(self.path('chaos.json')) as stream:
            found = json.load(stream)
        failed = found['count']['failed']
        self.assertIn(' of 20 seeds fail', said)
        self.assertEqual({*failed.values()}, {'crash /coordinator'}, said)
        self.assertLess(len(failed), 20)
        self.assertEqual(len(found['only']), 1, said)
        self.assertRegex(found['happened'][0], r'^/store took 0\.\d+ s longer to start, at 1 s$')
        code, said = self.run_it('chaos', '--replay', 'chaos.json')
        self.assertEqual(code, 1, said)
        self.assertIn('the same bytes as before', said)
        code, said = self.run_it('verify', '--runs', '2', '--chaos', 'chaos.json')
        self.assertIn('identical: 2 runs', said)
        code, said = self.run_it('chaos', '--count', '--workers', '1', '--replay', 'chaos.json')
        self.assertEqual(code, 1, said)
        lines = said.splitlines()
        self.assertEqual(lines[-2].replace('before:', 'now:   '), lines[-1], said)  # the same seeds
        self.assertIn(f': now:    {len(failed)} of 20 seeds fail', lines[-1])
        self.write('repaired.json', json.dumps({**found, 'launch': [*found['launch'], 'correct:=true']}))
        code, said = self.run_it('chaos', '--count', '--workers', '1', '--replay', 'repaired.json')
        self.assertEqual(code, 3, said)
        self.assertIn('chaos: now:    0 of 20 seeds fail\n', said)

    def test_the_last_line_says_what_was_varied_and_what_was_looked_for_exists(self):
        path = self.write('system.launch', SYSTEM.format('study_of_others', 'worker.py'))
        for words, varied in ((('--seeds', '1:2'), '; those with an even number also delays up to 0.05 s and starts up '
                               'to 0.5 s late'), (('--seeds', '1', '--delay', '0'), '')):
            code, said = self.run_it('chaos', *words, '--workers', '1', '--until', '3', path)
            self.assertEqual(code, 0, said)
            self.assertEqual(said.splitlines()[-1], 'chaos: the seeds varied the order of equal events' + varied)
        code, said = self.run_it('chaos', '--seeds', '1', '--properties', 'one owner', '--until', '3', path)
        self.assertEqual(code, 2, said)
        self.assertIn("'one owner': no failure has this name, and no node stated this text in the 2 runs; stated were: "
                      'none', said)

    def test_what_a_robot_does_on_purpose_is_found_and_is_a_decision(self):
        path = self.write('robot.launch', ROBOT)
        code, said = self.run_it('chaos', '--seeds', '1:50', '--workers', '1', path)
        self.assertEqual(code, 1, said)
        self.assertIn('because of 1 decision,', said)
        self.assertIn(' robot gave its goal up, at ', said)
        code, said = self.run_it('chaos', '--replay', 'chaos.json')
        self.assertEqual(code, 1, said)
        self.assertIn('the same bytes as before', said)

    def test_a_pose_that_jumps_and_what_is_not_told_on_the_way(self):
        path = self.write('robot.launch', LAPSES)
        logs = []
        for name, seed, code in (('a', 0, 0), ('b', 7, 4), ('c', 7, 4)):
            log = self.path(name + '.jsonl')
            found, said = self.run_it('lockstep_launch', '--check', '--event-log', log, '--log-messages',
                                      '--chaos-seed', str(seed), path)
            self.assertEqual(found, code, said)
            for what in ('amcl is right', 'pose goes on', 'feedback goes on'):
                self.assertEqual(f'/watch: {what}' in said, code == 4, said)
            with open(log) as stream:
                logs.append(stream.read())
        self.assertNotIn('lapse', logs[0])
        for text in ('"lapse_began","values":["jump","chaos ', '"lapse_began","values":["mute","chaos '):
            self.assertIn(text, logs[1])
        self.assertEqual(logs[1], logs[2])

    def test_seed_0_and_no_decision_leave_the_same_bytes_as_without(self):
        path = self.write('system.launch', SYSTEM.format('study_of_others', 'coordinator.py'))
        logs = []
        for name, words in (('a', ()), ('b', ('--chaos-seed', '0')),
                            ('c', ('--chaos-seed', '7', '--chaos-delay', '0.5', '--chaos-starts', '2', '--chaos-only',
                                   'none'))):
            log = self.path(name + '.jsonl')
            code, said = self.run_it('lockstep_launch', '--end-when-idle', '--event-log', log, '--log-messages', *words,
                                     path)
            self.assertEqual(code, 0, said)
            with open(log) as stream:
                logs.append(stream.readlines())
        self.assertEqual(logs[0], logs[1])
        self.assertEqual(logs[0][1:], logs[2][1:])
        self.assertEqual(json.loads(logs[2][0])['chaos'], {'seed': 7, 'delay': 0.5, 'starts': 2, 'some': True})
