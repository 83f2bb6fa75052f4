"""Scripts as users write them, in lockstep by the launcher alone: the same in each run, and exact in simulated time.

Each group of scripts is a system that runs three times: twice at full speed on a loaded machine, once at most 50 times
as fast as real time.
"""

import os
import re
import sys
import unittest

from lockstep_launcher_run import FOLDER, Scenario, assert_same, run_programs, run_scenario

ROBOTS = [{'name': 'robot_0', 'tf_heartbeat_freq': 10.0}] + [
    {'name': 'robot_{}'.format(i), 'start_y': 10.0 * (i - 3) if i in (3, 4) else 0.0} for i in range(1, 8)]


class UnmodifiedTest(unittest.TestCase):
    def test_they_know_nothing_of_this_package(self):
        scripts = [name for name in os.listdir(FOLDER) if name.endswith('.py')]
        self.assertGreaterEqual(len(scripts), 10)
        for name in scripts:
            with open(os.path.join(FOLDER, name)) as script:
                self.assertIsNone(re.search('move_base_abstract|lockstep', script.read()), name)


class DrivingTest(Scenario, unittest.TestCase):
    """Scripts that drive robots."""

    programs = {
        'poller': ['poller.py', '_ticks:=20', 'odom:=/robot_0/odom'],
        'flags': ['flags.py', 'move_base:=/robot_0/move_base'],
        'dispatcher': ['chain_handles.py'],
        'threads': ['thread_per_robot.py'],
        'tour': ['chain_simple.py', 'move_base:=/robot_5/move_base'],
        'machine': ['state_machine.py', 'move_base:=/robot_6/move_base'],
        'walker': ['random_walk.py', 'move_base:=/robot_7/move_base'],
        'follower': ['tf_follower.py'],
    }
    until, settings = 60.0, {'fleet': ROBOTS, 'parameters': {
        '/dispatcher/robots': ['robot_1', 'robot_2'], '/threads/robots': ['robot_3', 'robot_4']}}

    def test_all_come_to_their_ends(self):
        self.assertEqual({code for run in self.runs for name, code in run.codes.items() if name != 'fleet'}, {0})
        self.assertGreater(self.runs[0].log.count(b'\n'), 300)

    def test_nothing_is_warned_of_but_what_is_there(self):
        for name in self.runs[0].outputs:
            self.assertEqual(self.runs[0].logged(name, 'WARN') + self.runs[0].logged(name, 'ERROR'), [], name)

    def test_a_polling_loop_ticks_once_a_second(self):
        ticks = [line.split()[:3] for line in self.printed('poller')]
        self.assertEqual(ticks, [['%.9f' % (1.0 + n), 'tick', str(n)] for n in range(1, 21)])
        # It drives at 1 m/s, to 2 m from 1 s to 3 s and back from 3.05 s to 5.05 s. Its pose comes at 10 Hz.
        self.assertIn(' x=1.100000 ', self.printed('poller')[2])
        self.assertIn(' x=0.000000 ', self.printed('poller')[4])

    def test_callbacks_set_flags_for_a_loop_of_sleeps(self):
        self.assertEqual(self.printed('flags'), [
            '3.050000000 at 2.0 after 41 looks', '5.100000000 at 0.0 after 41 looks', 'feedbacks: 82'])

    def test_goals_that_are_chained_in_done_cb(self):
        self.assertEqual(self.printed('tour'), [
            '1.000000000 active', '4.000000000 SUCCEEDED, 2 to go', '4.500000000 active',
            '6.500000000 SUCCEEDED, 1 to go', '7.000000000 active', '10.605551275 SUCCEEDED, 0 to go',
            '11.105551275 finished'])

    def test_goals_that_are_chained_by_handles_draw_from_one_generator(self):
        lines = self.printed('dispatcher')
        self.assertEqual(sorted(line.split()[1:] for line in lines[:-1]),
                         [['robot_1', '3']] * 5 + [['robot_2', '3']] * 5)
        last = float(lines[-2].split()[0])
        self.assertRegex(lines[-1], '^[0-9]+[.][0-9]00000000 all done$')  # it checks ten times a second
        self.assertTrue(last <= float(lines[-1].split()[0]) < last + 0.1 + 1e-9, lines[-2:])

    def test_a_thread_per_robot(self):
        self.assertEqual(self.printed('threads'), [
            '4.000000000 robot_3 is at 3.0 (3), 1 so far', '4.000000000 robot_4 is at 3.0 (3), 2 so far',
            '7.000000000 robot_3 is at 1.0 (3), 3 so far', '7.000000000 robot_4 is at 1.0 (3), 4 so far',
            # 19 m at 1 m/s take longer than the allowed 6 s, so the goal is pre-empted.
            '14.000000000 robot_3 is at 20.0 (2), 5 so far', '14.000000000 robot_4 is at 20.0 (2), 6 so far',
            "15.000000000 ['robot_3', 'robot_4', 'robot_3', 'robot_4', 'robot_3', 'robot_4']"])

    def test_a_state_machine_with_timeouts(self):
        self.assertEqual(self.printed('machine'), [
            '1.000000000 connect', '1.000000000 drive', '3.000000000 timeout', '3.000000000 after cancel: PREEMPTED',
            '3.500000000 drive', '7.500000000 timeout', '7.500000000 after cancel: PREEMPTED',
            '8.000000000 drive', '9.000000000 arrived'])

    def test_global_generators_are_seeded_by_the_name_of_the_node(self):
        self.assertEqual(len(self.printed('walker')), 5)
        words = ['random_walk.py', 'move_base:=/robot_7/move_base']
        other = run_programs({'other': words}, until=60.0, fleet=ROBOTS[7:])
        again = run_programs({'walker': words}, until=60.0, fleet=ROBOTS[7:])
        seeded = run_programs({'walker': [['--seed', '1'], *words]}, until=60.0, fleet=ROBOTS[7:])
        self.assertEqual(again.printed('walker'), self.printed('walker'))
        self.assertNotEqual(other.printed('other'), self.printed('walker'))
        self.assertNotEqual(seeded.printed('walker'), self.printed('walker'))

    def test_a_tf2_listener(self):
        lines = self.printed('follower')
        # The robot stands, and its first transform is a heartbeat. A look-up polls in hundredths of its time-out.
        self.assertEqual(lines[0], '1.050000000 first -10.000')
        # It drives at 1 m/s, from 0 to 2 m between 1 s and 3 s, and back until 5.05 s. The landmark is at 10 m.
        for line in lines[1:-1]:
            found = re.match('^([0-9.]+) ([0-9.]+) of ([0-9.]+)$', line)
            self.assertIsNotNone(found, line)
            _, distance, of = (float(text) for text in found.groups())
            driven = of - 1.0 if of <= 3.0 else 2.0 if of <= 3.05 else max(0.0, 5.05 - of)
            self.assertAlmostEqual(distance, 10.0 - driven, delta=0.0006, msg=line)
        self.assertEqual(len(lines), 18)
        self.assertRegex(lines[-1], '"nowhere" passed to lookupTransform')


