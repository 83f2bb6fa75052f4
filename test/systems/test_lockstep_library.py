"""Python nodes in lockstep: time, topics and services are exact, and the same in every run."""

import os
import sys
import unittest

from in_lockstep import assert_same
from lockstep_library_run import FOLDER, Runs, read, wait_for_end
from scenarios import Condition, repeated

RUNS = Runs()
STOCK_SERVER = os.path.join(FOLDER, 'library_services.py')


class TimesTest(unittest.TestCase):
    """Sleeps, rates and timers are exact."""

    def test_sleep_ends_at_its_instant(self):
        run = RUNS.run('times', 'sleeper')
        times = [1500000000, 1500000001, 1500000002, 1500000002, 1500000002, 3500000002]
        self.assertEqual(run.of('sleeper'), [(1.0, 'begin')] + [
            (time_ns / 1e9, 'slept', time_ns, time_ns, round(time_ns / 1e9, 9)) for time_ns in times])
        self.assertEqual(run.exit_codes, {'sleeper': 0})
        self.assertTrue(run.end['repeatable'], run.end)

    def test_rates_keep_to_their_grid(self):
        third = 333333333
        run = RUNS.run('times', 'rates')
        self.assertEqual(run.of('rates'), [
            ((10 ** 9 + index * third) / 1e9, 'third', 10 ** 9 + index * third) for index in range(1, 5)] + [
            (4.833333332, 'late'), (4.833333332, 'late too'), (5.333333332, 'on time')])

    def test_timers_fire_at_their_instants_once(self):
        run = RUNS.run('times', 'timers')
        self.assertEqual(run.of('timers'), [
            (2.0, 'tick', 2.0, 2.0, None), (3.0, 'once'), (3.0, 'tick', 3.0, 3.0, 2.0), (4.0, 'tick', 4.0, 4.0, 3.0),
            (5.25, 'slow begins'), (6.75, 'slow ends'), (9.25, 'end')])

    def test_order_at_one_instant(self):
        run = RUNS.run('times', 'order')
        self.assertEqual(run.of('order'), [
            (float(second), kind, *values) for second in (2, 3, 4)
            for kind, *values in (('main',), ('timer',), ('message', str(second - 2)), ('thread',))])

    def test_the_exit_code_is_the_node_s(self):
        run = RUNS.run('times', 'now_before_joining')
        self.assertEqual(run.of('now_before_joining'), [(1.0, 'now', 10 ** 9, True)])
        self.assertEqual(run.exit_codes, {'now_before_joining': 3})


