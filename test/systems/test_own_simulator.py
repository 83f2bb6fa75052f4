"""A user's own simulator and controllers in lockstep, without nodes of this package: the same bytes in each run."""
import re
import unittest
from pathlib import Path

from own_folder import OwnFolder
from scenarios import Condition, repeated

from move_base_abstract.runs.event_log import EventLog


class OwnSimulatorTest(OwnFolder, unittest.TestCase):
    def run_once(self, *options, condition=Condition()):
        """Run the example; return (output, bytes of the event log)."""
        self.environment.update(ROS_HOME=self.folder, ROS_LOG_DIR=self.folder)
        with condition.around():
            said, *_ = self.launch('run.jsonl', '--log-messages', *condition.options, *options, 'move_base_abstract',
                                   'own_simulator.launch')
        return said, Path(self.path('run.jsonl')).read_bytes()

    def test_it_runs_the_same_at_any_load_and_on_any_cores_and_another_seed_has_other_noise(self):
        runs = repeated('own simulator', lambda condition: self.run_once(condition=condition), lambda run: run[1])
        said, log = runs[0]
        self.assertEqual(sorted(set(re.findall(r"'(/\S+)' takes part", said))), [
            '/robot_0/controller', '/robot_0/simulator', '/robot_1/controller', '/robot_1/simulator'])
        self.assertRegex(said, r'the run ended at 11\.62 s after \d+ rounds')
        for other in (*runs[1:], self.run_once('--cores', 'all'), self.run_once('--cores', 'one')):
            self.assertEqual(other[1], log)
        reader = EventLog(log.decode().splitlines(keepends=True), 'run.jsonl')
        events = list(reader)
        self.assertTrue(reader.end['repeatable'])
        self.assertGreater(len(events), 1000)
        self.assertEqual({event.robot.strip('/').split('/')[0] for event in events} - {''}, {'robot_0', 'robot_1'})
        self.assertNotEqual(self.run_once('--seed', '2')[1], log)