class TalkingTest(Scenario, unittest.TestCase):
    """Scripts that send messages to each other."""

    programs = {
        'battery': ['timer_publisher.py'], 'charger': ['message_loop.py'],
        'depot': ['answerer.py'], 'worker_1': ['asker.py'], 'worker_2': ['asker.py', '_persistent:=true'],
        'workshop': ['queue_worker.py'], 'giver': ['job_giver.py'],
        'settings': ['latched_writer.py'], 'reader': ['latched_reader.py'],
        'sync': ['synchronizer.py'],
        'left': ['sensor.py', '_rate:=5.0', '~out:=/left', '~other:=/right'],
        'right': ['sensor.py', '_rate:=2.5', '_delay:=0.1', '~out:=/right', '~other:=/left'],
    }
    until = 25.0

    def test_a_timer_fires_at_its_times_and_no_other(self):
        lines = [line for line in self.printed('battery') if 'charged' not in line]
        self.assertEqual([line.split()[:3] for line in lines],
                         [['%.9f' % t, 'expected', '%.9f' % t] for t in range(2, 26)])

    def test_messages_are_waited_for_in_a_loop(self):
        # A message comes each full second. A wait of 0.75 s ends at 1.75 s, and then the next wait begins.
        expected, time_is_up = [], '.750000000 timeout exceeded while waiting for message on topic battery'
        for second, level in zip(range(2, 7), ('0.97', '0.93', '0.89', '0.97', '0.93')):
            expected.append('{}{}'.format(second - 1, time_is_up))
            expected.append('{}.000000000 level {}'.format(second, level))
        self.assertEqual(self.printed('charger'), expected)
        self.assertIn('4.000000000 charged', self.printed('battery'))

    def test_services_that_take_time_and_fail(self):
        for name, left in (('worker_1', 1), ('worker_2', 0)):
            self.assertEqual(self.printed(name), [
                '2.000000000 timeout exceeded while waiting for service /depot/take'] + [
                '{:.9f} True {} left'.format(3.3 + 0.8 * n, left) for n in range(6)] + [
                "7.800000000 service [/depot/give] responded with an error: b'error processing request: what shall I "
                "do with that?'"])
        self.assertIn('what shall I do with that?', self.runs[0].logged('depot', 'ERROR')[0])

    def test_workers_take_jobs_out_of_a_queue(self):
        # A job comes every 0.2 s from 2 s on and takes 1.5 s. Two run, three are queued, job 7 waits 1 s in vain.
        self.assertEqual(self.printed('workshop'), [
            '3.500000000 worker 0 did job 0', '3.700000000 worker 1 did job 1', '4.700000000 no room for job 7',
            '5.000000000 worker 0 did job 2', '5.200000000 worker 1 did job 3', '6.500000000 worker 0 did job 4',
            '6.700000000 worker 1 did job 5', '8.000000000 worker 0 did job 6', '8.200000000 worker 1 did job 8',
            '12.000000000 worker 0 has nothing to do', '12.200000000 worker 1 has nothing to do',
            '12.200000000 closed'])
        self.assertEqual(self.printed('giver')[-2:], ['6.700000000 6 done', '6.700000000 over'])

    def test_latched_topics_as_settings(self):
        self.assertEqual(self.printed('reader'), [
            '1.000000000 day 1.0', '4.000000000 day 1.5', '7.000000000 day 2.5', '10.000000000 day 3.0',
            '13.000000000 night 3.5'])

    def test_message_filters_bring_together_what_belongs_together(self):
        lines = self.printed('sync')
        exact = [line for line in lines if 'exact' in line]
        # Both measure every 0.4 s; the second sensor needs 0.1 s. The first messages came before all nodes listened.
        self.assertEqual(exact, ['{:.9f} exact {:.3f} {} {}'.format(1.1 + 0.4 * n, 1.0 + 0.4 * n, 2 * n, n)
                                 for n in range(1, 13)])
        self.assertEqual(lines[-1], '7.000000000 15 since 3')

    def test_any_message(self):
        self.assertEqual(self.printed('left'), ['6.000000000 25 of mine, 13 of the other'])
        self.assertEqual(self.printed('right'), ['6.200000000 13 of mine, 24 of the other'])


