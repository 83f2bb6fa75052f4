"""Trials that are a user's function: what it is given, what it may return, and that it is alone."""
import importlib
import json
import os
import pickle
import random
import subprocess
import sys

import numpy
import pytest

from experiment_jobs import job_of
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.runs.calls import DeathError
from move_base_abstract_experiments import records
from move_base_abstract_experiments.trials import execution, functions, run_folders

MODEL = """
import os, sys, threading, time
ready = []

def prepare(args, factors):
    ready.append((args['n'], factors['n']))

def run(trial):
    assert os.getcwd() == str(trial.files), os.getcwd()
    (trial.files / 'out.csv').write_text('x')
    print('said by the function')
    trial.simulated_seconds = 12.5
    if trial.args['n'] == 2:
        trial.not_repeatable('two')
    if trial.args['n'] == 3:
        raise ValueError('three is too many')
    if trial.args['n'] == 4:
        return {'seed': 1}
    if trial.args['n'] == 5:
        os._exit(3)
    if trial.args['n'] == 11:
        os.kill(os.getpid(), 11)
    if trial.args['n'] == 12:
        time.sleep(600)
    if trial.args['n'] == 10:
        worker = threading.Thread(target=lambda: {}['task'], name='worker')
        worker.start()
        worker.join()
    if trial.args['n'] == 7:
        trial.simulated_seconds = float('nan')
    if trial.args['n'] == 8:
        trial.labels = [8]
    if trial.args['n'] == 9:
        return {'large': 10 ** 400}
    if trial.args['n'] == 6 and os.fork() == 0:
        time.sleep(600)  # what it starts ends with it, and nobody waits for it
    return {'doubled': 2 * trial.args['n'], 'prepared': len(ready), 'seeds': trial.seed, 'none': float('nan')}
"""

DRAW = """
import random

import numpy

def prepare(args, factors):
    numpy.random.seed(5)

def run(trial):
    return {'of_numpy': numpy.random.random(), 'of_python': random.random()}
"""
DRAW_THRICE = """
import json, os, sys
from experiment_jobs import job_of
from move_base_abstract_experiments.trials import functions, run_folders

folder, prepared = sys.argv[1], json.loads(sys.argv[2])
folders = run_folders.Folders(folder, folder, folder)
jobs = [job_of({'experiment': 'x', 'function': 'draw:run', **prepared}, modules=folder, seed=seed)
        for seed in (7, 8, 7)]
if prepared:
    functions.prepare(jobs[0].trial.experiment, folder)
was_there = 'numpy' in sys.modules
print(json.dumps([was_there, *(functions.run_trial(job, folders).metrics for job in jobs)]))
"""


