"""A debugged run: each command with what it shows, stops that change nothing, back, and logs that start their runs."""
import filecmp
import glob
import json
import os
import pty
import random
import re
import signal
import subprocess
import threading
import unittest

from night import times
from own_folder import OwnPackage
from waiting import GUARD, children_of, wait_for

from move_base_abstract_ros.loopback import find_executable

DEMO = ('--until', '200', 'move_base_abstract', 'coordinator.launch')
LONG = ('--log-messages', '--until', '4000', 'move_base_abstract', 'coordinator.launch')
#: a coordinator with a fault: in its second done callback it asks for what is not there
COORDINATOR = """#!/usr/bin/env python3
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String

rospy.init_node('coordinator')
names = {1: 'first'}
status = rospy.Publisher('status', String, queue_size=5)
client = actionlib.SimpleActionClient('robot/move_base', MoveBaseAction)
client.wait_for_server()
done = []


def on_done(_state, _result):
    done.append(1)
    status.publish(names[len(done)])


for number in (1, 2, 3):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = 5.0 * number
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal(goal, on_done)
    client.wait_for_result()
rospy.spin()
"""
FAULT = """<launch>
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot"/>
  <node pkg="study_of_others" type="coordinator.py" name="coordinator"/>
  <node pkg="study_of_others" type="ticks.py" name="ticks"/>
</launch>"""
#: a node that says what no two runs say
COUNTER = """#!/usr/bin/env python3
import os
import rospy
from std_msgs.msg import Int32
rospy.init_node('counter')
path = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'count')
count = len(open(path).read()) if os.path.exists(path) else 0
open(path, 'a').write('x')
publisher = rospy.Publisher('count', Int32, queue_size=5)
rospy.sleep(2.0)
publisher.publish(count)
rospy.spin()
"""
HEARER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32
rospy.init_node('hearer')
rospy.Subscriber('count', Int32, lambda message: None)
rospy.Subscriber('ticks', Int32, lambda message: None)
rospy.spin()
"""
COUNTS = """<launch><node pkg="study_of_others" type="counter.py" name="counter"/>
  <node pkg="study_of_others" type="hearer.py" name="hearer"/>
  <node pkg="study_of_others" type="ticks.py" name="ticks"/></launch>"""
RANDOM = ('next', 'round', 'round 3', 'run 0.5', 'run 7', 'until row stands', 'where', 'robots', 'messages 3', 'why')


class Debugger(OwnPackage, unittest.TestCase):

    FILES = {'coordinator.py': COORDINATOR, 'counter.py': COUNTER, 'hearer.py': HEARER}
    COPIES = ('ticks.py',)

    def setUp(self):
        super().setUp()
        self.fault = self.write('fault.launch', FAULT)

    def debug(self, commands, *words, code=0):
        """Debug with commands from a pipe; return {command: [its answers]}, and what else was said as ''."""
        done = subprocess.run(
            [find_executable('debug'), '--json', *words], input='\n'.join(commands), stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, env=self.environment, cwd=self.folder, timeout=GUARD, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        found = {'': done.stderr}
        for line in done.stdout.splitlines():
            one = json.loads(line)
            found.setdefault(one['command'], []).append(one)
        return found

    def plain(self, log, *words, code=0):
        """Run the same without a debugger; return the path of its log."""
        self.launch(log, *words, code=code)
        return self.path(log)


class CommandsTest(Debugger):

    def test_each_command_on_a_system_of_robots(self):
        said = self.debug(['next', 'rows 2', 'round', 'run 5', 'until result robot_0', 'robots', 'goals', 'where',
                           'why', 'until 60', 'messages 3', 'messages /coordinator 2', 'echo /robot_0/move_base/result',
                           'help', 'help until', 'back 2', 'back 1.5s', 'at 70', 'quit'], *DEMO)
        self.assertEqual(said['start'][0]['phase'], 'stopped')
        self.assertEqual((said['start'][0]['time_ns'], said['start'][0]['rows_so_far']), (10 ** 9, 0))
        self.assertIn('/coordinator', said['start'][0]['participants'])
        first = said['next'][0]
        self.assertEqual(first['new_rows'][0][2], 'goal')
        self.assertEqual(said['rows'][0]['rows'], first['new_rows'][-2:])
        self.assertEqual(said['round'][0]['round'], first['round'] + 1)
        self.assertEqual(said['run'][0]['time_ns'], said['round'][0]['time_ns'] + 5 * 10 ** 9)
        ended = said['until'][0]
        self.assertIn(['robot_0', 'ended'], [row[1:3] for row in ended['new_rows']])
        robots = {one['name']: one for one in said['robots'][0]['robots']}
        self.assertEqual(robots['robot_0']['goals'], 1)
        self.assertTrue(said['goals'][0]['goals'] == [] or said['goals'][0]['goals'][0]['robot'].startswith('robot_'))
        state = said['where'][0]['state']
        self.assertEqual([one['name'] for one in state['participants']], said['start'][0]['participants'])
        self.assertEqual(state['phase'], 'stopped')
        self.assertEqual(said['why'][0]['state']['phase'], 'stopped')
        self.assertEqual((said['until'][1]['time_ns'], said['until'][1]['phase']), (60 * 10 ** 9, 'paused'))
        self.assertEqual(len(said['messages'][0]['messages']), 3)
        for one in said['messages'][1]['messages']:
            self.assertIn('/coordinator', [one['sender'], *one['receivers']])
        self.assertEqual(said['echo'][0]['type'], 'move_base_msgs/MoveBaseActionResult')
        self.assertIn('Goal reached.', json.dumps(said['echo'][0]['content']))
        self.assertGreater(len(said['help'][0]['help']), 10)
        self.assertIn('result ROBOT', ' '.join(said['help'][1]['help']))
        self.assertEqual(said['back'][0]['rows_so_far'], said['until'][1]['rows_so_far'] - 2)
        self.assertEqual(said['back'][1]['time_ns'], said['back'][0]['time_ns'] - 1_500_000_000)
        self.assertEqual(said['at'][0]['time_ns'], 70 * 10 ** 9)
        self.assertFalse([one for answers in said.values() for one in answers if 'said' in one])

    def test_the_fault_of_a_coordinator_is_found_and_the_way_there_leads_back_to_before_it(self):
        said = self.debug(['until broken', 'rows 1', 'goals', 'back 1', 'echo status',
                           'until row uncaught /coordinator', 'until deadlock'], '--until', '30', self.fault, code=3)
        broken = said['until'][0]
        self.assertEqual((broken['broken']['property'], broken['broken']['node']), ('no_exception', '/coordinator'))
        self.assertIn('KeyError', broken['broken']['text'])
        self.assertEqual(said['rows'][0]['rows'][0][1:3], ['/coordinator', 'uncaught'])
        self.assertEqual(broken['time_ns'], broken['broken']['instant_ns'])
        self.assertLess(said['back'][0]['rows_so_far'], broken['rows_so_far'])
        self.assertEqual(said['until'][1]['time_ns'], broken['time_ns'])
        self.assertEqual(said['until'][1]['new_rows'][-1][2], 'uncaught')
        self.assertEqual(said['until'][2]['phase'], 'ended')

    def test_what_cannot_be_done_says_why_and_the_run_stays_where_it_is(self):
        said = self.debug(['nextt', 'until', 'until 0.5', 'echo /nobody', 'run 0', 'back x', 'rows -1', 'next'],
                          self.fault, code=1)
        self.assertIn("did you mean 'next'", said['nextt'][0]['error'])
        self.assertIn('result ROBOT', said['until'][0]['error'])
        self.assertIn('1', said['until'][1]['error'])
        self.assertIn('no participant', said['echo'][0]['error'])
        for name in ('run', 'back', 'rows'):
            self.assertIn('got', said[name][0]['error'])
        self.assertEqual(said['next'][0]['rows_so_far'], len(said['next'][0]['new_rows']))

    def test_commands_of_a_file_and_answers_for_people(self):
        commands = self.write('commands', '# to the first goal\n\nnext\nwhere\nno_such\n')
        done = subprocess.run([find_executable('debug'), '--commands', commands, self.fault], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, env=self.environment, cwd=self.folder, timeout=GUARD, text=True,
                              stdin=subprocess.DEVNULL, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], '3 participants: /robot/move_base, /coordinator, /ticks')
        self.assertTrue(lines[1].startswith('at 1.000000000 s, 0 rows, round 0: stopped'), lines[1])
        self.assertTrue(lines[3].startswith('row 1: '), lines)
        self.assertTrue(any(line.startswith('/ticks: wakes up at ') for line in lines), lines)
        self.assertTrue(lines[-1].startswith("no_such: 'no_such' is no command"), lines)

    def test_words_that_mean_nothing_here_are_refused(self):
        for words, said in ((['--list', self.fault], 'nothing is started'), (['--use-master', self.fault], 'own'),
                            ([], 'debug: error: a launch file must be given'),
                            (['--log', 'a.jsonl', self.fault], 'besides'),
                            (['--log', self.path('none.jsonl')], 'lockstep_launch --event-log writes it'),
                            (['nothing.launch'], 'nothing.launch')):
            done = subprocess.run([find_executable('debug'), *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  env=self.environment, cwd=self.folder, timeout=GUARD, text=True,
                                  stdin=subprocess.DEVNULL, check=False)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(said, done.stdout)


class SamenessTest(Debugger):

    def test_random_stops_change_nothing(self):
        """Also those within service calls, and while nodes start."""
        rng = random.Random(53)
        plain = self.plain('plain.jsonl', *LONG)
        for number in range(times(1, 5)):
            log = 'debugged_{}.jsonl'.format(number)
            commands = [*(rng.choice(RANDOM) for _ in range(times(30, 60))), 'until end']
            self.debug(commands, '--event-log', log, *LONG)
            self.assertTrue(filecmp.cmp(plain, self.path(log), shallow=False))

    def test_after_the_way_back_the_run_goes_on_as_before(self):
        self.plain('plain.jsonl', *DEMO)
        said = self.debug(['at 50', 'at 20', 'until end', 'at 100', 'until end'], '--log', 'plain.jsonl')
        self.assertEqual([one['phase'] for one in said['until']], ['ended', 'ended'])
        self.assertNotIn('said', str(said['until'] + said['at']))

    def test_a_system_that_does_not_repeat_is_named_with_the_row(self):
        file = self.write('counts.launch', COUNTS)
        said = self.debug(['until message /count', 'back 1', 'until message /count', 'until message /count'],
                          '--log-messages', '--until', '5', file, code=5)
        text = ' '.join(said['until'][1]['said'])
        self.assertIn('is not as it was in the run before', text)
        self.assertIn('/count', text)
        self.assertNotIn('said', said['until'][2])


class LogTest(Debugger):

    def test_a_log_starts_its_run_again_from_another_folder(self):
        os.mkdir(self.path('there'))
        log = self.plain('there/A.jsonl', '--until', '25', '--seed', '3', 'fault.launch', code=3)
        said = self.debug(['until end'], '--log', log, '--at', '4.5', code=3)
        self.assertEqual(said['start'][0]['time_ns'], 4_500_000_000)
        self.assertNotIn('said', said['until'][0])
        said = self.debug(['rows 1'], '--log', log, '--row', '3', code=0)
        self.assertGreaterEqual(said['start'][0]['rows_so_far'], 3)

    def test_a_file_that_has_changed_since_is_named_and_so_is_the_row(self):
        log = self.plain('A.jsonl', '--until', '25', self.fault, code=3)
        self.write('coordinator.py', COORDINATOR.replace('5.0 *', '6.0 *'), 0o755)
        said = self.debug(['until end'], '--log', log, code=5)
        self.assertIn('coordinator.py has changed since', said[''])
        self.assertIn('row 2 is not as in ' + log, said['until'][0]['said'][0])


def has_ended(pid):
    """Return whether a process has ended, even if nobody has asked for its exit code."""
    try:
        with open('/proc/{}/stat'.format(pid)) as stream:
            return stream.read().rpartition(')')[2].split()[0] == 'Z'
    except FileNotFoundError:
        return True


class TerminalTest(Debugger):

    def log_so_far(self):
        """Return the event log of the first run, which goes on."""
        with open(glob.glob(self.path('tmp/*debug_*/run_1/events.jsonl.part'))[0]) as stream:
            return stream.read()

    def begin(self):
        """Debug at a terminal; return (process, function that types a line, list of what it has shown)."""
        os.makedirs(self.path('tmp'), exist_ok=True)
        self.environment['TMPDIR'] = self.path('tmp')
        ours, its = pty.openpty()
        process = subprocess.Popen([find_executable('debug'), '--log-messages', self.fault], stdin=its, stdout=its,
                                   stderr=its, env=self.environment, cwd=self.folder, start_new_session=True)
        os.close(its)
        shown = ['']
        self.addCleanup(os.close, ours)

        def read():
            while True:
                try:
                    shown[0] += os.read(ours, 4096).decode('utf-8', 'replace')
                except OSError:
                    return
        threading.Thread(target=read, daemon=True).start()
        self.addCleanup(process.wait)
        return process, lambda text: os.write(ours, text.encode() + b'\n'), shown

    def test_a_prompt_with_the_time_and_ctrl_c_gives_it_again(self):
        process, type_line, shown = self.begin()
        wait_for('the prompt', lambda: '(1.000 s) ' in shown[0])
        type_line('until 2.5')
        wait_for('the next prompt', lambda: '(2.500 s) ' in shown[0])
        process.send_signal(signal.SIGINT)
        wait_for('the prompt again', lambda: shown[0].count('(2.500 s) ') > 1)
        type_line('until end')  # it has none
        wait_for('the run to go on', lambda: 'uncaught' in self.log_so_far())
        process.send_signal(signal.SIGINT)
        wait_for('the prompt with a later time', lambda: re.search(r'\n\(\d{2,}\.\d{3} s\) ', shown[0]))
        type_line('quit')
        self.assertEqual(process.wait(GUARD), 3)  # a node crashed

    def test_nothing_stays_however_it_ends(self):
        for number in (signal.SIGTERM, signal.SIGKILL):
            process, _, shown = self.begin()
            wait_for('the prompt', lambda shown=shown: '(1.000 s) ' in shown[0])
            pids = [pid for one in children_of(process.pid) for pid in (one, *children_of(one))]
            self.assertTrue(pids)
            process.send_signal(number)
            self.assertIn(process.wait(GUARD), (128 + number, -number))
            for pid in pids:
                wait_for('the end of the run', lambda pid=pid: has_ended(pid))
