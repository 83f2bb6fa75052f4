"""Trials that share a process (isolation: batch): what one leaves behind reaches no other."""
import json
import os
import subprocess
import sys

MODEL = """
import os, random, sys, threading, time

import numpy

told = {'count': 0}
number = 0
source = random.Random(5)


class Robot:
    count = 0


def kept(value, before=[]):
    before.append(value)
    return len(before)


def run(trial):
    global number
    kind = trial.configuration['kind']
    told['count'] += kind == 'container'
    number += kind == 'number'
    Robot.count += kind == 'class'
    kept(1) if kind == 'default' else None
    source.random() if kind == 'object' else None
    if kind == 'thread':
        threading.Thread(target=time.sleep, args=(600,), daemon=True).start()
    if kind == 'child' and os.fork() == 0:
        time.sleep(600)
    if kind == 'file':
        sys.modules['json'].kept_open = open(os.devnull)
    if kind == 'environment':
        os.environ['LEFT'] = 'behind'
    if kind == 'memory':
        sys.modules['json'].kept_memory = bytes(range(256)) * 400000
    if kind == 'raises':
        raise ValueError('no')
    if kind == 'exits':
        os._exit(3)
    if kind == 'hangs':
        time.sleep(600)
    assert os.getcwd() == str(trial.files) and not os.listdir()
    print('said', trial.seed)
    return {'pid': os.getpid(), 'left': told['count'] + number + Robot.count + len(kept.__defaults__[0])
            + (source.getstate() != random.Random(5).getstate()) + ('LEFT' in os.environ),
            'of_numpy': numpy.random.random(), 'of_python': random.random()}
"""
TRIALS = """
import json, os, sys
from experiment_jobs import job_of
from move_base_abstract.common.errors import SimulatorError
from move_base_abstract_experiments.trials import functions, run_folders, series

folder, kinds = sys.argv[1], sys.argv[2:]
for number, kind in enumerate(kinds):
    folders = run_folders.make_folders(os.path.join(folder, str(number)))
    job = job_of({'experiment': 'x', 'function': 'model:run', 'isolation': 'batch', 'time_limit': 1.0,
                  'factors': {'kind': ['a']}}, modules=folder, seed=number, configuration={'kind': kind})
    try:
        run = functions.run_trial if kind == 'alone' else series.run
        print(json.dumps(run(job, folders).metrics))
    except SimulatorError as problem:
        print(json.dumps({'problem': str(problem), 'code': getattr(problem, 'code', None)}))
"""


def run(tmp_path, *kinds):
    """Return what each trial gave, of the ``kinds`` one after another; in a Python of its own: it forks."""
    tmp_path.mkdir(exist_ok=True)
    (tmp_path / 'model.py').write_text(MODEL)
    environment = {**os.environ, 'OPENBLAS_NUM_THREADS': '1', 'OMP_NUM_THREADS': '1',
                   'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    said = subprocess.run([sys.executable, '-c', TRIALS, str(tmp_path), *kinds], timeout=60, check=True,
                          env=environment, stdout=subprocess.PIPE, text=True).stdout
    return [json.loads(line) for line in said.splitlines()]


def test_trials_share_a_process_and_are_as_they_are_alone(tmp_path):
    first, second, third, alone = run(tmp_path, 'plain', 'plain', 'plain', 'alone')
    assert first['pid'] == second['pid'] == third['pid'] != alone['pid']
    assert first['left'] == second['left'] == third['left'] == 0
    assert (tmp_path / '1' / 'logs' / 'function.txt').read_text() == 'said 1\n'
    other, = run(tmp_path / 'other', 'alone')
    assert {**other, 'pid': 0} == {**first, 'pid': 0}


def test_a_trial_that_leaves_something_behind_is_the_last_of_its_process(tmp_path):
    kinds = ['container', 'number', 'class', 'default', 'object', 'thread', 'child', 'file', 'environment', 'memory']
    found = run(tmp_path, *(word for kind in kinds for word in ('plain', kind)), 'plain')
    for kind, before, leaves, after in zip(kinds, found[::2], found[1::2], found[2::2]):
        assert (kind, before['pid']) == (kind, leaves['pid'])
        assert after['pid'] != leaves['pid'], kind
        assert after['left'] == 0, kind


def test_a_trial_that_fails_costs_no_other(tmp_path):
    first, raises, second, exits, third, hangs, fourth = run(
        tmp_path, 'plain', 'raises', 'plain', 'exits', 'plain', 'hangs', 'plain')
    assert [one['problem'] for one in (raises, exits, hangs)] == [
        'ValueError: no', 'its process ended without a result: exit code 3',
        'it was not over after 1 s of wall time']
    assert [one['code'] for one in (raises, exits, hangs)] == [None, 3, None]
    assert len({one['pid'] for one in (first, second, third, fourth)}) == 4
    assert 'ValueError: no' in (tmp_path / '1' / 'logs' / 'function.txt').read_text()
