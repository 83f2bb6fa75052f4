"""Experiments with real worker processes: killed workers and clients, failures, warm and cold starts, leftovers."""
import contextlib
import csv
import dataclasses
import io
import json
import os
import signal
import subprocess
import sys
import tarfile
import unittest
import uuid

import psutil
import pytest
from own_folder import GUARD, OwnFolder
from waiting import wait_for

from move_base_abstract_experiments import records
from move_base_abstract_experiments.carrying import jobs
from move_base_abstract_experiments.description import plan, spec
from move_base_abstract_experiments.results import tables
from move_base_abstract_ros.loopback import find_executable

MARK = 'EXPERIMENT_TEST_MARK'
ONE = ('--workers', '1')
SWEEP = """
experiment: sweep
launch: $(find move_base_abstract)/examples/experiments/patrol.launch
replace: {move_base/move_base: move_base_abstract/move_base}
args: {robots: 1, rounds: 1, pause: '{pause}'}
factors: {pause: [1.0, 2.0]}
replications: 3
until: {idle: true}
"""
WRONG = """
experiment: wrong
launch: wrong.launch
args: {what: '{what}'}
factors: {what: [good, bad, callback, killed]}
until: {topic: /said}
record: {messages: [/said]}
metrics: wrong_metrics:count
"""
LAUNCH = """<launch>
  <arg name="what"/>
  <node pkg="move_base_abstract" type="fleet" name="fleet"><rosparam>{robots: [{name: a}]}</rosparam></node>
  <node pkg="sayings" type="say.py" name="say" required="true"><param name="what" value="$(arg what)"/></node>
</launch>"""
SAY = """#!/usr/bin/env python3
import os
import rospy
from std_msgs.msg import String
rospy.init_node('say')
if rospy.get_param('~what') == 'bad':
    raise ValueError('this one is wrong')
publisher = rospy.Publisher('/said', String, queue_size=1)
if rospy.get_param('~what') == 'callback':
    rospy.Timer(rospy.Duration(0.5), lambda event: {}['robot'])
if rospy.get_param('~what') == 'killed':
    rospy.sleep(0.5)
    os.kill(os.getpid(), 9)
for k in range(5):
    rospy.sleep(1.0)
    publisher.publish(str(k))
"""
COMMAND = """
experiment: command
command: [rosrun, move_base_abstract, lockstep, --seed, '{{seed}}', {}]
participants: [/say]
until: {{topic: /said}}
record: {{messages: [/said]}}
cores: one
"""
METRICS = """def count(trial):
    said = [message['data'] for _, _, message in trial.messages('/said')]
    if said != ['0']:
        raise RuntimeError('heard %s' % said)
    return {'said': len(said), 'events_of_a_log': len(list(trial.events()))}
"""
LATE = """def run(trial):
    return {'b': 1}
def count(trial):
    return {'late': {}['makespam']}
"""
SHORT = """
experiment: short
function: short:run
replications: 120
"""
FUNCTION = """import os, signal, subprocess, time
def run(trial):
    left = len(os.listdir('.')) + len(os.listdir('..'))  # of the trial before
    with open('said.txt', 'w') as stream:
        print('x', file=stream)
    if trial.replication % 7 == 3:
        os.makedirs('a/b')
    if trial.replication % 7 == 4:
        os.chmod('.', 0o500)
    if trial.replication % 7 == 5:
        subprocess.Popen(['sleep', '1000'])
    if trial.replication == 30:
        print('the last words', flush=True)
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(1000)
    return {'left': left, 'seed_again': trial.seed}
"""
PACKAGE = """<package format="2"><name>sayings</name><version>1.0.0</version><description>x</description>
<maintainer email="a@example.org">a</maintainer><license>x</license></package>"""


class Client:
    """`experiment run` in a process of its own; a mark in the environment identifies the processes that it starts."""

    def __init__(self, folder, file, out, *options):
        self.mark = uuid.uuid4().hex
        environment = dict(os.environ, **{MARK: self.mark})
        self.process = subprocess.Popen(
            [sys.executable, find_executable('experiment'), 'run', file, '-o', out, '--workers', '2', *options],
            cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            start_new_session=True)

    def end(self):
        """Wait for its end; return (exit code, output)."""
        try:
            text = self.process.communicate(timeout=GUARD)[0].decode()
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        return self.process.returncode, text

    def workers(self):
        """Return the worker processes; those that end meanwhile are left out."""
        found = []
        for one in psutil.Process(self.process.pid).children(recursive=True):
            with contextlib.suppress(psutil.NoSuchProcess):
                found += [one] * any('spawn_main' in word for word in one.cmdline())
        return found

    def left(self):
        """Return the processes with its mark that still run."""
        found = []
        for one in psutil.process_iter():
            try:
                if one.environ().get(MARK) == self.mark and one.status() != psutil.STATUS_ZOMBIE:
                    found.append(one)
            except psutil.Error:
                pass
        return found


