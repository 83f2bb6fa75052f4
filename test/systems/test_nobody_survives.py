"""Whatever process of a run is ended, and when: no process of the run stays, no port, and no temporary folder.

Each process that a program starts has the program's environment, and is known by a variable in it.
"""
import contextlib
import itertools
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

from own_folder import GUARD, MANIFEST, OwnFolder, events_of
from waiting import children_of, wait_for

from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
MARK = 'TEST_NOBODY_SURVIVES'
LAUNCH = """<launch>
<node pkg="move_base_abstract" type="move_base" name="robot"/>
<node pkg="move_base_abstract" type="map_server" name="map_server" args="{maps}/farm_yard.yaml"/>
<node pkg="study_of_others" type="lives.py" name="lives" output="screen"/>
<node pkg="study_of_others" type="shell.sh" name="shell"/>
<node pkg="move_base_abstract" type="shim_rate" name="binary"><param name="frequency" value="2.0"/></node>
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


TEST = """import pytest
@pytest.mark.lockstep(launch='run.launch')
def test_it(lockstep):
    lockstep.run_for(1e6)
"""
SCRIPT = """import roslaunch
parent = roslaunch.parent.ROSLaunchParent('x', [('run.launch', [])])
parent.start()
parent.spin()
"""
BOUND = 60.0  # wall s; without load it takes 5 s at most
BEGIN = 10.0  # wall s; then a run has begun that has fewer processes


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

    def begin(self, program, *words, before=()):
        """Start a program of this package, or pytest, whose output nobody reads when it has ended."""
        command = [sys.executable, '-m', program] if program == 'pytest' else [find_executable(program)]
        process = subprocess.Popen([*before, *command, *words], env=self.environment, cwd=self.folder,
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

    def programs(self):
        """Return the words of programs that run launch files, and what each prints when it is under way."""
        self.write('trials.yaml', 'experiment: trials\nlaunch: run.launch\nuntil: {at: 1000000.0}\nreplications: 2\n')
        self.write('test_it.py', TEST)
        self.write('script.py', SCRIPT)
        return ((('lockstep_launch', '--event-log', self.log, self.file), 'under way'),
                (('lockstep_launch', '--script', 'script.py'), 'under way'),
                (('demo', '--clock', 'scaled', '--factor', '1'), 'started in'),
                (('experiment', 'run', 'trials.yaml', '-o', self.path('trials')), ' of 2 trials'),
                (('verify', '--output', self.path('verified'), '--until', '1000000', self.file), ''),
                (('pytest', '-p', 'move_base_abstract_testing', '-p', 'no:cacheprovider', 'test_it.py'), ''),
                (('chaos', '--until', '1000000', self.file), ''))

    def assert_nobody(self, said='', were_both=False):
        """Wait until no process is left; check that no folder is left either but those that ``said`` names.

        ``were_both``: whether a guard and its program may have been ended at once: then what ignores signals stays,
        and the next program removes the folders.
        """
        deadline = time.monotonic() + BOUND
        while True:
            left = self.processes()
            for pid in [pid for pid, words in left.items() if were_both and 'shell.sh' in words]:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            if not left:
                break
            self.assertLess(time.monotonic(), deadline, left)
            time.sleep(0.02)
        if were_both:
            said += self.begin('lockstep_launch', '--list', self.file).communicate()[0]
        self.assertEqual([name for name in os.listdir(self.path('tmp')) if name not in said], [])
        for name in os.listdir(self.path('tmp')):  # it is kept for the user
            shutil.rmtree(self.path('tmp/' + name))

    def forget(self):
        """Remove what a program has written before."""
        for name in ('words', 'events.jsonl'):
            if os.path.exists(self.path(name)):
                os.remove(self.path(name))
        for name in ('trials', 'verified', 'lockstep_series_logs'):
            shutil.rmtree(self.path(name), ignore_errors=True)

    def running(self, *words):
        """Start the launch file in real time; return the program when time has begun in its nodes."""
        self.forget()
        process = self.begin('lockstep_launch', '--event-log', self.log, '--speed-limit', '1', *words, self.file)
        said = []
        self.assertTrue(any(said.append(line) or 'under way' in line for line in process.stdout), said)
        self.uri = re.search('ROS_MASTER_URI=(http[^\x1b\\s]+)', ''.join(said)).group(1)
        return process

    def why(self):
        """Return what `why` says of the run."""
        return subprocess.run([find_executable('why')], env={**self.environment, 'ROS_MASTER_URI': self.uri},
                              stdout=subprocess.PIPE, check=False, timeout=GUARD, text=True).stdout

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
        """Any process of any program that runs launch files, also while it begins; then the program itself."""
        programs = [words for words, _ in self.programs()]
        draws = random.Random(int(os.environ.get('SEED', '48')))
        for number in range(60 if 'NIGHT' in os.environ else len(programs)):
            words = programs[number % len(programs)]
            count, signals = draws.randint(1, 25), draws.choices([signal.SIGKILL, signal.SIGTERM], k=2)
            with self.subTest(program=words[:2], number=number, processes=count, signals=signals):
                self.forget()
                process, found, deadline = self.begin(*words), {}, time.monotonic() + BEGIN
                while len(found) < count and process.poll() is None and time.monotonic() < deadline:
                    found = self.processes()
                victim = draws.choice(sorted(found) or [process.pid])
                inner = children_of(process.pid)[:1] if process.poll() is None else []
                for pid, sent in zip((victim, process.pid), signals):
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(pid, sent)
                said = process.communicate()[0]
                self.assert_nobody(said, victim != process.pid and signals[1] == signal.SIGKILL)
                # Who is told to end before it has a handler says nothing, and a killed guard says nothing of it.
                if inner and words[0] != 'pytest' and (inner != [victim] or signals[1] != signal.SIGKILL):
                    self.assertRegex(said, ' (was )?ended by SIG|guard has ended')
                if os.path.exists(self.log):
                    events_of(self.log)

    def test_a_signal(self):
        """Each program says which one has ended it. Under nohup SIGHUP does not."""
        for words, sign in self.programs()[:4 if 'NIGHT' in os.environ else 2]:
            for before, said_then in ((('nohup',), 'ended by SIGTERM'), ((), 'ended by SIGHUP')):
                with self.subTest(program=words[:2], before=before):
                    self.forget()
                    process = self.begin(*words, before=before)
                    self.assertTrue(any(sign in line for line in process.stdout))
                    for pid in children_of(process.pid)[:1] + [process.pid]:
                        os.kill(pid, signal.SIGHUP)
                    if before:
                        process.terminate()
                    said = process.communicate()[0]
                    self.assertIn('{}: {}\n'.format(words[0], said_then), said)
                    self.assertNotIn('exit code -9', said)  # of a run that did not end when it was asked to
                    self.assert_nobody(said)

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

    def test_who_is_stopped_is_waited_for(self):
        """It has not died: `why` names it, and when it goes on, the bytes are the same."""
        logs = set()
        for role in ('', 'lives', 'binary', *(('time_master', 'rosmaster') if 'NIGHT' in os.environ else ())):
            with self.subTest(role=role):
                process = self.running('--until', '3')
                if role:
                    pid = self.pid_of(role, process.pid)
                    os.kill(pid, signal.SIGSTOP)
                    if role in ('time_master', 'rosmaster'):
                        time.sleep(3.0)
                    else:
                        wait_for('its name', lambda role=role: '/{} owes'.format(role) in self.why(), 20.0)
                    os.kill(pid, signal.SIGCONT)
                self.assertIn('the run is over', process.communicate()[0])
                self.assertEqual(process.returncode, 0)
                with open(self.log, 'rb') as stream:
                    logs.add(stream.read())
        self.assertEqual(len(logs), 1)

    def test_refused(self):
        """A run that is refused."""
        for words in (['--network', 'BAD', self.file], [self.path('none.launch')], ['--list', self.file]):
            process = self.begin('lockstep_launch', *words)
            process.stdout.read()
            self.assert_nobody()
