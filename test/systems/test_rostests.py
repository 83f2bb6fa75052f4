"""rostest works with the programs of this package, as users write their tests: a clock, one robot, a run as a test."""
import os
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

from night import times
from own_folder import GUARD, OwnFolder

FOLDER = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'rostest')


class Rostests(OwnFolder, unittest.TestCase):
    """Each rostest has a ROS master of its own, by rostest."""

    def check(self, name, tests, *words):
        """Run a rostest; check that it had so many tests, and that all have passed."""
        env = {**os.environ, 'ROS_TEST_RESULTS_DIR': self.folder, 'ROS_HOME': self.folder}
        done = subprocess.run(['rostest', os.path.join(FOLDER, name + '.test.xml'), *words], env=env, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              check=False, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        results = [ElementTree.parse(os.path.join(at, file)).getroot() for at, _, files in os.walk(self.folder)
                   for file in files if file == f'rosunit-{name}.xml']
        self.assertEqual([[one.get(key) for key in ('tests', 'failures', 'errors')] for one in results],
                         [[str(tests), '0', '0']], done.stdout)

    def test_a_stock_client_of_a_robot_with_a_scaled_clock(self):
        self.check('contract_stock_client', 1, f'goals:={times(200, 1000)}')

    def test_a_robot_by_the_clock_of_the_machine(self):
        self.check('contract_machine_clock', 1)

    def test_a_run_of_a_launch_file_is_a_test(self):
        self.check('run_checked', 8)  # the run's end, and seven properties
