"""Scenarios: runs whose results must be equal, to the byte, whatever else the machine does.

By day each scenario runs once. By night (test/night.py) it runs NIGHT times, each time under another condition, and all
results must be those of the first run. What ran, and whether it was equal, is noted for the table of `make nightly`.

    runs = repeated('two clerks', lambda condition: run_programs(..., condition=condition), lambda run: run.log)
"""
import hashlib
import itertools
import json
import os
import random
import threading
import time
from contextlib import contextmanager
from typing import NamedTuple

import psutil
from night import runs_of_a_scenario

from move_base_abstract_ros.launching.conditions import busy
from move_base_abstract_ros.lockstep.participation.report_delays import VARIABLE as DELAY

#: environment variable: the file to which a line of JSON is added for each run of a scenario
RECORD = 'SCENARIOS'
ALL_CORES = os.cpu_count()
_LONGEST_STOP, _LONGEST_GO = 0.15, 0.1  # s, wall
_LONGEST_DELAY = 4  # ms, wall; dense systems report a hundred thousand times


class Condition(NamedTuple):
    """How a scenario is started, and what else happens on the machine while it runs."""

    name: str = 'idle'
    load: int = 0  # number of cores that are kept busy
    is_warm: bool = True  # whether processes are forks; otherwise each starts anew
    speed_limit: float = 0.0  # simulated s per wall s; 0: none
    stops: int = 0  # seed of the instants at which processes are stopped; 0: never
    delays: int = 0  # seed of the delays before reports; 0: none

    @property
    def clock(self):
        """The parameters of the time master."""
        return {'speed_limit': self.speed_limit} if self.speed_limit else {}

    @property
    def options(self):
        """The same as options of lockstep_launch."""
        return ['--speed-limit', str(self.speed_limit)] if self.speed_limit else []

    @contextmanager
    def around(self):
        """Give a context in which the machine is like that. Processes that this process started before go on."""
        before = {process.pid for process in psutil.Process().children(recursive=True)}
        over = threading.Event()
        if self.delays:
            os.environ[DELAY] = '{}:{}'.format(self.delays, _LONGEST_DELAY)
        with busy(self.load):
            if self.stops:
                stopper = threading.Thread(target=_stop_now_and_then, args=(self.stops, before, over))
                stopper.start()
            try:
                yield
            finally:
                os.environ.pop(DELAY, None)
                if self.stops:
                    over.set()
                    stopper.join()


def conditions():
    """Yield the conditions under which each scenario runs: one by day, NIGHT by night."""
    kinds = itertools.cycle((
        lambda number: Condition(),
        lambda number: Condition('all cores busy', load=ALL_CORES),
        lambda number: Condition('cold, at 50 times', is_warm=False, speed_limit=50.0),
        lambda number: Condition('stopped now and then', stops=number),
        lambda number: Condition('late reports, one core busy', load=1, delays=number)))
    for number, kind in zip(range(1, 1 + runs_of_a_scenario()), kinds):
        yield kind(number)


def repeated(name, run, data_of):
    """Run a scenario under each condition; return the results of ``run(condition)``.

    :param name: what the scenario is called in the table, after its file.
    :param data_of: what must be equal, as bytes, of a result. The test compares it in the way that shows best where it
        differs.
    """
    runs = []
    for condition in conditions():
        began = time.monotonic()
        runs.append(run(condition))
        seconds = time.monotonic() - began
        _note(name, condition, seconds, data_of(runs[0]), data_of(runs[-1]))
    return runs


def _note(name, condition, seconds, first, data):
    path = os.environ.get(RECORD)
    if path:
        file = os.environ['PYTEST_CURRENT_TEST'].partition('::')[0].rpartition('/')[2]
        row = {'scenario': '{}: {}'.format(file[len('test_'):-len('.py')], name), 'condition': condition.name,
               'seconds': round(seconds, 3), 'equal': data == first, 'sha256': hashlib.sha256(data).hexdigest()}
        with open(path, 'a', encoding='utf-8') as stream:
            stream.write(json.dumps(row) + '\n')


def _stop_now_and_then(seed, spared, over):
    """Stop one descendant after another for a while, until ``over`` is set. What is stopped goes on in any case."""
    chance = random.Random(seed)
    while not over.wait(chance.uniform(0.0, _LONGEST_GO)):
        there = sorted((one for one in psutil.Process().children(recursive=True) if one.pid not in spared),
                       key=lambda one: one.pid)
        if there:
            try:
                child = chance.choice(there)
                child.suspend()
                over.wait(chance.uniform(0.0, _LONGEST_STOP))
                child.resume()
            except psutil.NoSuchProcess:
                pass
