"""A user's own simulator and controllers in lockstep, without nodes of this package: the same bytes in each run."""
import os
import re
import tempfile
import unittest

import warm
from scenarios import Condition, repeated

from move_base_abstract.runs.event_log import EventLog
from move_base_abstract_ros.loopback import find_executable

GUARD = 120.0  # s, wall; only ends a run that would never end


class OwnSimulatorTest(unittest.TestCase):
    def run_it(self, *options, condition=Condition()):
        """Run the example; return (output, bytes of the event log)."""
        folder = tempfile.mkdtemp()
        path = os.path.join(folder, 'run.jsonl')
        words = [find_executable('lockstep_launch'), '--event-log', path, '--log-messages', *condition.options,
                 *options, 'move_base_abstract', 'own_simulator.launch']
        with condition.around():
            done = warm.run(words, dict(os.environ, ROS_HOME=folder, ROS_LOG_DIR=folder), timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        with open(path, 'rb') as stream:
            return done.stdout, stream.read()

    def test_it_runs_the_same_at_any_load_and_on_any_cores_and_another_seed_has_other_noise(self):
        runs = repeated('own simulator', lambda condition: self.run_it(condition=condition), lambda run: run[1])
        said, log = runs[0]
        self.assertEqual(sorted(set(re.findall(r"'(/\S+)' takes part", said))), [
            '/robot_0/controller', '/robot_0/simulator', '/robot_1/controller', '/robot_1/simulator'])
        self.assertRegex(said, r'the run ended at 11\.62 s after \d+ rounds')
        for other in (*runs[1:], self.run_it('--cores', 'all'), self.run_it('--cores', 'one')):
            self.assertEqual(other[1], log)
        reader = EventLog(log.decode().splitlines(keepends=True), 'run.jsonl')
        events = list(reader)
        self.assertTrue(reader.end['repeatable'])
        self.assertGreater(len(events), 1000)
        self.assertEqual({event.robot.strip('/').split('/')[0] for event in events} - {''}, {'robot_0', 'robot_1'})
        self.assertNotEqual(self.run_it('--seed', '2')[1], log)
