"""The same results at any speed: event logs are equal to the byte, whatever else the machine does.

Each run has a fleet (or three) and a coordinator on a ROS master of its own, with ties, cancels, pre-emptions and more
than a thousand goals.
"""
import json
import os
import shutil
import sys
import tempfile
import unittest

from scenarios import ALL_CORES, Condition, repeated
from warm import Loopback

from move_base_abstract.runs.event_log import EventLog
from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
NODES = os.path.join(HERE, 'lockstep_nodes')
GUARD = 120.0  # s, wall; only ends a run that would never end
ROBOTS, GOALS, SEED = 8, 1000, 7
COORDINATOR = [sys.executable, os.path.join(NODES, 'coordinator.py')]


class Run:
    """A run to its end; ``data`` is its log [bytes]. ``condition``: what else happens meanwhile."""

    def __init__(self, folder, coordinator, processes=1, parameters=None, robots=ROBOTS, scenario=None,
                 condition=Condition()):
        log = os.path.join(folder, 'events.jsonl')
        fleets = ['fleet_{}'.format(part) for part in range(processes)]
        with Loopback(is_warm=condition.is_warm) as ros:
            ros.run('time_master', 'time_master', parameters=dict(
                {'mode': 'lockstep', 'participants': ['/' + name for name in fleets] + ['/coordinator'],
                 'event_log': log}, **condition.clock))
            for part, name in enumerate(fleets):
                ros.run('fleet', name, parameters=dict(scenario or _scenario(robots), part=part, parts=processes))
            ros.set_param('/coordinator', dict({'robots': robots, 'goals': GOALS, 'seed': SEED, 'patient': True},
                                               **(parameters or {})))
            child = ros.spawn('/coordinator', coordinator + ['__name:=coordinator'])
            with condition.around():
                code, words = child.process.wait(GUARD), child.last_lines()
            ros.end(child)
            ros.check()
        if code != 0:
            raise AssertionError('the coordinator ended with code {}:\n{}'.format(code, words))
        with open(log, 'rb') as stream:
            self.data = stream.read()


def _scenario(count):
    return {'defaults': {'max_speed': 10.0},
            'robots': [{'name': 'robot_{}'.format(i), 'start_x': 5.0 * (i % 4)} for i in range(count)]}


class Sameness(unittest.TestCase):
    """Compares each variation with one plain run."""

    @classmethod
    def setUpClass(cls):
        cls.runs = repeated('a thousand goals', lambda condition: cls.run_once(COORDINATOR, condition=condition),
                            lambda run: run.data)
        cls.plain = cls.runs[0]

    @staticmethod
    def run_once(*args, **kwds):
        """Run in a folder of its own, and remove the folder."""
        folder = tempfile.mkdtemp(prefix='lockstep_sameness_')
        try:
            return Run(folder, *args, **kwds)
        finally:
            shutil.rmtree(folder)

    def assert_same(self, run):
        """Assert that the run's log is that of the plain run, to the byte."""
        plain, other = self.plain.data.split(b'\n'), run.data.split(b'\n')
        for number, (line, its) in enumerate(zip(plain, other), 1):
            self.assertEqual(line, its, 'line {}'.format(number))
        self.assertEqual(len(plain), len(other))

    def test_the_plain_run_is_worth_comparing(self):
        log = EventLog(self.plain.data.decode().splitlines(True), 'the plain run')
        events = list(log)
        kinds = [event.kind for event in events]
        states = [json.loads(event.values)[1] for event in events if event.kind == 'ended']
        self.assertEqual((log.end['repeatable'], log.end['degraded_because']), (True, []))
        self.assertGreaterEqual(len(states), GOALS)
        self.assertGreater(states.count('PREEMPTED'), 50)
        self.assertGreater(states.count('SUCCEEDED'), 500)
        self.assertGreater(kinds.count('departed'), 900)
        times = [event.time_ns for event in events if event.kind == 'departed']
        self.assertGreater(len(times) - len(set(times)), 200, 'there are hardly any ties')

    def test_whatever_else_happens_on_the_machine(self):
        for run in self.runs:
            self.assert_same(run)

    def test_beside_busy_loops_with_delays_in_three_processes_and_started_anew(self):
        condition = Condition(load=ALL_CORES, is_warm=False)
        self.assert_same(self.run_once(COORDINATOR, processes=3, parameters={'delay': 0.002}, condition=condition))

    def test_with_the_coordinator_in_cpp(self):
        self.assert_same(self.run_once([find_executable('lockstep'), find_executable('shim_coordinator')]))

    def test_another_seed_makes_another_run(self):
        self.assertNotEqual(self.run_once(COORDINATOR, parameters={'seed': SEED + 1}).data, self.plain.data)

    def test_runs_of_robots_that_arrive_together_are_one(self):
        # Two robots arrive together, and a coordinator draws from one generator in the order of arrivals.
        # Without an order of equal events the draws would be swapped now and then.
        scenario = {'defaults': {'max_speed': 10.0}, 'robots': [{'name': 'robot_0'}, {'name': 'robot_1'}]}

        def run(condition, delay=0.0005):
            return self.run_once([sys.executable, os.path.join(NODES, 'pairs.py')], scenario=scenario,
                                 parameters={'goals': 1000, 'delay': delay}, condition=condition)
        runs = [run(Condition(), 0.0), *repeated('pairs', run, lambda one: one.data)]
        self.assertGreaterEqual(runs[0].data.count(b'"ended"'), 1000)
        self.assertEqual(len({one.data for one in runs}), 1)
