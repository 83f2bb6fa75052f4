"""Verify: runs that are the same, a program whose runs differ, a run without an end, and refused arguments."""
import os
import unittest

from night import times
from own_folder import OwnPackage
from own_nodes import NODES

HERE = os.path.dirname(os.path.abspath(__file__))
SYSTEM = os.path.join(NODES, 'foreign', 'system.launch')
NODE = '<node pkg="study_of_others" type="{0}.py" name="{0}"/>'
CHANCE = """#!/usr/bin/env python3
import os
import rospy
from std_msgs.msg import Float64, Int32
rospy.init_node('chance')
pub = rospy.Publisher('chosen', Float64, queue_size=5)
rospy.Subscriber('ticks', Int32, lambda tick: pub.publish(os.getpid() if tick.data == 12 else tick.data))
rospy.spin()
"""
QUIET = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64, Int32
rospy.init_node('quiet')
rospy.Subscriber('ticks', Int32, lambda tick: None)
rospy.Subscriber('chosen', Float64, lambda tick: None)
rospy.spin()
"""
FLEET = """<launch>
  <node pkg="move_base_abstract" type="fleet" name="fleet">
    <rosparam>{robots: [{name: robot_1, start_x: 0.0}, {name: robot_2, start_x: 5.0}]}</rosparam>
  </node>
  <node pkg="study_of_others" type="sender.py" name="sender"/>
</launch>
"""
SENDER = """#!/usr/bin/env python3
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
rospy.init_node('sender')
clients = [actionlib.SimpleActionClient('/robot_%d/move_base' % k, MoveBaseAction) for k in (1, 2)]
for client in clients:
    client.wait_for_server()
for x in (3.0, 8.0):
    for client in clients:
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x = x
        goal.target_pose.pose.orientation.w = 1.0
        client.send_goal(goal)
    for client in clients:
        client.wait_for_result()