def call(tmp_path, n):
    """Return the answer of a trial in a Python of its own: it forks."""
    (tmp_path / 'model.py').write_text(MODEL)
    folders = [str(tmp_path / name) for name in ('own', 'files', 'logs')]
    for path in folders:
        os.mkdir(path)
    job = job_of({'experiment': 'x', 'function': 'model:run', 'prepare': 'model:prepare', 'args': {'n': '{n}'},
                  'factors': {'n': [n]}, 'time_limit': 2.0 if n == 12 else 60.0}, modules=str(tmp_path), seed=7,
                 configuration={'n': n})
    path = tmp_path / 'job'
    path.write_bytes(pickle.dumps((job, run_folders.Folders(*folders))))
    environment = {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    subprocess.run([sys.executable, '-m', 'move_base_abstract_experiments.trials.functions', str(path)], timeout=60,
                   check=True, env=environment)
    return json.loads((tmp_path / 'job.answer').read_text())


def test_a_function_is_called_in_its_folder_with_what_was_prepared(tmp_path):
    assert call(tmp_path, 1) == {'metrics': {'doubled': 2, 'prepared': 1, 'seeds': 7, 'none': None}, 'labels': [],
                                 'simulated_seconds': 12.5, 'processes': [
                                     {'node': 'the function', 'takes_part': False, 'code': 0, 'shown': []}]}
    assert (tmp_path / 'files' / 'out.csv').read_text() == 'x'
    assert 'said by the function' in (tmp_path / 'logs' / 'function.txt').read_text()


def test_it_may_say_that_it_is_not_repeatable(tmp_path):
    assert call(tmp_path, 2)['labels'] == ['two']


def test_what_it_makes_of_its_labels_is_told_as_text(tmp_path):
    assert call(tmp_path, 8)['labels'] == ['8']


def test_what_nobody_caught_in_its_threads_is_told(tmp_path):
    assert call(tmp_path, 10)['processes'][0]['shown'] == ['KeyError in thread worker']


def test_what_it_leaves_running_ends_with_it(tmp_path):
    assert call(tmp_path, 6)['metrics']['doubled'] == 12


@pytest.mark.parametrize('n, problem', [
    (3, 'ValueError: three is too many'), (4, "ValueError: 'seed' is not a name for a metric"),
    (5, 'its process ended without a result: exit code 3'), (11, 'without a result: ended by SIGSEGV'),
    (12, 'it was not over after 2 s of wall time'), (7, 'simulated_seconds must be a finite number >= 0, got nan'),
    (9, 'large must lie within what a float holds, got a whole number of about 401 digits')])
def test_what_goes_wrong_is_told_in_a_line(tmp_path, n, problem):
    assert problem in call(tmp_path, n)['problem']


@pytest.mark.parametrize('code, is_late, crashes, how', [
    (-11, False, ['the function crashed: ended by SIGSEGV'], 'crash'),
    (3, False, ['the function crashed: exit code 3'], 'crash'), (0, False, [], 'error'), (None, False, [], 'error'),
    (None, True, [], 'time_limit')])
def test_a_function_whose_process_died_has_crashed(monkeypatch, code, is_late, crashes, how):
    def run_trial(*_):
        raise DeathError(8.0, code, is_late)
    monkeypatch.setattr(functions, 'run_trial', run_trial)
    result = records.Result('x')
    with pytest.raises(SimulatorError) as raised:
        execution._call(job_of(), None, result)
    assert (result.crashes, raised.value.ended_by or 'error') == (crashes, how)


def test_a_module_beside_the_file_goes_to_a_worker_that_does_not_have_it(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, 'path', list(sys.path))
    here, there = tmp_path / 'here', tmp_path / 'there'
    (here / 'pack').mkdir(parents=True)
    there.mkdir()
    (here / 'alone.py').write_text('def run(trial):\n    return 1\n')
    (here / 'pack' / '__init__.py').write_text('')
    (here / 'pack' / 'inner.py').write_text('from .other import run\n')
    (here / 'pack' / 'other.py').write_text('def run(trial):\n    return 2\n')
    sources = functions.sources(('alone:run', 'pack.inner:run', 'json:dumps'), str(here))
    assert sorted(sources) == ['alone.py', 'pack/__init__.py', 'pack/inner.py', 'pack/other.py']
    assert functions.place(job_of(folder=str(here), sources=sources), str(there)).modules == str(here)
    (here / 'alone.py').write_text('def run(trial):\n    return 3\n')  # the worker's copy is another one
    for _ in range(2):
        modules = functions.place(job_of(folder=str(here), sources=sources), str(there)).modules
        assert modules.startswith(str(there))
    importlib.invalidate_caches()
    assert [functions.load(name, modules)(None) for name in ('alone:run', 'pack.inner:run')] == [1, 2]


def test_of_a_package_that_is_named_itself_all_modules_go(tmp_path):
    (tmp_path / 'pack').mkdir()
    (tmp_path / 'pack' / '__init__.py').write_text('from .inner import run\n')
    (tmp_path / 'pack' / 'inner.py').write_text('def run(trial):\n    return 1\n')
    (tmp_path / 'alone.py').write_text('')
    (tmp_path / 'alone').mkdir()  # a folder of data: Python takes the module
    (tmp_path / 'alone' / 'data.py').write_text('')
    assert sorted(functions.sources(('pack:run', 'alone:run'), str(tmp_path))) == [
        'alone.py', 'pack/__init__.py', 'pack/inner.py']


def test_a_module_goes_nowhere_else(tmp_path):
    with pytest.raises(ConfigurationError, match="in the experiment's folder"):
        functions.place(job_of(folder=str(tmp_path), sources={'../x.py': ''}), str(tmp_path / 'own'))


@pytest.mark.parametrize('prepared', [{}, {'prepare': 'draw:prepare'}])
def test_global_generators_start_from_the_trials_seed(tmp_path, prepared):
    (tmp_path / 'draw.py').write_text(DRAW)
    environment = {**os.environ, 'OPENBLAS_NUM_THREADS': '1', 'OMP_NUM_THREADS': '1',
                   'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    said = subprocess.run([sys.executable, '-c', DRAW_THRICE, str(tmp_path), json.dumps(prepared)], timeout=60,
                          check=True, env=environment, stdout=subprocess.PIPE, text=True).stdout
    was_there, first, other, again = json.loads(said)
    assert was_there == bool(prepared)  # else it is seeded when the function imports it
    assert first == again == {'of_numpy': numpy.random.RandomState(7).random_sample(),
                              'of_python': random.Random(7).random()}
    assert all(first[name] != other[name] for name in ('of_numpy', 'of_python'))


@pytest.mark.parametrize('text, printed, told', [
    ('/worker crashed at 7 s', 'Exception in thread Thread-1:\nTraceback:\nValueError: no way\n',
     '/worker crashed at 7 s; worker: ValueError: no way'),
    ('ValueError: no way', 'Traceback (most recent call last):\nValueError: no way\n', 'ValueError: no way'),
    ('it ended', 'Exception in thread [INFO] /worker: the run is over\n', 'it ended')])
def test_the_line_of_an_error_has_what_a_node_printed_of_it_once(tmp_path, text, printed, told):
    (tmp_path / 'worker.txt').write_text(printed)
    assert execution._first_line(text, run_folders.Folders(str(tmp_path), str(tmp_path), str(tmp_path))) == told
