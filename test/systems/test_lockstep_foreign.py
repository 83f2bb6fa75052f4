"""Other people's system under its own launch file: the bag is the same in every run.

In test/.nodes/foreign only the launch file knows of lockstep, by its launch-prefix and the package of move_base.
"""
import os
import shutil
import subprocess
import tempfile
import unittest

import rosbag
from own_nodes import NODES
from scenarios import Condition, repeated
from warm import Loopback

from move_base_abstract.runs.event_log import EventLog

LAUNCH = os.path.join(NODES, 'foreign', 'system.launch')
PREFIX = 'rosrun move_base_abstract lockstep'
ROBOTS = ['/robot_0', '/robot_1', '/robot_2']
PARTICIPANTS = (['/coordinator', '/metrics', '/recorder'] + [name + '/move_base' for name in ROBOTS]
                + [name + '/task_queue' for name in ROBOTS])
GUARD = 120.0  # s, wall; only ends a run that would never end
TASKS = 30


class Run:
    """A run of the system to its end: ``bag`` has the recorded messages, ``log`` is the EventLog."""

    def __init__(self, condition=Condition()):
        folder = tempfile.mkdtemp(prefix='lockstep_foreign_')
        try:
            self._run(folder, condition)
        finally:
            shutil.rmtree(folder)

    def _run(self, folder, condition):
        log, bag = os.path.join(folder, 'events.jsonl'), os.path.join(folder, 'run.bag')
        with Loopback(is_warm=condition.is_warm) as ros:
            ros.run('time_master', 'time_master', parameters={
                'mode': 'lockstep', 'participants': PARTICIPANTS, 'event_log': log, **condition.clock})
            command = ['roslaunch', LAUNCH, 'prefix:=' + PREFIX, 'bag:=' + bag, 'tasks:={}'.format(TASKS)]
            with condition.around():
                subprocess.run(command, env=ros.environment, timeout=GUARD, check=True, stdout=subprocess.DEVNULL)
        with open(log) as stream:
            self.log = EventLog(stream.readlines(), 'the run')
        self.events = [event.compared for event in self.log]
        with rosbag.Bag(bag) as recorded:
            self.bag = [(topic, time.to_nsec(), message[1])
                        for topic, message, time in recorded.read_messages(raw=True)]


class ForeignSystem(unittest.TestCase):
    """A coordinator, a task queue for each robot, metrics and rosbag record, all unmodified."""

    @classmethod
    def setUpClass(cls):
        cls.runs = repeated('system of others', Run, lambda run: repr((run.events, run.bag)).encode())
        cls.first = cls.runs[0]

    def assert_same(self, run):
        """Assert that the run has the same events, and its bag the same messages at the same times."""
        self.assertEqual(run.events, self.first.events)
        self.assertEqual(len(run.bag), len(self.first.bag))
        for entry, its in zip(self.first.bag, run.bag):
            self.assertEqual(entry, its)

    def test_the_run_is_whole_and_repeatable(self):
        count = {}
        for topic, _, _ in self.first.bag:
            count[topic] = count.get(topic, 0) + 1
        self.assertEqual(count['/done'], TASKS)
        self.assertEqual(sum(count[name + '/tasks'] for name in ROBOTS), TASKS)
        self.assertEqual(count['/finished'], 1)
        self.assertGreater(count['/metrics'], 5)
        self.assertGreater(count['/robot_0/odom'], TASKS / 3)
        self.assertEqual(self.first.log.end['not_repeatable_because'], [])
        self.assertEqual(self.first.log.end['degraded_because'], [])

    def test_metrics_are_recorded_every_five_seconds_exactly(self):
        times = [time_ns for topic, time_ns, _ in self.first.bag if topic == '/metrics']
        self.assertEqual({after - before for before, after in zip(times, times[1:])}, {5000000000})

    def test_the_bag_is_the_same_whatever_else_happens(self):
        for run in self.runs:
            self.assert_same(run)