class TopicsTest(unittest.TestCase):
    """Messages among participants: none is lost, and each run is the same."""

    def test_talker_and_listeners(self):
        run = RUNS.run('topics', 'any_listener', 'listener', 'talker')
        self.assertEqual(run.of('talker'), [(1.0, 'connections', 0, 0), (2.0, 'connections', 2, 1),
                                            (4.0, 'connections', 2, 1)])
        self.assertEqual(run.of('listener'), [
            (1.0, 'connections', 0), (1.0, 'hears', 'latched', '/talker', '1'), (1.5, 'connections', 1),
            *[(2.0, 'hears', str(index), '/talker', '0') for index in range(5)],
            (3.5, 'late', 'latched'), (4.5, 'connections', 0), (6.0, 'hears', 'again', '/talker', '0'),
            (6.5, 'connections', 1)])
        self.assertEqual(run.of('any_listener'), [(2.0, 'any', 'std_msgs/String', str(index)) for index in range(5)] + [
            (6.0, 'any', 'std_msgs/String', 'again')])
        self.assertTrue(run.end['repeatable'], run.end)

    def test_listeners_to_subscribers_whom_an_onlooker_does_not_change(self):
        runs = [RUNS.run('topics', 'guest', 'welcomer', onlook=onlook, speed_limit=2.0) for onlook in ('', 'chatter')]
        for run in runs:
            self.assertEqual(run.end['not_repeatable_because'], [])
            self.assertEqual(run.all, runs[0].all)
        told = [event for event in runs[0].of('welcomer') if event[1] != 'listeners']
        self.assertEqual(told, [(2.5, 'peer comes', '/chatter'), (4.5, 'peer goes', '/chatter', 0),
                                (5.5, 'peer comes', '/chatter'), (7.5, 'peer goes', '/chatter', 0)])
        self.assertEqual([event[2] for event in runs[0].of('welcomer') if event[1] == 'listeners'],
                         [0, 0, 1, 1, 0, 1, 1, 0])
        self.assertEqual(runs[0].of('guest'), [(time_s, 'hears', text) for time_s, *texts in (
            (2.5, 'to all', 'to you'), (3.0, '2'), (4.0, '3'), (5.5, 'to all', 'to you'), (6.0, '5'), (7.0, '6'))
            for text in texts])

    def test_a_slow_callback_keeps_the_newest_and_does_not_hold_up_other_topics(self):
        run = RUNS.run('topics', 'counter', 'slow_listener')
        said = run.of('slow_listener')
        self.assertEqual([(time_s, index) for time_s, kind, index in said if kind == 'begins'],
                         [(1.8, 0), (2.8, 2), (3.8, 5), (4.8, 8), (5.8, 9)])
        self.assertEqual([(time_s, index) for time_s, kind, index in said if kind == 'other'],
                         [(round(1.8 + 0.3 * index, 9), index) for index in range(10)])

    def test_a_node_hears_itself_and_errors_in_callbacks_are_only_shown(self):
        run = RUNS.run('topics', 'itself')
        self.assertEqual(run.of('itself'), [(float(time_s), 'hears', number) for time_s, numbers in (
            (2, (1, 2, 3)), (3, (4, 5, 6))) for number in numbers])
        self.assertIn('shown, and nothing more', run.outputs['itself'])

    def test_equal_instants_go_by_rank_and_then_by_names_as_people_count(self):
        run = RUNS.run('topics', 'speaker_10', 'hearer', 'speaker_9', 'speaker_2',
                       parameters={'/speaker_9/lockstep_rank': -1})
        self.assertEqual(run.of('hearer'), [(float(time_s), 'hears', name) for time_s in range(2, 7) for name in (
            'speaker_9 with rank', 'speaker_2', 'speaker_10')])

    def test_what_comes_from_outside_is_heard_and_the_run_is_labelled(self):
        run = RUNS.run('topics', 'hears_outside', outsiders=['outside_talker'])
        self.assertEqual(run.of('hears_outside'), [(1.0, 'hears', 'from outside')])
        self.assertFalse(run.end['repeatable'])
        self.assertIn('/outside_talker', ' '.join(run.end['not_repeatable_because']))


class ChargesTest(unittest.TestCase):
    """The simulated time that computations are charged."""

    def run_with(self, charge):
        run = RUNS.run('topics', 'hearer', 'speaker_2', parameters={'/speaker_2/lockstep_charge': charge})
        return run, [time_s for time_s, *_ in run.of('hearer')]

    def tearDown(self):
        RUNS.ros.set_param('/speaker_2/lockstep_charge', 'none')

    def test_a_fixed_charge_delays_what_is_sent(self):
        run, times = self.run_with('fixed:0.25')
        self.assertEqual(times, [2.25, 3.25, 4.25, 5.25, 6.25])
        self.assertTrue(run.end['repeatable'], run.end)

    def test_a_measured_charge_can_be_replayed(self):
        path = os.path.join(RUNS.ros.log_dir, 'costs')
        measured, first = self.run_with('measured:' + path)
        self.assertFalse(measured.end['repeatable'])
        self.assertIn('/speaker_2', ' '.join(measured.end['not_repeatable_because']))
        self.assertEqual(len(first), 5)
        for index, time_s in enumerate(first):
            self.assertGreater(time_s, 2.0 + index)
        replayed, second = self.run_with('replay:' + path)
        self.assertEqual(second, first)
        self.assertTrue(replayed.end['repeatable'], replayed.end)

    def test_a_replay_of_another_run_ends_the_node(self):
        path = os.path.join(RUNS.ros.log_dir, 'other_costs')
        with open(path, 'w', encoding='utf-8') as record:
            record.write('{"time_ns": 2000000000, "cost_ns": 500000000}\n{"time_ns": 3100000000, "cost_ns": 0}\n')
        run, times = self.run_with('replay:' + path)
        self.assertEqual(times, [2.5])
        self.assertIn('not in the record (line 2 is of 3100000000 ns)', run.outputs['speaker_2'])

    def test_a_charge_that_is_none_ends_the_node(self):
        RUNS.ros.set_param('/sleeper/lockstep_charge', 'a lot')
        node = RUNS.start_master(['sleeper'])[0]
        try:
            sleeper = RUNS.start_node('times', 'sleeper', 0.0)
            self.assertNotEqual(wait_for_end(sleeper), 0)
            self.assertIn("got 'a lot'", read(sleeper))
            RUNS.ros.end(sleeper)
        finally:
            RUNS.ros.set_param('/sleeper/lockstep_charge', 'none')
            RUNS.ros.end(node)


