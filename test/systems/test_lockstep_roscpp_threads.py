"""Unmodified roscpp programs with threads in lockstep: one thread runs at a time, always in the same order."""

import os
import re
import shutil
import signal
import tempfile
import time
import unittest

import rosgraph
from lockstep_roscpp_run import GUARD, Program, Runs, own, read, recorder
from warm import Loopback

from move_base_abstract_ros.lockstep.programs.binary import find_shim

RUNS = Runs()
SECOND = 10 ** 9
LOOPS = find_shim(os.environ, 'libtbb_stand_in.so')
BROODER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'unmodified', 'brooder.py')


def rate(name='rate', frequency=10.0, ticks=100, topic=None):
    remaps = [f'ticks:={topic}'] if topic else []
    return Program(name, own('shim_rate'), frequency=frequency, ticks=ticks, remaps=remaps)


class LockstepRoscppThreadsTest(unittest.TestCase):
    def told(self, what, *others, program='shim_threads', **parameters):
        """Return the messages of a program with threads, [(ns, text), ...]. They are the same in each run."""
        program = Program('threads', own(program), what=what, **parameters)
        runs = RUNS.scenario([program, recorder('/told', '/polled'), *others])
        for run in runs:
            self.assertEqual(run.code, 0, run.outputs)
            self.assertEqual(run.labels, [])
            self.assertEqual(run.printed(1), runs[0].printed(1))
        told = [line.split(' ', 3) for line in runs[0].printed(1)]
        self.assertTrue(told)
        for at, _topic, said, _text in told:
            self.assertEqual(at, said)  # the times of arrival and of sending
        return [(int(at), text) for at, _topic, _said, text in told]

    def test_a_thread_for_each_robot_and_a_lock_that_is_held_in_a_sleep(self):
        told = self.told('robots')
        self.assertEqual(told[:4], [(1250000000, 'robot 3 has the lock'), (1300000000, 'robot 3 leaves it'),
                                    (1333333333, 'robot 2 has the lock'), (1383333333, 'robot 2 leaves it')])
        self.assertEqual(len(told), 80)
        for (taken, who), (left, leaver) in zip(told[::2], told[1::2]):
            self.assertEqual((left - taken, leaver.split()[1]), (50000000, who.split()[1]))

    def test_waits_for_conditions_time_out_in_simulated_time(self):
        told = self.told('queue')
        self.assertEqual(told[:5], [(1100000000, 'first takes 0'), (1200000000, 'second takes 1'),
                                    (1300000000, 'first takes 2'), (1700000000, 'second has waited in vain'),
                                    (1800000000, 'first has waited in vain')])

    def test_an_async_spinner_runs_callbacks_side_by_side(self):
        told = self.told('spinners', rate(), rate('rate2', 3.0, 50, 'others'), threads=3)
        begins = {text: at for at, text in told}
        self.assertEqual(begins['ticks begins 1 1100000000'], 1100000000)
        self.assertEqual(begins['others begins 1 1333333333'], 1333333333)  # while the other callback sleeps
        self.assertEqual(begins['ticks ends 1 1100000000'], 1450000000)

    def test_a_multi_threaded_program_with_one_thread_in_its_spinner(self):
        told = self.told('spinners', rate(), rate('rate2', 3.0, 50, 'others'), threads=1)
        begins = {text: at for at, text in told}
        # After the second and the third message of the other topic, which came before it.
        self.assertEqual(begins['others begins 1 1333333333'], 2150000000)

    def test_queues_connect_callbacks_periods_and_a_multi_threaded_spinner(self):
        told = self.told('queues', rate(ticks=5))
        self.assertEqual(told[:4], [(1030000000, 'round 0'), (1060000000, 'round 1'), (1090000000, 'round 2'),
                                    (1100000000, 'heard 1 1100000000')])
        self.assertEqual(told[-7:], [(1300000000, '/recorder listens'), *(
            (at * 10000000, 'fired') for at in (155, 205, 255, 355, 455, 555))])

    def test_callbacks_that_wait_for_nothing_stay_in_one_thread_of_an_async_spinner(self):
        told = self.told('pool', rate())
        self.assertEqual([text for _at, text in told], ['heard in thread 1'] * 100)

    def test_of_two_async_spinners_one_ends_and_the_other_goes_on(self):
        told = self.told('two_spinners', rate(ticks=10))
        ticks = [(SECOND + k * SECOND // 10, f'heard {k} {SECOND + k * SECOND // 10}') for k in range(1, 11)]
        self.assertEqual(told, ticks[:5] + [(1550000000, 'second has ended')] + ticks[5:])

    def test_a_loop_that_hears_messages_and_only_looks_asks_for_no_instants_between_them(self):
        program = Program('threads', own('shim_threads'), what='hears')
        run = RUNS.run([program, recorder('/told'), rate(frequency=2.0, ticks=50)], ask_why=True)
        told = [line.split(' ', 3)[3] for line in run.printed(1)]
        self.assertEqual(told, [f'heard {k} {SECOND + k * SECOND // 2}' for k in range(1, 51)] + ['ends'])
        # 50 ticks, the end, and some looks until it is known as a loop that only looks; otherwise 3 looks per message.
        self.assertLess(int(re.search(r'(\d+) leaps', run.why).group(1)), 60, run.why)

    def test_threads_that_look_at_a_flag_see_it_in_their_time_out_and_at_once_where_they_are_joined(self):
        told = self.told('looks')
        self.assertEqual([text for _at, text in told], ['sets it', 'sees it', 'joins', 'ends', 'has joined'])
        sets, sees, joins, ends, has_joined = (at for at, _text in told)
        self.assertEqual(sets, 1333333330)
        self.assertTrue(sets < sees <= sets + 200000000, told)
        self.assertEqual((ends, has_joined), (joins, joins))

    def test_timers_of_the_wall_fire_at_instants_of_simulated_time_which_the_program_sees_by_its_clocks(self):
        expected = [(10, 'wall'), (20, 'steady'), (20, 'wall'), (30, 'wall'), (40, 'steady'), (60, 'steady'),
                    (80, 'steady'), (80, 'wall'), (100, 'steady'), (100, 'steady'), (120, 'steady'), (130, 'wall')]
        self.assertEqual(self.told('wall'), [
            (SECOND + at * 10 ** 6, f'{kind} {at * 10 ** 6}') for at, kind in expected])

    def test_an_event_loop_waits_in_simulated_time_for_its_timers_and_for_what_the_programs_threads_hand_it(self):
        ticks = [(SECOND + k * SECOND // 10, f'tick {6 - k}') for k in range(1, 6)]
        self.assertEqual(self.told('main', program='shim_event_loop'),
                         [*ticks, (1730000000, 'late'), (1730000000, 'has run')])
        self.assertEqual(self.told('looks', program='shim_event_loop'),
                         [(SECOND + k * SECOND // 4, f'tick {6 - k}') for k in range(1, 6)])
        self.assertEqual(self.told('other', program='shim_event_loop'), [(1400000000, 'other')])
        told = self.told('thread', rate(frequency=3.0, ticks=50), program='shim_event_loop')
        ticks = [text for _at, text in told if text.startswith('tick')]
        self.assertEqual(ticks, [f'tick {k}' for k in range(10, 0, -1)])
        self.assertEqual([(at, text) for at, text in told if text.startswith('posted')], [
            (SECOND + k * SECOND // 3, f'posted {k} {SECOND + k * SECOND // 3}') for k in (1, 2)] + [
            (1999999999, 'posted 3 1999999999')])

    def test_an_event_loop_with_a_connection_is_labelled_and_its_timers_go_by_simulated_time_all_the_same(self):
        run = RUNS.run([Program('threads', own('shim_event_loop'), what='connected'), recorder('/told')])
        self.assertEqual([line.split(' ', 1)[0] for line in run.printed(1)],
                         [str(SECOND + k * SECOND // 10) for k in range(1, 6)])
        self.assertIn('epoll_wait() looks at a connection', ' '.join(run.labels))

    def test_polls_come_to_an_end(self):
        told = self.told('', rate(ticks=10), program='shim_polls')
        self.assertEqual([text for _at, text in told], [
            'somebody listens', 'five are heard', 'time has gone on after 1089998 looks',  # for 10 ms
            'a latched message was there each time'])
        self.assertLess(told[-1][0] - told[-2][0], 25000000)
        self.assertLess(told[1][0], 1510000000)  # the fifth message came at 1.5 s

    def test_a_loop_that_sleeps_by_the_wall_clock_takes_simulated_time_from_its_sixth_second_on(self):
        run = RUNS.run([Program('threads', own('shim_threads'), what='wall_loop'), recorder('/told')])
        self.assertEqual((run.code, len(run.printed(1)), len(run.labels)), (0, 1, 1), (run.outputs, run.labels))
        self.assertIn('from here on its sleeps take simulated time', run.labels[0])

    def test_a_sleep_in_which_the_run_ends_lasts_until_the_node_has_shut_down(self):
        run = RUNS.run([Program('threads', own('shim_threads'), options=['--sleep', 'simulated'], what='naps')],
                       end_at=1.05)
        self.assertEqual(run.printed(0), [f'{1.0 + k / 1000:.3f}' for k in [*range(1, 51), 50]], run.outputs)

    def test_no_grant_waits_for_a_poll_however_many_threads_there_are(self):
        run = RUNS.run([Program('threads', own('shim_threads'), what='crowd')])  # polls would take longer than GUARD
        self.assertEqual((run.code, run.labels), (0, []), run.outputs)

    def stands(self, what, **parameters):
        """Check that a call that takes a second of wall time takes no simulated time and has no label.

        The only label is that of the shell, which makes the call take that long.
        """
        run = RUNS.run([Program('threads', own('shim_threads'), what=what, **parameters), recorder('/told')])
        self.assertEqual((run.code, len(run.labels)), (0, 1), (run.outputs, run.labels))
        self.assertIn('system() starts a process', run.labels[0])
        told = [line.split(' ', 3)[2:] for line in run.printed(1)]
        ticks = [[str(SECOND + k * SECOND // 10), f'tick {k}'] for k in range(1, 13)]
        self.assertEqual(told, ticks[:5] + [['1550000000', 'goes on']] + ticks[5:])

    def test_time_stands_while_the_ros_master_does_not_answer(self):
        self.stands('master', master=lambda ros: rosgraph.Master('/test', master_uri=ros.uri).getPid())

    def test_time_stands_while_nobody_reads_what_is_printed(self):
        self.stands('output')

    def test_time_stands_while_a_name_is_looked_up(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        self.stands('names', aliases=os.path.join(folder, 'aliases'))

    def test_what_threads_allocate_lies_where_it_does_in_each_run(self):
        """Sets of objects and of messages by address, filled by an AsyncSpinner, and all ways to allocate."""
        programs = [Program('heap', own('shim_heap'), what='spinners'), recorder('/told'), rate(frequency=20.0),
                    rate('rate2', 13.0, 60, 'others')]
        told = []
        for run in RUNS.scenario(programs):
            self.assertEqual((run.code, run.labels), (0, []), run.outputs)
            told.append(run.printed(1))
            self.assertEqual(told[-1], told[0])
        self.assertGreater(len(told[0]), 100)
        addresses = [int(one, 16) for line in told[0] for one in re.findall('0x[0-9a-f]+', line)]
        self.assertEqual([at for at in addresses if not 0 < at - (1 << 44) < 1 << 37], [])
        self.assertEqual(told[0].pop().split(' ')[-3:], ['again', '1', '3000'])  # memory that holds zeros
        *_calls, failed, non_zero, again, large = told[0][-1].split(' ')
        self.assertEqual((failed, non_zero), ('0', str(2 ** 64 - 1)))
        self.assertIn(' {} 1 '.format(again), told[0][-1])  # memory that another thread freed
        self.assertIn(' {} 1 '.format(large), told[0][-1])

    def test_threads_that_have_ended_leave_nothing(self):
        run = RUNS.run([Program('heap', own('shim_heap'), what='threads'), recorder('/told')])
        self.assertEqual([line.split(' ', 2)[2] for line in run.printed(1)], ['threads leave nothing'])
        self.assertEqual(run.labels, [])

    def test_a_loop_that_gives_way_until_another_thread_changes_a_variable_lets_time_go_on(self):
        run = RUNS.run([Program('heap', own('shim_heap'), what='ways'), recorder('/told')])
        self.assertEqual((run.code, run.labels), (0, []), run.outputs)
        self.assertEqual([line.split(' ', 2)[2] for line in run.printed(1)], [
            text for k in range(10) for text in ('sets it', f'sees it {200 + 50 * k}')])

    def test_a_loop_that_computes_until_another_thread_changes_a_variable_is_labelled_and_no_hang(self):
        os.environ['MOVE_BASE_ABSTRACT_COMPUTE_LIMIT'] = '0.5'
        self.addCleanup(os.environ.pop, 'MOVE_BASE_ABSTRACT_COMPUTE_LIMIT')
        run = RUNS.run([Program('heap', own('shim_heap'), what='spins'), recorder('/told')])
        self.assertEqual(run.code, 0, run.outputs)
        self.assertEqual([line.split(' ', 3)[2] for line in run.printed(1)], ['sets', 'sees'])
        self.assertEqual(len(run.labels), 1, run.labels)
        self.assertIn("'/heap': a thread computes at one instant while others wait", run.labels[0])

    def test_a_library_that_has_a_thread_for_each_core_has_one_and_time_stands_while_it_works(self):
        told = self.told('', program='shim_pool', library=LOOPS)
        self.assertEqual(told, [(k * SECOND, 'threads: 1') for k in (2, 3, 4)])

    def test_a_program_that_wants_more_threads_of_a_library_keeps_them_and_is_labelled(self):
        run = RUNS.run([Program('pool', own('shim_pool'), library=LOOPS, threads=2), recorder('/told')])
        self.assertEqual([line.split(' ', 3)[3] for line in run.printed(1)], ['threads: 2'] * 3)
        place = r' \(\S*/shim_pool\+0x[0-9a-f]+\)$'
        self.assertEqual(len(run.labels), 2, run.labels)
        self.assertRegex(run.labels[0], r"'/pool': a library starts threads for its sums or loops .*" + place)
        self.assertRegex(run.labels[1], r"'/pool': sched_yield\(\).* while a thread works .*" + place)

    def test_a_wait_that_cannot_be_followed_is_labelled_and_no_hang(self):
        run = RUNS.run([Program('threads', own('shim_threads'), what='hidden'), recorder('/told')])
        self.assertEqual(run.code, 0, run.outputs)
        self.assertEqual([line.split(' ', 3)[3] for line in run.printed(1)], ['writes', 'got 7', 'goes on'])
        self.assertEqual(len(run.labels), 1, run.labels)
        self.assertRegex(run.labels[0], "'/threads': a thread waits for another one in a way that lockstep does not "
                         r'follow: it waits in read of pipe, in \S+/shim_threads\+0x[0-9a-f]+$')

    def test_a_program_whose_only_thread_waits_for_somebody_outside_keeps_no_time_and_is_labelled(self):
        run = RUNS.run([Program('threads', own('shim_threads'), what='outside'), recorder('/told', '/ticks'), rate()])
        self.assertEqual(run.code, 0, run.outputs)
        self.assertEqual(len(run.labels), 3, run.labels)
        self.assertIn('socket() makes a connection', run.labels[0])
        self.assertIn('had input from outside', run.labels[2])
        self.assertIn('waits for longer than 5 s for somebody outside, and simulated time goes on: it waits in accept',
                      run.labels[1])
        told = [line for line in run.printed(1) if line.endswith('goes on')]
        self.assertGreater(int(told[0].split()[0]), SECOND)

    def test_threads_that_wait_again_and_again_in_such_a_way_go_on(self):
        run = RUNS.run([Program('readers', own('shim_readers')), recorder('/told')])
        self.assertEqual(run.code, 0, run.outputs)
        texts = [line.split(' ', 3)[3] for line in run.printed(1)]
        self.assertEqual(sorted(texts), ['goes on', *['got a'] * 4, *['got b'] * 4, *['got c'] * 4])
        self.assertIn("'/readers': a thread waits for another one in a way that", run.labels[0])

    def test_threads_that_wait_for_work_are_idle_and_those_that_wait_for_each_other_are_stuck(self):
        for what, reason in (
                ('jobs', 'idle at 3 s: no participant wants to wake up; waiting for work: '
                         "'/idle' has 3 waiting threads"),
                ('locks', "deadlock at 2 s: no participant wants to wake up, but '/idle' has 3 waiting threads"),
                ('promise', "deadlock at 1 s: no participant wants to wake up, but '/idle' has 1 waiting thread "
                            '(/idle waits for a future)')):
            program = Program('idle', own('shim_idle'), ends_by=signal.SIGKILL, what=what)
            run = RUNS.run([recorder(), program], end_when_idle=True)
            self.assertIn(reason, run.reason)
            self.assertEqual(run.labels, [])

    def test_programs_that_are_silent_say_where_they_are(self):
        programs = [Program('broods', own('shim_silent'), what='computes'),
                    Program('reads', own('shim_silent'), what='reads'), Program('brooder', BROODER)]
        with Loopback() as RUNS.ros:
            master = RUNS.ros.run('time_master', 'time_master', parameters={
                'mode': 'lockstep', 'participants': [f'/{program.name}' for program in programs],
                'silence_limit': 0.5})
            for program in programs:
                RUNS.start(program)
            told = ''
            deadline = time.monotonic() + GUARD
            while told.count('    it is in ') < 3:
                self.assertLess(time.monotonic(), deadline, told)
                told = RUNS.ask_why()
            log = read(master)
        broods, reads, brooder = (told.partition(f'/{name} owes the report of round')[2].partition('owes')[0]
                                  for name in ('broods', 'reads', 'brooder'))
        line = r'shim_silent\+0x[0-9a-f]+ \(.*shim_silent.cpp:[0-9]+, in .*\)'
        self.assertRegex(broods, "it is in thread 'shim_silent' computes: .*" + line)
        self.assertRegex(reads, r"it is in thread 'shim_silent' waits in read of pipe:\[[0-9]+\]: .*" + line)
        self.assertIn(f'it is in {BROODER}, line 13, in <module> > {BROODER}, line 9, in brood > ', brooder)
        for answer in (broods, reads, brooder):
            self.assertIn('what usually helps', answer)
        self.assertRegex(log, r"'/brooder'( has been silent for .*; it)? is in .*brooder.py, line 9")

