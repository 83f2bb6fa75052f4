"""The user's function of a trial: `module:function`, called with what a trial has left, returns numbers by name.

It runs in a process of its own that is no node, once the run is over. An exception in it, or a time limit, is told in
the table and stops nothing.
"""
import contextlib
import importlib
import json
import math
import os
import re
import select
import signal
import sys
from pathlib import Path

from move_base_abstract import event_log
from move_base_abstract.event_log import EventLog

from . import processes, run

_LIMIT_S = 120.0  # wall
_MOST_BYTES = 1 << 20
_MOST_METRICS = 200
_NAME = re.compile(r'[A-Za-z]\w{0,63}\Z', re.ASCII)


class TrialData:
    """What the function is given.

    configuration: {factor: value}; replication, seed: whole numbers; folder: a Path, with events.jsonl and
    messages.jsonl; files: a Path, where the nodes have left files; built_in: the built-in metrics; robots: {name:
    {goals, distance_m, moving_s, idle_s, waiting_s}}; simulated_seconds.
    """

    def __init__(self, folder, files, about):
        self.folder = Path(folder)
        self.files = Path(files)
        self.configuration = about['configuration']
        self.replication = about['replication']
        self.seed = about['seed']
        self.built_in = about['metrics']
        self.robots = about['robots']
        self.simulated_seconds = about['simulated_seconds']

    def events(self):
        """Yield (time_ns, robot, kind, values) of the event log."""
        path = str(self.folder / run.LOG)
        with event_log.open_text(path) as stream:
            for event in EventLog(stream, path):
                yield event.time_ns, event.robot, event.kind, json.loads(event.values)

    def messages(self, topic=None):
        """Yield (time_ns, topic, message) of what was recorded (record.messages), a message being a mapping."""
        path = self.folder / run.MESSAGES
        if path.exists():
            with open(path, encoding='utf-8') as stream:
                for line in stream:
                    record = json.loads(line)
                    if topic is None or record['topic'] == topic:
                        yield record['time_ns'], record['topic'], record['message']


def load(name, folder):
    """Return the function of a name module:function; modules beside the experiment's file are found, too."""
    if folder not in sys.path:
        sys.path.insert(0, folder)
    module, _, function = name.partition(':')
    found = getattr(importlib.import_module(module), function)
    if not callable(found):
        raise TypeError(f'{name} cannot be called')
    return found


def call(job, folders, about):
    """Return ({name: number or None}, what is wrong or None)."""
    read, write = os.pipe()

    def work():
        os.close(read)
        try:
            function = load(job['function'], job['folder'])
            answer = {'metrics': checked(function(TrialData(folders.own, folders.files, about)), job['factors'])}
        except BaseException as problem:
            text = str(problem).strip().splitlines()
            answer = {'problem': f'{type(problem).__name__}: {text[0] if text else ""}'}
        with os.fdopen(write, 'wb') as stream:
            stream.write(json.dumps(answer).encode())
    pid = processes.fork(work, os.path.join(folders.logs, 'metrics.txt'), folders.own)
    os.close(write)
    text = _read(read, _LIMIT_S)
    processes.end([pid], signal.SIGKILL, 1.0, {})
    processes.end_all_children()
    with contextlib.suppress(ValueError):
        answer = json.loads(text)
        return answer.get('metrics', {}), answer.get('problem')
    return {}, f'it did not come to its end within {_LIMIT_S:g} s, or its process died'


def checked(found, factors):
    """Return what a function gave, checked. :raises ValueError, TypeError: saying what is allowed."""
    from .metric_names import BUILT_IN
    from .spec import OWN_COLUMNS
    if not isinstance(found, dict) or len(found) > _MOST_METRICS:
        raise TypeError(f'must return a mapping of at most {_MOST_METRICS} numbers by name, got {type(found).__name__}')
    numbers = {}
    for name, given in found.items():
        if not isinstance(name, str) or not _NAME.match(name) or name in (*BUILT_IN, *OWN_COLUMNS, *factors):
            raise ValueError(f'{name!r} is no name for a metric: a letter, then letters, digits and underscores, not a '
                             'column of the table already')
        value = given.item() if hasattr(given, 'item') else given  # of numpy
        if value is not None and not isinstance(value, (bool, int, float)):
            raise TypeError(f'{name} must be a number or None, got {type(value).__name__}')
        is_none = isinstance(value, float) and not math.isfinite(value)
        numbers[name] = None if is_none else int(value) if isinstance(value, bool) else value
    return numbers


def _read(descriptor, seconds):
    import time
    pieces, deadline = [], time.monotonic() + seconds
    with os.fdopen(descriptor, 'rb', buffering=0) as stream:
        while sum(map(len, pieces)) < _MOST_BYTES:
            ready, _, _ = select.select([stream], [], [], max(0.0, deadline - time.monotonic()))
            piece = stream.read(1 << 16) if ready else b''
            if not piece:
                break
            pieces.append(piece)
    return b''.join(pieces)
