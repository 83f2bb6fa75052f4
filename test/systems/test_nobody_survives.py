"""Whatever process of a run is ended, and when: no process of the run stays, no port, and no temporary folder.

Each process that a program starts has the program's environment, and is known by a variable in it.
"""
import contextlib
import itertools
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

from own_folder import GUARD, MANIFEST, OwnFolder, events_of
from waiting import children_of

from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
MARK = 'TEST_NOBODY_SURVIVES'
LAUNCH = """<launch>
<node pkg="move_base_abstract" type="move_base" name="robot"/>
<node pkg="move_base_abstract" type="map_server" name="map_server" args="{maps}/farm_yard.yaml"/>
<node pkg="study_of_others" type="lives.py" name="lives" output="screen"/>
<node pkg="study_of_others" type="shell.sh" name="shell"/>
<node pkg="move_base_abstract" type="shim_idle" name="binary"/>
</launch>"""
LIVES = """#!/usr/bin/env python3
import rospy
rospy.init_node('lives')
rospy.on_shutdown(lambda: open('{words}', 'a').write('last words'))
print('under way', flush=True)
while not rospy.is_shutdown():
    rospy.sleep(1.0)
"""
SHELL = '#!/bin/sh\n(trap "" INT TERM; while true; do sleep 0.1; done) &\nwait\n'


class NobodySurvives(OwnFolder, unittest.TestCase):
    """Programs with processes, of which one is ended."""

    def setUp(self):
        """Make a launch file of which nodes take part, look on, ignore signals, and have last words."""
        super().setUp()
        self.write('own/package.xml', MANIFEST)
        self.write('own/lives.py', LIVES.replace('{words}', self.path('words')), 0o755)
        self.write('own/shell.sh', SHELL, 0o755)
        shutil.copy(os.path.join(HERE, 'unmodified', 'fates.py'), self.path('own'))
        os.chmod(self.path('own/fates.py'), 0o755)
        self.file = self.write('run.launch', LAUNCH.replace('{maps}', os.path.join(HERE, '..', '..', 'maps')))
        self.log = self.path('events.jsonl')
        os.mkdir(self.path('tmp'))
        self.environment.update({
            MARK: self.folder, 'TMPDIR': self.path('tmp'), 'ROS_HOME': self.path('ros'),
            'ROS_PACKAGE_PATH': os.pathsep.join([self.path('own'), os.environ['ROS_PACKAGE_PATH']])})

    def begin(self, program, *words):
        """Start a program of this package, whose output nobody reads when it has ended."""
        process = subprocess.Popen([find_executable(program), *words], env=self.environment, cwd=self.folder,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, start_new_session=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.addCleanup(process.stdout.close)
        return process

    def processes(self):
        """Return {process id: command line} of all processes that belong to the test."""
        mark, found = '{}={}'.format(MARK, self.folder).encode(), {}
        for pid in filter(str.isdigit, os.listdir('/proc')):
            try:
                with open('/proc/{}/environ'.format(pid), 'rb') as about, open('/proc/{}/cmdline'.format(pid)) as words:
                    if mark in about.read().split(b'\0'):
                        found[int(pid)] = words.read().replace('\0', ' ')
            except OSError:
                continue  # it has ended
        return found

    def assert_nobody(self):
        """Wait until no process is left; check that no folder is left either."""
        deadline = time.monotonic() + GUARD
        while self.processes():
            self.assertLess(time.monotonic(), deadline, self.processes())
            time.sleep(0.02)
        self.assertEqual(os.listdir(self.path('tmp')), [])

    def running(self):
        """Start the launch file in real time; return the program when time has begun in its nodes."""
        for name in ('words', 'events.jsonl'):
            if os.path.exists(self.path(name)):
                os.remove(self.path(name))
        process = self.begin('lockstep_launch', '--event-log', self.log, '--speed-limit', '1', self.file)
        self.assertTrue(any('under way' in line for line in process.stdout), 'the run has not begun')
        return process

    def pid_of(self, role, guard):
        """Return the process id of the guard, of the program, of its ROS master, or of a node."""
        if role == 'guard':
            return guard
        program = children_of(guard)[0]
        if role == 'program':
            return program
        words = self.processes()
        return next(pid for pid in children_of(program) if (
            words[pid] == words[program] if role == 'rosmaster' else '__name:={} '.format(role) in words[pid]))

    def test_a_run(self):
        """Each process without which there is no run."""
        roles = ('guard', 'program', 'rosmaster', 'time_master')
        cases = [*itertools.product(roles, (signal.SIGKILL,)), *itertools.product(roles, (signal.SIGTERM,))]
        for role, number in cases if 'NIGHT' in os.environ else cases[:5]:
            with self.subTest(role=role, signal=number):
                process = self.running()
                os.kill(self.pid_of(role, process.pid), number)
                self.assert_nobody()
                said = process.stdout.read()
                self.assertIn({'guard': 'its guard has ended' if number == signal.SIGKILL else 'ended by SIGTERM',
                               'program': ' ended by SIG', 'rosmaster': 'the ROS master', 'time_master': 'time master'}[
                                   role], said)
                self.assertTrue(os.path.exists(self.path('words')), said)  # nobody was killed before that
                if role != 'time_master' or number != signal.SIGKILL:
                    self.assertFalse(events_of(self.log)[0].end['repeatable'], said)

    def test_at_any_moment(self):
        """Any process, also while the run begins."""
        draws = random.Random(48)
        for _ in range(int(os.environ.get('NIGHT', '3'))):
            process, count, number = self.begin('lockstep_launch', self.file), draws.randint(1, 12), draws.choice(
                [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP])
            with self.subTest(processes=count, signal=number):
                found = {}
                while len(found) < count and process.poll() is None and 'sleep' not in str(found):
                    found = self.processes()
                with contextlib.suppress(ProcessLookupError):
                    os.kill(draws.choice(sorted(found)), number)
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process.pid, number)
                self.assert_nobody()

    def test_a_node_that_is_killed_labels_the_run(self):
        """A fault of its own does not."""
        for fate, label in (('killed', ''), ('vanishes', ''), ('faults', ''), ('lives', 'ended at 1 s without a word')):
            with self.subTest(fate=fate):
                if label:
                    process = self.running()
                    os.kill(self.pid_of('lives', process.pid), signal.SIGKILL)
                    for line in process.stdout:
                        if label in line:
                            break
                    process.terminate()
                    process.wait()
                else:
                    path = self.write('fate.launch', '<launch><node pkg="study_of_others" type="fates.py" name="fate" '
                                      'args="{}"/></launch>'.format(fate))
                    self.begin('lockstep_launch', '--event-log', self.log, '--until', '5', path).wait()
                why = events_of(self.log)[0].end['not_repeatable_because']
                self.assertEqual([label in line for line in why], [True] if label else [], why)
                os.remove(self.log)

    def test_refused(self):
        """A run that is refused."""
        for words in (['--network', 'BAD', self.file], [self.path('none.launch')], ['--list', self.file]):
            process = self.begin('lockstep_launch', *words)
            process.stdout.read()
            self.assert_nobody()