class ConcurrentStatesTest(unittest.TestCase):
    """Concurrent states, in threads that are not daemons."""

    def test_they_end_by_themselves_and_each_run_is_the_same(self):
        runs = run_scenario({'states': ['concurrence.py', '2']}, until=100.0)
        self.assertEqual(runs[0].codes, {'states': 0}, runs[0].outputs)
        self.assertEqual(runs[0].printed('states'), [
            "5.500 0 [('long', 'preempted at step 9'), ('monitor', 'heard'), ('short', 'done')]",
            "9.500 1 [('long', 'preempted at step 8'), ('monitor', 'heard'), ('short', 'done')]"])
        assert_same(self, runs)

    def test_they_do_not_keep_a_program_alive_when_the_run_is_over(self):
        run = run_programs({'states': ['concurrence.py', '1000']}, until=8.0)
        self.assertEqual(run.codes, {'states': 1}, run.outputs)  # it would be None if it had to be killed
        self.assertIn('the time master has ended lockstep', run.outputs['states'])


class OutsideTest(unittest.TestCase):
    def test_a_call_of_a_service_of_a_node_that_does_not_take_part_is_answered_and_labelled(self):
        other = [sys.executable, os.path.join(FOLDER, os.pardir, 'onlooker.py'), '/nothing']
        run = run_programs({'asks': ['asks_outside.py']}, until=50.0, others={'/other': (other, 0)})
        self.assertEqual(run.printed('asks')[-1], 'answered: True', run.outputs)
        self.assertIn("'/asks': service /other/get_loggers, which was called, is offered by a node that does not take "
                      'part', run.state.not_repeatable_because)

    def test_a_call_of_one_whose_handler_waits_for_simulated_time_is_answered_after_a_while(self):
        other = [sys.executable, os.path.join(FOLDER, os.pardir, 'slow_service.py')]
        run = run_programs({'asks': ['asks_slowly.py']}, until=200.0, others={'/other': (other, 0)},
                           clock={'speed_limit': 20.0})
        self.assertEqual(run.printed('asks'), ['answered: True', 'later: True'], run.outputs)
        self.assertIn("'/asks': service /slow of a node that does not take part has not answered for 5 s of wall time: "
                      'simulated time goes on until it does', run.state.not_repeatable_because)


class EndTest(unittest.TestCase):
    """The phase of a run in which nothing is left to happen while threads wait."""

    def end_of(self, what):
        run = run_programs({'waiter': ['waits_in_the_end.py', what]}, until=1000.0)
        self.assertEqual(run.state.not_repeatable_because, [])
        return run.state

    def test_threads_that_wait_for_work_are_idle_and_so_is_who_waits_for_their_end(self):
        state = self.end_of('jobs')
        self.assertEqual((state.phase, state.time, state.reason), ('paused', 1000.0, ''))  # the end of the run

    def test_a_call_that_waits_for_itself_is_a_deadlock(self):
        state = self.end_of('itself')
        self.assertEqual(state.phase, 'deadlock')
        self.assertRegex(state.reason, "'/waiter' has 3 waiting threads .*the answer of service /serve.*line [0-9]+")

    def test_a_goal_that_nobody_ends_is_a_deadlock_also_where_it_is_waited_for_by_an_event(self):
        state = self.end_of('goal')
        self.assertEqual(state.phase, 'deadlock')
        self.assertRegex(state.reason, "by a condition or an event .*; '/waiter' has 1 goal open on /go|"
                                       "by a condition or an event .*, '/waiter' has 1 goal open on /go")
