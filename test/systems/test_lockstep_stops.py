"""A run that is stopped at many rounds has the same event log, to the byte, however long it stands."""
import json
import os
import random
import sys
import unittest

from in_lockstep import InLockstep, assert_same
from scenarios import Condition, repeated

from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
STOPS = 30
#: node: its program and parameters; some end by themselves
PROGRAMS = {
    'threads': (os.path.join(HERE, 'unmodified', 'thread_per_robot.py'), {'robots': ['/robot_0', '/robot_1']}),
    'timers': (find_executable('shim_timer'), {}),
    'rate': (find_executable('shim_rate'), {'frequency': 7.0, 'ticks': 20}),
    'client': (find_executable('shim_calls'), {'client': True}),
    'server': (find_executable('shim_calls'), {'work': 0.25}),
    'recorder': (find_executable('shim_recorder'), {'topics': ['/fired', '/ticks', '/answers']}),
    'worker': (os.path.join(HERE, 'unmodified', 'asker.py'), {}),
    'depot': (os.path.join(HERE, 'unmodified', 'answerer.py'), {}),
}


def run_once(condition=Condition(), rows=(), **clock):
    """Return a run; with rows it is stopped at each of them and in between, and ``stops`` says what was seen there."""
    names = ['/fleet', *('/' + name for name in PROGRAMS)]
    with InLockstep(names, condition, log_messages=True, end_at=25.0, **clock) as run:
        with condition.around():
            run.ros.run('fleet', 'fleet', parameters={
                'defaults': {'max_speed': 1.0},
                'robots': [{'name': 'robot_{}'.format(number), 'start_y': 10.0 * number} for number in range(2)]})
            for name, (program, parameters) in PROGRAMS.items():
                for key, value in parameters.items():
                    run.ros.set_param('/{}/{}'.format(name, key), value)
                run.ros.spawn('/' + name, [find_executable('lockstep'), program, '__name:=' + name])
            if rows:
                said, = run.end_of(run.ros.spawn('/stopper', [
                    sys.executable, os.path.join(HERE, 'stopper.py'), run.log, ','.join(map(str, rows)), '5']))
                run.stops = [json.loads(line) for line in said.splitlines()]
    return run


def stopped(plain, condition=Condition(), **clock):
    """Return the same run, stopped."""
    rows = random.Random(3).sample(range(1, len(plain.events) * 9 // 10), STOPS)
    return run_once(condition, rows, start_stopped=True, keep_messages=1, **clock)


class Stops(unittest.TestCase):
    """Each run is compared with one that did not stop."""

    def check(self, plain, run):
        """The log is the same, and at each stop all its rows so far were known."""
        assert_same(self, plain.text.splitlines(), run.text.splitlines(), 'line of the event log')
        self.assertGreaterEqual(len(run.stops), STOPS)
        for stop in run.stops:
            self.assertEqual((stop['phase'], stop['written']), ('stopped', stop['rows']), stop)
            told = [row for row in plain.events[:stop['rows']] if row[1] == '/fired']
            self.assertEqual(stop['recent'], [[row[0], row[2], row[3][0], row[3][2]] for row in told[-1:]], stop)
        self.assertGreater(len({stop['row'] for stop in run.stops if stop['row']}), STOPS // 2)

    def test_a_run_of_many_kinds_of_nodes_is_the_same(self):
        plain = run_once()
        self.assertEqual(plain.end['not_repeatable_because'], [])
        self.assertEqual({row['node'] for row in plain.end['departures']} & {'/rate', '/worker'}, {'/rate', '/worker'})
        kinds = [row[2] for row in plain.events]
        self.assertGreater(min(kinds.count(kind) for kind in ('message', 'call', 'response')), 20)
        for run in repeated('stopped', lambda condition: stopped(plain, condition), lambda run: run.text.encode()):
            self.check(plain, run)
            self.assertTrue(any(stop['microstep'] for stop in run.stops), 'no stop was in the middle of an instant')

    def test_a_run_in_windows_is_the_same(self):
        plain = run_once(lookahead=0.05)
        run = stopped(plain, lookahead=0.05)
        self.check(plain, run)
        self.assertIn('nodes may be up to 0.05 s further', run.stops[0]['reason'])

    def test_a_run_with_chaos_delays_and_late_starts_is_the_same(self):
        clock = {'chaos_seed': 3, 'chaos_delay': 0.05, 'chaos_starts': 3.0}
        plain = run_once(**clock)
        self.check(plain, stopped(plain, **clock))


if __name__ == '__main__':
    unittest.main()
