"""The results of a run in lockstep: the event log and compare, why, nodes that do not take part, the end.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import json
import os
import shutil
import signal
import subprocess

import lockstep_raw_client as raw
import rospy
from lockstep_run import GUARD, NEVER, SECOND, START, LockstepCase, wait_for

from move_base_abstract.runs.event_log import EventLog, open_text

LAUNCH_FILE = """
<launch>  <!-- the results of a run in lockstep: the event log and compare, why, bystanders, the end -->
  <param name="/use_sim_time" value="true"/>
</launch>
"""


class LockstepResultsTest(LockstepCase):
    # ---- event log ----

    def run_with_log(self, name, order=(0, 1, 2), value=1.5, number=signal.SIGTERM):
        """Make a run of three participants that report in this order of wall time; return the path of its log."""
        path = self.path(name)
        self.start(participants=['/r2', '/r10', '/a'], event_log=path)
        clients = [self.join(name) for name in ('/r10', '/r2', '/a')]
        for step in range(3):
            grants = [client.grant() for client in clients]
            for index in order:
                items = raw.log(f'robot "{index}"', 'step', f'[{step},{value}]') if index < 2 else b''
                clients[index].report(grants[index], next_ns=grants[index].time_ns + SECOND if step < 2 else NEVER,
                                      items=items)
        wait_for('idle', lambda: self.state.messages[-1].phase == 'idle')
        self.assertEqual(self.end(number), 0, self.output())
        self.assertFalse(os.path.exists(path + '.part'))
        return path

    def events(self, path):
        with open_text(path) as stream:
            log = EventLog(stream, path)
            return [(event.time_ns, event.robot, event.kind, event.values) for event in log], log.end

    def test_the_log_is_complete_after_a_signal_and_in_the_stated_order(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            events, end = self.events(self.run_with_log('run.jsonl', number=number))
            self.assertEqual(events, [(START + step * SECOND, f'robot "{index}"', 'step', f'[{step}, 1.5]')
                                      for step in range(3) for index in (1, 0)])
            self.assertEqual((end['events'], end['repeatable'], end['degraded_because']), (6, True, []))
            self.tearDown()

    def test_compare_says_identical_whatever_the_order_of_the_reports_and_the_format(self):
        first = self.run_with_log('a.jsonl')
        self.tearDown()
        second = self.run_with_log('b.csv', order=(2, 1, 0))
        done = self.run_script('compare', first, second)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, 'identical\n6 events each\n', ''))

    def test_compare_shows_the_first_difference(self):
        first = self.run_with_log('a.jsonl')
        self.tearDown()
        second = self.run_with_log('b.csv', value=1.25)
        done = self.run_script('compare', first, second)
        self.assertEqual(done.returncode, 1)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], 'different')
        self.assertTrue(lines[1].startswith(f'{first}:2: {{"time_ns":1000000000,"robot":"robot \\"1\\""'), lines[1])
        self.assertEqual(lines[2], f'{second}:3: 1000000000,"robot ""1""",step,"[0,1.25]"')
        self.assertEqual(lines[3], f'{first} has 6 events, {second} has 6')
        done = self.run_script('compare', first, self.path('none.jsonl'))
        self.assertEqual((done.returncode, done.stdout), (2, ''))
        self.assertIn('none.jsonl: cannot be read', done.stderr)

    def test_compare_names_an_unfinished_run_and_one_that_is_not_repeatable(self):
        whole = self.run_with_log('a.jsonl')
        self.tearDown()
        self.start(participants=['/a'], event_log=self.path('b.jsonl'))
        client = self.join('/a')
        client.turn(items=raw.note(2, 'the wall clock was asked') + raw.note(3, 'a sensor failed')
                    + raw.log('robot', 'odd', 'no JSON'))
        self.state.wait('the labels', lambda state: not state.repeatable and state.degraded_because)
        shutil.copy(self.path('b.jsonl.part'), self.path('early.jsonl'))
        self.end()
        events, _ = self.events(self.path('b.jsonl'))
        self.assertEqual(events, [(START, 'robot', 'odd', '["no JSON"]')])
        done = self.run_script('compare', whole, self.path('b.jsonl'))
        self.assertIn(f"note: {self.path('b.jsonl')} is not repeatable: '/a': the wall clock was asked\n", done.stdout)
        self.assertIn(f"note: {self.path('b.jsonl')} is degraded: '/a': a sensor failed\n", done.stdout)
        done = self.run_script('compare', whole, self.path('early.jsonl'))
        self.assertIn('early.jsonl has no end record', done.stdout)

    # ---- why ----

    def why(self, *arguments):
        done = self.run_script('why', *arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        return done.stdout

    def test_why_says_who_owes_what_and_the_next_wake_up(self):
        self.start(participants=['/a', '/b'])
        first = self.join('/a')
        answer = self.why()
        self.assertIn('time stands still: the run has not started\n', answer)
        self.assertIn('/b owes its HELLO, for ', answer)
        second = self.join('/b')
        first.turn(next_ns=3 * SECOND, waiting=1, items=raw.note(1, 'the end of goal 7'))
        second.turn(next_ns=2 * SECOND)
        second.grant()
        # Not the state in which it owed its HELLO, which may still be the last one heard.
        self.state.wait('b owing in round 2', lambda state: (
            state.rounds == 2 and [one.name for one in state.waiting_for] == ['/b']))
        answer = self.why()
        self.assertIn('/b owes the report of round 2 (wake-up due), for ', answer)
        self.assertIn('next wake-up: 3.000000000 s, of /a\n', answer)
        self.assertIn('/a: 1 thread waiting without end; the end of goal 7\n', answer)
        self.assertIn('participants: /a, /b\n', answer)
        self.assertIn('repeatable so far\n', answer)
        data = json.loads(self.why('--json'))
        self.assertEqual((data['mode'], data['sim_time_ns'], data['waiting_for'][0]['name'], data['bystanders']),
                         ('lockstep', 2 * SECOND, '/b', [rospy.get_name()]))
        self.assertEqual(data['participants'][0]['next_ns'], 3 * SECOND)

    def test_why_tells_a_deadlock_and_a_scaled_clock(self):
        self.start(participants=['/a'])
        self.join('/a').turn(waiting=1)
        self.state.wait('the deadlock', lambda state: state.phase == 'deadlock')
        self.assertRegex(self.why(), r"stands still: deadlock\n[^\n]*\ndeadlock at 1 s: .*'/a' has 1 waiting thread")
        self.tearDown()
        self.start(mode='scaled', factor=4.0)
        self.assertIn('time moves at 4 times real time\n', self.why())

    def test_why_says_so_where_no_time_master_answers(self):
        done = self.run_script('why', '--timeout', '0.5')
        self.assertEqual((done.returncode, done.stdout), (1, ''))
        self.assertIn('no time master answers on /time_master/state within 0.5 s', done.stderr)

    # ---- nodes that do not take part ----

    def test_nodes_that_use_the_clock_and_do_not_take_part_are_listed_and_warned_of(self):
        self.start(participants=['/a'])
        command = [shutil.which('rostopic'), 'echo', '/clock', '__name:=onlooker']
        self.others.append(subprocess.Popen(command, stdout=subprocess.DEVNULL))
        self.joined('/a')
        state = self.state.wait('an onlooker', lambda state: '/onlooker' in state.bystanders)
        self.assertNotIn('/a', state.bystanders)
        self.assertNotIn('/time_master', state.bystanders)
        for name in state.bystanders:  # in one line, or in a line for each, as they came
            wait_for(f'a warning of {name}', lambda name=name: any(
                'time does not wait for' in line and name in line for line in self.output().splitlines()))
        self.assertIn('do not take part): ' + ', '.join(state.bystanders), self.why())

    # ---- the end ----

    def test_a_deadlock_is_no_good_end(self):
        self.start(participants=['/a'], end_when_idle=True)
        client = self.join('/a')
        client.turn(waiting=1)
        self.assertIn('deadlock', client.end())
        self.assertEqual(self.process.wait(GUARD), 1)

    def test_a_signal_tells_the_participants_that_the_run_is_over(self):
        self.start(participants=['/a'])
        client, = self.joined('/a')
        self.assertEqual(self.end(signal.SIGINT), 0, self.output())
        self.assertEqual(client.end(), 'the time master was told to end')
        self.assertFalse(self.master.hasParam('/time_master/lockstep_address'))
