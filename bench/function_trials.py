"""Measures the cost of trials that are functions, up to their table and report: time and memory of client and workers.

Slopes compare an experiment with one that has ten times as many trials, so that the cost of a single start drops out.
"""
import json
import os
import re
import subprocess
import time

import cpu
import psutil

from move_base_abstract_ros.loopback import find_executable

FACTOR = 10  # trials of the large experiment for each trial of the small one
PARTS = tuple(tenth / 10 for tenth in range(1, 11))  # parts of the trials after which memory is read
_MODULE = """import random


def run(trial):
    source = random.Random(trial.seed)
    return {'cost': source.gauss(10.0, 2.0) + (trial.configuration['rule'] == 'second'), 'steps': source.randrange(9)}
"""
_SPEC = {'experiment': 'many', 'function': 'many:run',
         'factors': {'rule': ['first', 'second'], 'size': [1, 2, 3, 4, 5]},
         'metrics': {'columns': {'cost': {'unit': 's', 'better': 'lower'}, 'steps': {}}}}
_COUNTED = re.compile(r'(\d+) of (\d+) trials')
_MB = 2 ** 20


def measure(folder, count, workers):
    """Run ``count`` trials in a folder on ``workers`` workers; return a record with times in wall s and CPU s."""
    with open(os.path.join(folder, 'many.py'), 'w', encoding='utf-8') as stream:
        stream.write(_MODULE)
    file, out = os.path.join(folder, f'many_{count}.yaml'), os.path.join(folder, f'many_{count}')
    with open(file, 'w', encoding='utf-8') as stream:
        json.dump({**_SPEC, 'replications': max(1, count // 10)}, stream)  # JSON is YAML
    words = [find_executable('experiment'), 'run', file, '-o', out, '--workers', str(workers)]
    begin = time.monotonic()
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        seen = _Seen(process.pid, begin)
        for line in process.stdout:
            seen.take(line)
    if process.returncode:
        raise RuntimeError(f'{words[0]} ended with code {process.returncode}')
    return seen.record(max(1, count // 10) * 10, workers)


class _Seen:
    """Watches an experiment while it runs: its times, CPU times and memory."""

    def __init__(self, pid, begin):
        self._client = psutil.Process(pid)
        self._begin = begin
        self._marks = {}  # {mark: (wall s, CPU s of the client, CPU s of the workers)}
        self._memory = {}  # {part: (MB of the client, MB of the largest worker with its child processes)}

    def take(self, line):
        """Read a line of the command's output, and note the times and sizes that belong to it."""
        if line.startswith('experiment: Dask scheduler'):
            self._mark('begun')
        counted = _COUNTED.search(line)
        if line.startswith('table: '):
            self._mark('table')
        elif line.startswith('report: '):
            self._mark('report')
        elif counted and 'complete' not in line:
            done = int(counted.group(1)) / int(counted.group(2))
            for part in PARTS:
                if done >= part and part not in self._memory:
                    self._memory[part] = self._sizes()
            if done == 1.0:
                self._mark('ended')

    def _mark(self, what):
        self._marks[what] = (time.monotonic() - self._begin, _cpu_s(self._client), sum(
            cpu.of_family(one.pid) for one in self._workers()))

    def _workers(self):
        try:
            return [one for one in self._client.children() if 'spawn_main' in ' '.join(one.cmdline())]
        except psutil.Error:
            return []

    def _sizes(self):
        workers = [sum(map(_mb, [one, *one.children(recursive=True)])) for one in self._workers()]
        return round(_mb(self._client)), round(max(workers, default=0.0))

    def record(self, count, workers):
        """Return the record of ``count`` trials."""
        begun, ended, table, report = (self._marks[name] for name in ('begun', 'ended', 'table', 'report'))
        return {'trials': count, 'workers': workers, 'plan_s': round(begun[0], 1), 'plan_cpu_s': round(begun[1], 1),
                'trials_s': round(ended[0] - begun[0], 1), 'client_cpu_s': round(ended[1] - begun[1], 1),
                'workers_cpu_s': round(ended[2], 1), 'table_s': round(table[0] - ended[0], 1),
                'table_cpu_s': round(table[1] - ended[1], 1), 'report_s': round(report[0] - table[0], 1),
                'report_cpu_s': round(report[1] - table[1], 1),
                **{f'{name}_mb_at_{100 * part:.0f}': sizes[place] for part, sizes in sorted(self._memory.items())
                   for place, name in enumerate(('client', 'worker'))}}


def _cpu_s(process):
    """Return the CPU time of a process alone [s]."""
    try:
        return sum(process.cpu_times()[:2])
    except psutil.Error:
        return 0.0


def _mb(process):
    try:
        return process.memory_info().rss / _MB
    except psutil.Error:
        return 0.0


def slopes(small, large):
    """Return the cost of each additional trial [ms, kB], and the CPU time of a million trials [h]."""
    more = large['trials'] - small['trials']
    each = {key: (large[key] - small[key]) / more for key in (
        'plan_cpu_s', 'client_cpu_s', 'workers_cpu_s', 'table_cpu_s', 'report_cpu_s', 'trials_s')}
    memory = (large['client_mb_at_100'] - small['client_mb_at_100']) / more
    return {**{f'{key[:-2]}_ms_each': round(1000.0 * value, 3) for key, value in each.items()},
            'client_kb_each': round(1024.0 * memory, 2),
            'million_cpu_h_of_workers': round(1e6 * each['workers_cpu_s'] / 3600.0, 2),
            'million_cpu_h_of_client': round(1e6 * sum(each[key] for key in (
                'plan_cpu_s', 'client_cpu_s', 'table_cpu_s', 'report_cpu_s')) / 3600.0, 2),
            'workers_that_one_client_keeps_busy': round(each['workers_cpu_s'] / max(1e-6, each['client_cpu_s']), 1)}
