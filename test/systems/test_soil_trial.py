"""Trials of the study by its command line: the same on both engines and at any speed, and after interruptions.

GUARD [s, wall] only ends a test that would never end.
"""
import csv
import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

import pytest
from scenarios import ALL_CORES, Condition, repeated
from waiting import GUARD, wait_for

from move_base_abstract_ros import loopback
from soil_mapping.study import ros_trial

STUDY = str(pathlib.Path(__file__).resolve().parents[2] / 'examples' / 'study.py')
MISSION = ['--budget', '120', '--seed', '3', '--no-pictures']
LIMIT = 40.0  # simulated s per wall s
FILES = ['.made_by_move_base_abstract', 'events.csv', 'metrics.csv', 'prediction.npy', 'samples.csv',
         'trajectories.csv', 'trial.json', 'truth.npy', 'variance.npy']

pytestmark = pytest.mark.night
NEEDS_MESA = unittest.skipIf(sys.version_info < (3, 11), 'Mesa is not installed; it needs Python 3.11')


class Trials(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='soil_trial_')
        numbers = itertools.count()

        def run(condition):
            limit = ['--limit', str(condition.speed_limit)] if condition.speed_limit else []
            with condition.around():
                return cls.trial('plain_{}'.format(next(numbers)), *limit)
        cls.runs = repeated('trial of the study', run, lambda one: one[0] + one[1])
        cls.plain = cls.runs[0]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def path(cls, *parts):
        return os.path.join(cls.folder, *parts)

    @classmethod
    def study(cls, *words):
        """Run `study` with these words; return what subprocess.run returns."""
        return subprocess.run([sys.executable, STUDY, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, timeout=GUARD, check=False)

    @classmethod
    def trial(cls, name, *words):
        """Run a trial to its end; return (bytes of events.csv, bytes of the robots' log or None, trial.json)."""
        done = cls.study('trial', *MISSION, '--output', cls.path(name), *words)
        if done.returncode != 0:
            raise AssertionError(done.stdout)
        return cls.results(name)

    @classmethod
    def results(cls, name):
        def content(file):
            path = cls.path(name, file)
            if not os.path.exists(path):
                return None
            with open(path, 'rb') as stream:
                return stream.read()
        return content('events.csv'), content('lockstep_events.jsonl'), json.loads(content('trial.json'))

    def test_the_plain_trial_is_worth_comparing(self):
        events, log, about = self.plain
        kinds = [row['event'] for row in csv.DictReader(events.decode().splitlines())]
        self.assertGreater(kinds.count('arrive'), 5)
        self.assertGreater(kinds.count('map'), 5)
        self.assertEqual(kinds[-1], 'end')
        self.assertEqual(about['simulated_s'], 120.0)
        end = json.loads(log.splitlines()[-1])['end']
        self.assertEqual((end['repeatable'], end['degraded_because']), (True, []))
        self.assertEqual(sorted(os.listdir(self.path('plain_0'))), sorted([*FILES, 'lockstep_events.jsonl']))

    @NEEDS_MESA
    def test_mesa_makes_the_same_events(self):
        self.assertEqual(self.trial('mesa', '--engine', 'mesa')[0], self.plain[0])

    def test_the_same_whatever_else_happens(self):
        for run in self.runs:
            self.assertEqual(run[:2], self.plain[:2])

    def test_the_same_at_a_limited_speed_on_loaded_cores(self):
        with Condition(load=ALL_CORES).around():
            began = time.monotonic()
            events, log, about = self.trial('limited', '--limit', str(LIMIT))
        self.assertGreater(time.monotonic() - began, 120.0 / LIMIT)
        self.assertLess(about['speed_up']['moving'], 1.05 * LIMIT)
        self.assertEqual((events, log), self.plain[:2])

    def test_a_time_master_that_ends_by_itself_is_not_cut(self):
        path = pathlib.Path(self.path('own_end.jsonl'))
        master = mock.Mock()
        master.process.poll.side_effect = lambda: path.touch() if master.process.poll.call_count == 3 else None
        ros_trial.end_nodes([master], None, path)
        self.assertEqual(master.signal.mock_calls, [mock.call(signal.SIGKILL)])

    def test_a_time_master_that_does_not_end_is_told_to(self):
        path = pathlib.Path(self.path('told_end.jsonl'))
        master = mock.Mock(**{'process.poll.return_value': None, 'signal.side_effect': lambda _number: path.touch()})
        with mock.patch.object(ros_trial, 'OWN_END_S', 0.0):
            ros_trial.end_nodes([master], None, path)
        self.assertEqual(master.signal.mock_calls, [mock.call(signal.SIGTERM), mock.call(signal.SIGKILL)])

    def test_another_seed_makes_another_trial(self):
        self.assertNotEqual(self.trial('other', '--seed', '4')[0], self.plain[0])

    def test_a_charge_is_part_of_the_mission_and_repeatable(self):
        first, second = (self.trial(name, '--charge', 'fixed:0.5')[:2] for name in ('charge_1', 'charge_2'))
        self.assertEqual(first, second)
        self.assertNotEqual(first[0], self.plain[0])

    def test_the_scaled_clock_runs_the_same_mission(self):
        about = self.trial('scaled', '--clock', 'scaled', '--factor', '30')[2]
        self.assertEqual(about['engine'], {'name': 'ros', 'clock': 'scaled', 'factor': 30.0})
        self.assertGreaterEqual(about['simulated_s'], 120.0)
        self.assertGreater(about['metrics']['samples'], 5)

    def end_by(self, number, name):
        """Start a slow trial, end it by a signal in the middle, wait for its processes; return its exit code."""
        path = self.path(name)
        process = subprocess.Popen([sys.executable, STUDY, 'trial', *MISSION, '--output', path, '--limit', '2'],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT)
        wait_for('an event log', lambda: os.path.exists(path + '.unfinished/lockstep_events.jsonl.part'), GUARD)
        process.send_signal(number)
        code = process.wait(GUARD)
        self.assertTrue(os.path.isdir(path + '.unfinished'))
        self.assertFalse(os.path.exists(path))
        wait_for('the end of all processes', lambda: not processes_with(path), GUARD)
        return code

    def test_a_trial_that_is_interrupted_ends_soon_with_its_code(self):
        self.assertEqual(self.end_by(signal.SIGINT, 'interrupted'), 130)

    def test_a_trial_that_is_interrupted_after_its_mission_is_complete(self):
        path = self.path('after')
        process = subprocess.Popen([sys.executable, STUDY, 'trial', *MISSION, '--pictures', '--output', path],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT)
        # When the first file of the record exists, the mission is over.
        wait_for('events', lambda: os.path.exists(path + '.unfinished/events.csv') or os.path.exists(path), GUARD)
        process.send_signal(signal.SIGINT)
        process.wait(GUARD)
        self.assertEqual(self.results('after')[:2], self.plain[:2])
        wait_for('the end of all processes', lambda: not processes_with(path), GUARD)

    def test_what_is_in_the_way_is_named_and_stays(self):
        os.mkdir(self.path('mine'))
        with open(self.path('mine', 'notes.txt'), 'w', encoding='utf-8') as stream:
            stream.write('precious')
        done = self.study('trial', *MISSION, '--output', self.path('mine'))
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn(self.path('mine') + ": is not empty (it holds 'notes.txt')", done.stdout)
        self.assertEqual(os.listdir(self.path('mine')), ['notes.txt'])

    @NEEDS_MESA
    def test_a_disk_that_is_full_is_named_and_the_missions_events_stay(self):
        # A limit for the size of files stands in for a full disk; the maps are larger than that.
        done = subprocess.run(['prlimit', '--fsize=100000', sys.executable, STUDY, 'trial', *MISSION, '--engine',
                               'mesa', '--output', self.path('full')], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=GUARD, check=False)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn('full.unfinished/truth.npy: cannot be written: File too large', done.stdout)
        self.assertNotIn('Traceback', done.stdout)
        with open(self.path('full.unfinished', 'events.csv'), 'rb') as stream:
            self.assertEqual(stream.read(), self.plain[0])

    def test_a_trial_that_is_killed_is_marked_and_run_again(self):
        path = self.path('killed')
        self.assertEqual(self.end_by(signal.SIGKILL, 'killed'), -signal.SIGKILL)
        self.assertEqual(self.trial('killed')[:2], self.plain[:2])
        self.assertFalse(os.path.exists(path + '.unfinished'))

    @NEEDS_MESA
    def test_a_study_goes_on_where_it_was(self):
        words = ['run', '--budget', '60', '--seeds', '1', '--groups', 'mesa', 'ros-lockstep', '--output',
                 self.path('study')]
        done = self.study(*words)
        self.assertEqual(done.returncode, 0, done.stdout)
        trials = {os.path.join(at, name) for at, _, names in os.walk(self.path('study', 'trials')) for name in names
                  if name == 'trial.json'}
        self.assertEqual(len(trials), 8)
        removed = sorted(trials)[0]
        os.remove(removed)
        stamps = {path: os.stat(path).st_mtime_ns for path in trials - {removed}}
        done = self.study(*words)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('8 of 8 trials are complete; run twice: 2 identical, 0 different', done.stdout)
        self.assertTrue(os.path.exists(removed))
        self.assertEqual({path: os.stat(path).st_mtime_ns for path in stamps}, stamps)
        with open(self.path('study', 'report.html'), encoding='utf-8') as stream:
            cells = re.findall(r'<td[^>]*>([^<]*)</td>', stream.read())
        place = cells.index('Mesa and ROS, lockstep')
        self.assertEqual(cells[place:place + 4], ['Mesa and ROS, lockstep', '4', '4', 'yes'])
        number = next(name for name in os.listdir(self.path('study', 'trials')) if os.path.exists(
            self.path('study', 'trials', name, 'events.jsonl'))).partition('-')[0]
        done = self.study('rerun', self.path('study'), number)
        self.assertIn('rerun: the same trial', done.stdout)

    def test_a_master_of_another_program_on_the_same_port_is_not_taken_for_ones_own(self):
        with loopback.Loopback() as other:
            port, real = int(other.uri.rsplit(':', 1)[1].strip('/')), loopback.free_port
            ports = [port]
            loopback.free_port = lambda: ports.pop() if ports else real()
            self.addCleanup(setattr, loopback, 'free_port', real)
            with loopback.Loopback() as own:
                self.assertEqual(ports, [])
                self.assertNotEqual(own.uri, other.uri)

    def test_a_field_that_cannot_be_read_is_named(self):
        done = self.study('trial', '--field', 'csv:/no/such.csv', '--output', self.path('no_field'))
        self.assertEqual(done.returncode, 2)
        self.assertIn('/no/such.csv: cannot be read', done.stdout)
        self.assertFalse(os.path.exists(self.path('no_field')))

    def test_a_python_without_what_the_study_needs_is_an_error_that_says_what_to_do(self):
        environment = dict(os.environ, SOIL_MAPPING_PYTHON='/no/such/python')
        done = subprocess.run([sys.executable, '-S', '-c', 'from soil_mapping.ros import find_python as f\n'
                               'f.find_python(["study"], "study")'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, timeout=GUARD, check=False, env=environment)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn('/examples/study.py setup`', done.stdout)


def processes_with(word):
    """Return the ids of the processes whose command line has the word."""
    found = []
    for number in filter(str.isdigit, os.listdir('/proc')):
        try:
            with open('/proc/{}/cmdline'.format(number), 'rb') as stream:
                if word.encode() in stream.read():
                    found.append(int(number))
        except OSError:
            continue
    return found