class ServicesTest(unittest.TestCase):
    """Calls among participants."""

    def test_handlers_may_sleep_and_calls_of_several_do_not_wait_for_each_other(self):
        run = RUNS.run('services', 'caller', 'other_caller', 'server')
        self.assertEqual(run.of('caller')[:5], [(1.0, 'found')] + [
            (time_s, 'answer', 'slept') for time_s in (3.0, 3.5, 4.0, 4.5)])
        self.assertEqual(run.of('other_caller'), [(1.5, 'answer', 'slept')])
        self.assertTrue(run.end['repeatable'], run.end)

    def test_texts_of_errors_are_those_of_rospy(self):
        stock = RUNS.ros.spawn('/server', [sys.executable, STOCK_SERVER, 'server'])
        caller = RUNS.ros.spawn('/outside_errors', [sys.executable, STOCK_SERVER, 'outside_errors'])
        RUNS.ros.set_param('/use_sim_time', False)
        wait_for_end(caller)
        expected = [tuple(line.split('|')[1:]) for line in read(caller).splitlines() if line.startswith('STOCK')]
        RUNS.ros.end(caller)
        RUNS.ros.end(stock)
        RUNS.ros.set_param('/use_sim_time', True)
        run = RUNS.run('services', 'caller', 'other_caller', 'server')
        self.assertEqual(len(expected), 6)
        self.assertEqual([event[1:] for event in run.of('caller')[5:]], expected)

    def test_wait_for_service_ends_at_its_instant(self):
        run = RUNS.run('services', 'late_server', 'waiter')
        self.assertEqual(run.of('waiter'), [
            (2.5, 'error', 'timeout exceeded while waiting for service /late'), (4.0, 'answer', 'here'),
            (11.0, 'gone')])

    def test_calls_within_calls(self):
        run = RUNS.run('services', 'node_a', 'node_b')
        self.assertEqual(run.of('node_a'), [(1.5, 'tick'), (1.75, 'answer', 'b of a'), (2.0, 'tick'), (2.5, 'tick')])

    def test_a_server_that_leaves_is_an_error(self):
        run = RUNS.run('services', 'leaver', 'left_behind')
        self.assertEqual([event[:2] for event in run.of('left_behind')], [(2.0, 'error'), (3.0, 'goes on')])
        self.assertIn('/leaves', run.of('left_behind')[0][2])

    def test_calls_in_the_callback_of_a_timer(self):
        run = RUNS.run('services', 'server', 'timer_caller')
        self.assertEqual(run.of('timer_caller'), [(2.5, 'timer', 'slept'), (4.0, 'main', 'slept')])

    def test_a_call_from_outside_is_answered_and_the_run_is_labelled(self):
        run = RUNS.run('services', 'asked_from_outside', outsiders=['outside_caller'])
        self.assertEqual([event[1] for event in run.of('asked_from_outside')], ['asked', 'over'])
        self.assertFalse(run.end['repeatable'])
        self.assertIn('/ask', ' '.join(run.end['not_repeatable_because']))


class SamenessTest(unittest.TestCase):
    """Some of everything, with random delays, gives the same log."""

    def test_each_run_gives_the_log_of_the_first_whatever_else_happens(self):
        def run(condition, adverse=0.005):
            return RUNS.run('mixed', 'mixed_1', 'mixed_2', 'mixed_3', adverse=adverse, log_messages=True,
                            condition=condition)
        runs = [run(Condition(), 0.0), *repeated('some of everything', run, lambda one: one.text.encode())]
        self.assertGreater(len(runs[0].all), 300)
        self.assertTrue(runs[0].end['repeatable'], runs[0].end)
        for number, run in enumerate(runs):
            assert_same(self, runs[0].text.splitlines(), run.text.splitlines(), f'run {number}, line')