def without_wall(path):
    """Return a table as lists of cells, without the columns of wall time."""
    with open(path, newline='') as stream:
        rows = list(csv.reader(stream))
    kept = [k for k, name in enumerate(rows[0]) if name not in tables.WALL]
    return [[row[k] for k in kept] for row in rows]


class Experiments(OwnFolder, unittest.TestCase):
    """The promises of `experiment run`."""

    def complete(self, out):
        folder = self.path(out + '/trials')
        return [name for name in os.listdir(folder) if not name.endswith('.unfinished')] if os.path.isdir(
            folder) else []

    def results(self, out):
        """Return the Results of an experiment's folder."""
        return [records.read_trial(self.path(out), one.id) for one in records.read_plan(self.path(out)).trials]

    @pytest.mark.night
    def test_killed_workers_and_clients_lose_nothing_and_change_nothing(self):
        file = self.write('sweep.yaml', SWEEP)
        whole = Client(self.folder, file, 'whole')
        self.assertEqual(whole.end()[0], 0)
        killed = Client(self.folder, file, 'killed')
        wait_for('the first trial', lambda: self.complete('killed'), GUARD)
        killed.workers()[0].suspend()
        killed.workers()[1].kill()
        count = len(self.complete('killed'))  # counted now: others may have done all trials by its end
        before = killed.workers()[0]
        wait_for('the end of a worker that is stopped', lambda: not before.is_running(), GUARD)
        wait_for('a trial after the death of all workers', lambda: len(self.complete('killed')) > count, GUARD)
        killed.process.kill()
        killed.end()
        wait_for('the end of all processes of a client that was killed', lambda: not killed.left(), GUARD)
        before = {name: os.stat(self.path('killed/trials/{}/trial.json'.format(name))).st_mtime_ns
                  for name in self.complete('killed')}
        again = Client(self.folder, file, 'killed')
        code, text = again.end()
        self.assertEqual(code, 0, text)
        self.assertIn('complete already', text)
        self.assertEqual(without_wall(self.path('killed/trials.csv')),
                         without_wall(self.path('whole/trials.csv')))
        for name, stamp in before.items():
            self.assertEqual(os.stat(self.path('killed/trials/{}/trial.json'.format(name))).st_mtime_ns, stamp)
        self.assertEqual(len(without_wall(self.path('whole/trials.csv'))), 7)
        wait_for('the end of all processes', lambda: not again.left(), GUARD)

    @pytest.mark.night
    def test_ctrl_c_and_sigterm_end_what_was_started(self):
        file = self.write('sweep.yaml', SWEEP)
        for out, end in (('out', lambda pid: os.killpg(pid, signal.SIGINT)), (
                'other', lambda pid: os.kill(pid, signal.SIGTERM))):
            client = Client(self.folder, file, out)
            wait_for('the first trial', lambda out=out: self.complete(out), GUARD)
            end(client.process.pid)
            code, text = client.end()
            self.assertEqual(code, 130, text)
            self.assertNotIn('Traceback', text)
            wait_for('the end of all processes', lambda client=client: not client.left(), GUARD)
            self.assertTrue(os.path.isfile(self.path(out + '/trials.csv')))

    def test_a_trial_that_fails_is_recorded_and_stops_nothing(self):
        self.write('sayings/package.xml', PACKAGE)
        self.write('sayings/say.py', SAY, 0o755)
        mistaken = self.write('mistaken.yaml', WRONG.replace('args: {what', 'args: {wat'))
        self.write('wrong_metrics.py', METRICS)
        self.write('wrong.launch', LAUNCH)
        file = self.write('wrong.yaml', WRONG)
        os.environ['ROS_PACKAGE_PATH'] = self.folder + ':' + os.environ['ROS_PACKAGE_PATH']
        code, text = Client(self.folder, mistaken, 'mistaken', *ONE).end()
        self.assertEqual((code, "did you mean 'what'" in text, os.path.exists(self.path('mistaken'))), (2, True, False))
        code, text = Client(self.folder, file, 'out', *ONE).end()
        self.assertEqual(code, 1, text)
        good, bad, callback, killed = self.results('out')
        self.assertEqual((good.status, good.error, good.metrics.get('said')), ('complete', None, 1))
        self.assertEqual(good.simulated_seconds, 1.0)
        self.assertEqual((bad.status, bad.attempts), ('failed', 2))
        self.assertIn('ValueError: this one is wrong', bad.error)
        self.assertTrue(os.path.isfile(self.path('out/trials/{}/logs/say.txt'.format(bad.id))))
        self.assertEqual((good.crashes, {one['crashed'] for one in good.ends}), ([], {False}))
        for one, how in ((callback, 'KeyError in a callback of rospy.Timer, say.py, line 10'),
                         (killed, 'ended by SIGKILL')):
            crash = '/say crashed at 1.500000000 s: ' + how
            self.assertEqual((one.status, one.crashes, one.ended_by), ('failed', [crash], 'crash'))
            self.assertTrue(one.error.startswith(crash), one.error)
        told, = (one for one in killed.ends if one['node'] == '/say')
        self.assertEqual((told['signal'], told['at'], told['crashed']), ('SIGKILL', 1.5, True))
        allowed = self.write('allowed.yaml', WRONG.replace('[good, bad, callback, killed]', '[callback]')
                             + 'crashes: allow\n')
        code, text = Client(self.folder, allowed, 'allowed', *ONE).end()
        self.assertEqual(code, 0, text)
        about = self.results('allowed')[0]
        self.assertEqual((about.status, about.crashes), ('complete', callback.crashes))
        code, text = Client(self.folder, self.write('allowed.yaml', WRONG.replace(
            '[good, bad, callback, killed]', '[callback]')), 'allowed', *ONE).end()
        self.assertEqual((code, 'complete already' in text), (1, False), text)

    def test_a_command_is_run_as_well_as_a_launch_file(self):
        program = self.write('say.py', SAY.replace("'~what'", "'~what', ''").replace(
            'str(k)', "rospy.get_param('/time_master/cores', '')"), 0o755)
        file = self.write('command.yaml', COMMAND.format(program))
        code, text = Client(self.folder, file, 'command', *ONE).end()
        self.assertEqual(code, 0, text)
        only = self.results('command')[0]
        self.assertEqual((only.status, only.simulated_seconds, only.repeatable, only.ended_by),
                         ('complete', 1.0, True, 'topic'))
        with open(self.path('command/trials/{}/messages.jsonl'.format(only.id))) as stream:
            self.assertIn('"one"', stream.read())

    def test_a_metric_that_fails_in_all_trials_is_said_with_the_first_and_is_not_good(self):
        self.write('late.py', LATE)
        file = 'experiment: late\nfunction: late:run\nreplications: 3\nmetrics: late:count\n'
        for more, complete in (('', 3), ('primary: late\n', 0)):
            code, text = Client(self.folder, self.write('late.yaml', file + more), 'late', *ONE).end()
            lines = text.splitlines()
            said = next(k for k, line in enumerate(lines) if line.endswith("KeyError: 'makespam' in 1 of 1 trials"))
            self.assertLess(said, next(k for k, line in enumerate(lines) if line.startswith('3 of 3 trials')), text)
            self.assertEqual((code, f'experiment: {complete} of 3 trials are complete' in text), (1, True), text)
            found = subprocess.run([sys.executable, find_executable('experiment'), 'status', self.path('late')],
                                   stdout=subprocess.PIPE, check=True).stdout.decode()
            self.assertIn(f'{complete} of 3 trials complete', found)
            with open(self.path('late/tables/means.csv'), newline='') as stream:
                self.assertEqual({row['metric']: row['n'] for row in csv.DictReader(stream)},
                                 {'b': '0', 'late': '0'} if more else {'b': '3'})

    @pytest.mark.night
    def test_short_functions_share_processes_and_leave_each_other_nothing(self):
        self.write('short.py', FUNCTION)
        client = Client(self.folder, self.write('short.yaml', SHORT), 'short')
        wait_for('the first batches', lambda: len(self.complete('short')) > 20, GUARD)
        client.workers()[0].kill()
        code, text = client.end()
        self.assertEqual(code, 1, text)
        found = self.results('short')
        self.assertEqual([one.id for one in found if not one.is_complete], [found[30].id], text)
        self.assertIn('ended with code -9', found[30].error)
        self.assertEqual(found[30].attempts, 2)
        del found[30]
        self.assertEqual({one.metrics['left'] for one in found}, {2})  # logs and files, as in a new process
        self.assertEqual([one.metrics['seed_again'] for one in found], [k for k in range(120) if k != 30])
        wait_for('the end of all processes', lambda: not client.left(), GUARD)

    def test_a_warm_start_changes_nothing(self):
        experiment = spec.read(self.write('sweep.yaml', SWEEP.replace('until:', 'record: {hashes: true}\nuntil:')))
        one = plan.trials(experiment)[0]
        warm = jobs.WarmProcess()
        try:
            logs = [self.log_of(warm.run(jobs.make_job(dataclasses.replace(one, verified_by=again), is_warm=is_warm)),
                                again) for is_warm, again in ((True, ''), (False, 'order'), (True, ''))]
        finally:
            warm.close()
        self.assertGreater(len(logs[0]), 1000)
        self.assertEqual(logs[0], logs[1])
        self.assertEqual(logs[0], logs[2])

    def log_of(self, content, again):
        with tarfile.open(fileobj=io.BytesIO(content), mode='r:*') as archive:
            about = json.load(archive.extractfile('trial.json'))
            self.assertEqual((about['status'], about['error'], about['verified']), (
                'complete', None, 'identical' if again else None))
            return archive.extractfile('events.jsonl').read()
