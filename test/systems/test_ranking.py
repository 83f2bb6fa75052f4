"""Missions of the five coordinators take as long by the ROS node in lockstep as in plain Python."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import rospkg

from move_base_abstract_ros.loopback import find_executable

SHARE = rospkg.RosPack().get_path('move_base_abstract')
FOLDER = os.path.join(SHARE, 'examples', 'ranking')
sys.path.insert(0, FOLDER)
import missions  # noqa: E402
import warm  # noqa: E402
from dispatching import POLICIES  # noqa: E402
from waiting import GUARD  # noqa: E402

PLAIN_PYTHON = os.path.join(SHARE, '.ws', 'plain', 'bin', 'python')  # which has SimPy
PLAIN = """
import json, sys
sys.path.insert(0, sys.argv[1])
import missions, plain
from dispatching import POLICIES
occupancy, places = plain.map_of('farm_yard')
print(json.dumps({policy: plain.run_mission('encounters', policy, 3, missions.make_mission(places, 7), occupancy, seed)
                  for seed, policy in enumerate(POLICIES)}))
"""


class RankingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.mission = os.path.join(cls.folder, 'mission')
        missions.main(os.path.join(SHARE, 'maps', 'farm_yard.yaml'), 7, 3, cls.mission)

    def in_lockstep(self, policy, seed):
        """Run a mission in lockstep; return the row that the coordinator has written."""
        path = os.path.join(self.folder, policy + '.jsonl')
        words = [find_executable('lockstep_launch'), 'move_base_abstract', 'ranking.launch', 'mission:=' + self.mission,
                 'policy:=' + policy, 'output:=' + path, 'seed:={}'.format(seed), 'encounters:=calibrated']
        done = warm.run(words, dict(os.environ, ROS_HOME=self.folder, ROS_LOG_DIR=self.folder), timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        with open(path) as stream:
            return json.loads(stream.readline())

    def test_the_node_and_plain_python_say_the_same(self):
        done = subprocess.run([PLAIN_PYTHON, '-c', PLAIN, FOLDER], stdout=subprocess.PIPE, timeout=GUARD, check=True)
        plain, spans = json.loads(done.stdout), {}
        for seed, policy in enumerate(POLICIES):
            row = self.in_lockstep(policy, seed)
            here = plain[policy]
            self.assertAlmostEqual(row['mission_s'], here['mission_s'], delta=0.0011, msg=policy)
            self.assertEqual((row['done'], row['failed'], row['ended']), (12, 0, True), policy)
            spans[policy] = here['mission_s']
        self.assertGreater(spans['farthest_first'], 1.2 * spans['batch'])
