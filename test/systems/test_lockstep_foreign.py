"""Other people's system under its own launch file: the bag is the same in every run.

In test/.nodes/foreign only the launch file knows of lockstep, by its launch-prefix and the package of move_base.
"""
import os
import subprocess
import unittest

import rosbag
from in_lockstep import InLockstep, assert_same
from own_nodes import NODES
from scenarios import repeated
from waiting import GUARD

LAUNCH = os.path.join(NODES, 'foreign', 'system.launch')
PREFIX = 'rosrun move_base_abstract lockstep'
ROBOTS = ['/robot_0', '/robot_1', '/robot_2']
PARTICIPANTS = (['/coordinator', '/metrics', '/recorder'] + [name + '/move_base' for name in ROBOTS]
                + [name + '/task_queue' for name in ROBOTS])
TASKS = 30


def run_once(condition):
    """Return a run of the system to its end; its ``bag`` has the recorded messages."""
    with InLockstep(PARTICIPANTS, condition) as run:
        bag = os.path.join(run.ros.log_dir, 'run.bag')
        command = ['roslaunch', LAUNCH, 'prefix:=' + PREFIX, 'bag:=' + bag, 'tasks:={}'.format(TASKS)]
        with condition.around():
            subprocess.run(command, env=run.ros.environment, timeout=GUARD, check=True, stdout=subprocess.DEVNULL)
    with rosbag.Bag(bag) as recorded:
        run.bag = [(topic, time.to_nsec(), message[1]) for topic, message, time in recorded.read_messages(raw=True)]
    return run


class ForeignSystem(unittest.TestCase):
    """A coordinator, a task queue for each robot, metrics and rosbag record, all unmodified."""

    @classmethod
    def setUpClass(cls):
        cls.runs = repeated('system of others', run_once, lambda run: repr((run.events, run.bag)).encode())
        cls.first = cls.runs[0]

    def test_the_run_is_whole_and_repeatable(self):
        count = {}
        for topic, _, _ in self.first.bag:
            count[topic] = count.get(topic, 0) + 1
        self.assertEqual(count['/done'], TASKS)
        self.assertEqual(sum(count[name + '/tasks'] for name in ROBOTS), TASKS)
        self.assertEqual(count['/finished'], 1)
        self.assertGreater(count['/metrics'], 5)
        self.assertGreater(count['/robot_0/odom'], TASKS / 3)
        self.assertEqual(self.first.end['not_repeatable_because'] + self.first.end['degraded_because'], [])

    def test_metrics_are_recorded_every_five_seconds_exactly(self):
        times = [time_ns for topic, time_ns, _ in self.first.bag if topic == '/metrics']
        self.assertEqual({after - before for before, after in zip(times, times[1:])}, {5000000000})

    def test_the_bag_is_the_same_whatever_else_happens(self):
        for run in self.runs:
            self.assertEqual(run.events, self.first.events)
            assert_same(self, self.first.bag, run.bag)
