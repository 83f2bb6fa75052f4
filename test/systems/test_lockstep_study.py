"""Other people's study by its unchanged launch file: the same log, called repeatable, whatever disturbs the run.

No node in test/.nodes/study knows of lockstep or has a prefix. The study has chance (in C++ by the time of day), sets
of objects, loops without sleep, a service call before init_node, much logging, feedback that changes goals, a node that
counts all topics, and rosbag.
"""
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from in_lockstep import assert_same
from own_folder import GUARD, events_of
from own_nodes import NODES
from scenarios import Condition, repeated

from move_base_abstract_ros.loopback import find_executable

STUDY = os.path.join(NODES, 'study')


class Run:
    """A run, with ``events`` and ``end`` of its log; ``disturb(process)`` is called once during the run."""

    def __init__(self, folder, *options, disturb=None, condition=Condition()):
        self.folder = tempfile.mkdtemp(dir=folder)
        with condition.around():
            self._run(folder, options, disturb)

    def _run(self, folder, options, disturb):
        log = os.path.join(self.folder, 'events.jsonl')
        environment = dict(os.environ, ROS_HOME=self.folder, ROSCONSOLE_STDOUT_LINE_BUFFERED='1',
                           ROS_PACKAGE_PATH=os.pathsep.join([folder, os.environ['ROS_PACKAGE_PATH']]))
        process = subprocess.Popen(
            [find_executable('lockstep_launch'), '--event-log', log, '--log-messages', *options,
             '--notes', self.folder, os.path.join(folder, 'study.launch'),
             'bag:=' + os.path.join(self.folder, 'all.bag')],
            env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        while disturb is not None and process.poll() is None:
            if os.path.exists(os.path.join(self.folder, 'start')):
                disturb(process)
                break
            time.sleep(0.01)
        self.said = process.communicate(timeout=GUARD)[0]
        self.code = process.returncode
        read, self.events = events_of(log)
        self.end, self.bags = read.end, read.bags


class StudyTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='lockstep_study_')
        for name in os.listdir(STUDY):
            shutil.copy(os.path.join(STUDY, name), cls.folder)
            os.chmod(os.path.join(cls.folder, name), 0o755)
        cls.runs = repeated('study of others',
                            lambda condition: Run(cls.folder, *condition.options, condition=condition),
                            lambda run: repr((run.events, [bag['sha256'] for bag in run.bags['/recorder']])).encode())
        cls.first = cls.runs[0]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def assert_same(self, run):
        assert_same(self, self.first.events, run.events)
        digests = [[bag['sha256'] for bag in one.bags['/recorder']] for one in (self.first, run)]
        self.assertEqual(len(digests[0]), 1)
        self.assertEqual(*digests)  # all topics (-a) that the recorder finds
        self.assert_repeatable(run)

    def assert_repeatable(self, run):
        self.assertEqual(run.code, 0, run.said)
        self.assertEqual(run.end['not_repeatable_because'] + run.end['degraded_because'], [], run.said)

    def test_the_study_comes_to_its_end_and_is_called_repeatable(self):
        self.assert_repeatable(self.first)
        self.assertIn('/coordinator', self.first.end['reason'])
        self.assertIn('6 tasks in', self.first.said)
        self.assertNotIn('Traceback', self.first.said)

    def test_the_log_is_the_same_whatever_else_happens(self):
        for run in self.runs:
            self.assert_same(run)

    def test_the_log_is_the_same_if_processes_are_stopped_and_start_in_another_order(self):
        self.assert_same(Run(self.folder, '--start-order', 'reversed', condition=Condition(stops=1)))

    def test_a_run_that_is_interrupted_is_the_begin_of_the_others(self):
        def interrupt(process):
            time.sleep(1.0)
            process.send_signal(signal.SIGINT)

        run = Run(self.folder, '--speed-limit', '10', disturb=interrupt)
        self.assert_repeatable(run)
        self.assertLess(len(run.events), len(self.first.events))
        self.assertEqual(run.events, self.first.events[:len(run.events)])