"""
BREAKS = SENDER + """took = {}
clients[0].send_goal(goal, done_cb=lambda status, result: took['robot_1'])
rospy.spin()
"""


class VerifyTest(OwnPackage, unittest.TestCase):
    FILES = {'chance.py': CHANCE, 'quiet.py': QUIET, 'sender.py': SENDER}
    COPIES = ('ticks.py',)

    def setUp(self):
        super().setUp()
        os.mkdir(self.path('tmp'))
        self.environment['TMPDIR'] = self.path('tmp')

    def launch_file(self, *nodes):
        return self.write('system.launch', '<launch>{}</launch>'.format(''.join(nodes)))

    def verify(self, *words):
        return self.run_it('verify', *words)

    def test_a_whole_system_is_identical_and_nothing_stays(self):
        conditions = times('plain, order, delays', 'plain, order, busy, limited, delays')
        code, said = self.verify('--conditions', conditions.replace(' ', ''), SYSTEM, 'bag:=' + self.path('bag'),
                                 'tasks:=6')
        self.assertEqual(code, 0, said)
        self.assertIn('verify: identical: {} runs ({}), '.format(1 + conditions.count(','), conditions), said)
        self.assertIn('and the same bytes in 1 bag\n', said)
        self.assertIn('verify: next: the search for another order of equal events that breaks it: rosrun '
                      'move_base_abstract chaos {} '.format(SYSTEM), said)
        self.assertEqual(os.listdir(self.path('tmp')), [])

    def test_a_program_that_tells_its_number_differs_and_the_place_is_named(self):
        code, said = self.verify('--runs', '2', '--until', '30', self.launch_file(
            NODE.format('ticks'), NODE.format('chance'), NODE.format('quiet')))
        self.assertEqual(code, 1, said)
        self.assertIn('first difference: at 13.000000000 s, event', said)
        self.assertEqual(said.count('message /chosen from /chance to /quiet'), 2, said)
        self.assertIn('what /chance had heard before, in both runs:', said)
        told = said.partition('what /chance')[2].partition('likely causes')[0]
        self.assertEqual(told.count('message /ticks from /ticks to /chance'), 10, said)
        self.assertRegex(said, r'its fields, plain / again:\n  data: [0-9.]+ / [0-9.]+\n')
        self.assertRegex(said, r"  '/chance': os.getpid in \S+chance.py, line 7: is another number in another run ")
        folder = said.partition('logs and outputs are in ')[2].strip()
        self.assertIn('rosrun move_base_abstract replay {0}/1_plain/events.jsonl {0}/2_again/events.jsonl\n'.format(
            folder), said)
        self.assertEqual(sorted(os.listdir(folder)), ['1_plain', '2_again'])
        self.assertEqual(set(os.listdir(os.path.join(folder, '1_plain'))), {
            'events.jsonl', 'events.jsonl.run', 'output.txt', 'ros_log'})

    def test_a_system_that_crashes_is_not_called_identical(self):
        self.write('breaks.py', BREAKS, 0o755)
        file = self.write('breaks.launch', FLEET.replace('sender', 'breaks'))
        code, said = self.verify('--runs', '2', file)
        self.assertEqual(code, 5, said)
        self.assertRegex(said, r"nodes crashed in the run 'plain', .*\n    /breaks crashed at [0-9.]+ s: KeyError "
                               r'in a callback of /robot_1/move_base/\w+, breaks.py, line [0-9]+\n')
        self.assertNotIn('identical', said)
        code, said = self.verify('--runs', '2', '--crashes', 'allow', file)
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r'but /breaks crashed at .* \(--crashes allow\)')

    def test_runs_in_which_nothing_happens_are_not_simply_called_identical(self):
        code, said = self.verify('--runs', '2', '--until', '5', self.launch_file(NODE.format('ticks')))
        self.assertEqual(code, 4, said)
        self.assertIn('but there was nothing to compare', said)

    def test_a_fleet_in_two_processes_does_the_same(self):
        code, said = self.verify('--conditions', 'plain,hash,split', self.write('fleet.launch', FLEET))
        self.assertEqual(code, 0, said)
        self.assertIn('identical: 3 runs (plain, hash, split)', said)
        self.assertNotIn(', 0 events', said)

    def test_a_fleet_that_counts_robots_stays_in_one_process_and_one_run_is_not_called_identical(self):
        file = self.write('zone.launch', FLEET.replace('5.0}]}<', '5.0}], zones: [{name: dock, capacity: 1, polygon: '
                                                       '[[20, 0], [30, 0], [30, 9]]}]}<'))
        code, said = self.verify('--conditions', 'plain,split', file)
        self.assertEqual(code, 4, said)
        self.assertIn('split: not run: /fleet: one process must count the robots in its zones', said)
        self.assertIn('nothing is compared: only one run was made (plain)', said)
        self.assertNotIn('identical', said)

    def test_what_is_not_called_repeatable_is_said(self):
        code, said = self.verify('--runs', '2', '--until', '10', self.launch_file(
            NODE.format('ticks'), NODE.format('quiet'), '<param name="quiet/lockstep_charge" value="measured"/>'))
        self.assertEqual(code, 4, said)  # the node sends nothing, so nothing is charged
        self.assertEqual(said.count('s of wall time; labelled\n'), 2, said)
        self.assertEqual(said.count('charges what it measures'), 1, said)
        self.assertRegex(said, r'but not called repeatable: .*charges what it measures.* \(all runs\)')

    def test_a_run_without_an_end_is_ended_and_said(self):
        code, said = self.verify('--time-limit', '8', self.launch_file(NODE.format('ticks')))
        self.assertEqual(code, 3, said)
        self.assertIn('--until S', said)

    def test_what_cannot_be_run_is_refused(self):
        for words, text in (((self.path('none.launch'),), 'none.launch'),
                            (('--runs', '1', SYSTEM), 'a whole number in 2..'),
                            (('--conditions', 'plain,fast', SYSTEM), "got 'fast'"),
                            (('--conditions', 'plain', SYSTEM), 'must be two conditions at least'),
                            ((self.launch_file(),), 'no node of this launch file')):
            code, said = self.verify(*words)
            self.assertEqual(code, 2, said)
            self.assertIn(text, said)

    def test_a_folder_with_something_in_it_stays_as_it_is(self):
        self.write(os.path.join('mine', 'thesis.txt'), 'all my work')
        code, said = self.verify('--output', self.path('mine'), SYSTEM, 'bag:=x')
        self.assertEqual(code, 2, said)
        self.assertIn('thesis.txt', said)
        self.assertEqual(os.listdir(self.path('mine')), ['thesis.txt'])

    def test_the_folder_may_be_named_from_where_one_is(self):
        code, said = self.verify('--runs', '2', '--until', '5', '--output', 'mine', self.launch_file(
            NODE.format('ticks'), NODE.format('quiet')))
        self.assertEqual(code, 0, said)
        self.assertLessEqual({'1_plain', '2_again'}, set(os.listdir(self.path('mine'))))

    def test_delays_are_asked_for_by_a_variable_that_python_and_cpp_check(self):
        self.environment['MOVE_BASE_ABSTRACT_REPORT_DELAY'] = 'often'
        for node in (NODE.format('ticks'), '<node pkg="move_base_abstract" type="shim_listener" name="listener"/>'):
            code, said = self.verify('--time-limit', '60', self.launch_file(node))
            self.assertIn(code, (1, 3), said)
            self.assertIn('MOVE_BASE_ABSTRACT_REPORT_DELAY must be SEED:MILLISECONDS', said)
