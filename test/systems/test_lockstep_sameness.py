"""The same results at any speed: event logs are equal to the byte, whatever else the machine does.

Each run has a fleet (or three) and a coordinator on a ROS master of its own, with ties, cancels, pre-emptions and more
than a thousand goals.
"""
import json
import os
import sys
import unittest

from in_lockstep import InLockstep, assert_same
from scenarios import ALL_CORES, Condition, repeated

from move_base_abstract.runs.event_log import EventLog
from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
NODES = os.path.join(HERE, 'lockstep_nodes')
ROBOTS, GOALS, SEED = 8, 1000, 7
SCENARIO = {'defaults': {'max_speed': 10.0},
            'robots': [{'name': 'robot_{}'.format(i), 'start_x': 5.0 * (i % 4)} for i in range(ROBOTS)]}
COORDINATOR = [sys.executable, os.path.join(NODES, 'coordinator.py')]


class Sameness(unittest.TestCase):
    """Compares each variation with one plain run."""

    @classmethod
    def setUpClass(cls):
        cls.runs = repeated('a thousand goals', lambda condition: cls.run_once(COORDINATOR, condition=condition), bytes)
        cls.plain = cls.runs[0]

    @staticmethod
    def run_once(coordinator, processes=1, parameters=None, scenario=None, condition=Condition()):
        """Return the event log of a run to its end [bytes]; ``condition``: what else happens meanwhile."""
        fleets = ['fleet_{}'.format(part) for part in range(processes)]
        with InLockstep(['/' + name for name in (*fleets, 'coordinator')], condition) as run:
            for part, name in enumerate(fleets):
                run.ros.run('fleet', name, parameters=dict(scenario or SCENARIO, part=part, parts=processes))
            run.ros.set_param('/coordinator', dict({'robots': ROBOTS, 'goals': GOALS, 'seed': SEED, 'patient': True},
                                                   **(parameters or {})))
            child = run.ros.spawn('/coordinator', coordinator + ['__name:=coordinator'])
            with condition.around():
                run.end_of(child)
        return run.text.encode()

    def assert_same(self, log):
        """Assert that a run's log is that of the plain run, to the byte."""
        assert_same(self, self.plain.split(b'\n'), log.split(b'\n'), 'line')

    def test_the_plain_run_is_worth_comparing(self):
        log = EventLog(self.plain.decode().splitlines(True), 'the plain run')
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
        self.assertNotEqual(self.run_once(COORDINATOR, parameters={'seed': SEED + 1}), self.plain)

    def test_runs_of_robots_that_arrive_together_are_one(self):
        # Two robots arrive together, and a coordinator draws from one generator in the order of arrivals.
        # Without an order of equal events the draws would be swapped now and then.
        scenario = {'defaults': {'max_speed': 10.0}, 'robots': [{'name': 'robot_0'}, {'name': 'robot_1'}]}

        def run(condition, delay=0.0005):
            return self.run_once([sys.executable, os.path.join(NODES, 'pairs.py')], scenario=scenario,
                                 parameters={'goals': 1000, 'delay': delay}, condition=condition)
        runs = [run(Condition(), 0.0), *repeated('pairs', run, bytes)]
        self.assertGreaterEqual(runs[0].count(b'"ended"'), 1000)
        self.assertEqual(len(set(runs)), 1)
