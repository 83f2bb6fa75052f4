"""How far an experiment is, read from its folder alone."""
import time

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown_text

from .. import records
from ..carrying import workers
from ..trials import trial

_MOST_SHOWN = 10


def lines(path):
    """Yield what `experiment status` says. :raises ConfigurationError: if the folder is none of an experiment."""
    plan = records.read_plan(path)
    found, damaged = _read(path, plan)
    complete = [about for about in found if about['status'] == trial.COMPLETE]
    failed = [about for about in found if about['status'] != trial.COMPLETE]
    total = len(plan['trials'])
    yield f"{shown_text(plan['experiment'])}: {len(complete)} of {total} trials complete, {len(failed)} failed, " \
          f'{total - len(found) - len(damaged)} missing' + (f', {len(damaged)} not to be read' if damaged else '')
    twice = [about['verified'] for about in found if about['verified'] is not None]
    if twice:
        yield f'run twice: {twice.count(trial.IDENTICAL)} identical, {twice.count(trial.DIFFERENT)} different'
    labelled = sum(bool(about['labels']) for about in complete)
    if labelled:
        yield f'not called repeatable: {labelled}'
    kept = sum(bool(one.get('kept')) for one in plan['trials'])
    if kept:
        yield f'kept of another program: {kept}'
    crashed = sum(bool(about.get('crashes')) for about in found)
    if crashed:
        yield f'a node crashed in {crashed} trials'
    yield from _first([f"failed: {about['id']} {shown_text(about['configuration'])} replication "
                       f"{about['replication']}: {_line(about['error'])}" for about in failed])
    try:
        yield from workers.lines(path, time.time())
    except ConfigurationError as problem:
        yield _line(problem)
    yield from _first([f'not to be read: {_line(problem)}' for problem in damaged])


def _read(path, plan):
    """Return what the trials that are there say, and why others cannot be read."""
    found, damaged = [], []
    for one in plan['trials']:
        try:
            about = records.read_planned(path, one)
        except ConfigurationError as problem:
            damaged.append(str(problem))
        else:
            found += [about] if about is not None else []
    return found, damaged


def _first(texts):
    yield from texts[:_MOST_SHOWN]
    if len(texts) > _MOST_SHOWN:
        yield f'... and {len(texts) - _MOST_SHOWN} more'


def _line(text):
    """Return a text as one line that any terminal can show."""
    return ''.join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in str(text)[:1000])
