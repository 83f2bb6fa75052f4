"""The state of an experiment, read from its folder alone."""
from __future__ import annotations

import time
from typing import Iterator, List, Tuple

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import first_lines, printable, shown_text
from move_base_abstract.properties import Gathering

from .. import records
from ..carrying import workers
from ..records import DIFFERENT, IDENTICAL, Plan, Result
from .tables import Errors

_MOST_SHOWN = 10


def lines(path: str) -> Iterator[str]:
    """Yield the lines of `experiment status`. :raises ConfigurationError: if the folder is not one of an experiment."""
    plan = records.read_plan(path)
    found, damaged = _read(path, plan)
    complete = [one for one in found if one.is_complete]
    failed = [one for one in found if not one.is_complete]
    total = len(plan.trials)
    yield f'{shown_text(plan.experiment)}: {len(complete)} of {total} trials complete, {len(failed)} failed, ' \
          f'{total - len(found) - len(damaged)} missing' + (f', {len(damaged)} not to be read' if damaged else '')
    twice = [one.verified for one in found if one.verified is not None]
    if twice:
        yield f'run twice: {twice.count(IDENTICAL)} identical, {twice.count(DIFFERENT)} different'
    for what, count in (('not called repeatable: {}', sum(bool(one.labels) for one in complete)),
                        ('kept of another program: {}', sum(bool(one.kept) for one in plan.trials)),
                        ('a node crashed in {} trials', sum(bool(one.crashes) for one in found))):
        if count:
            yield what.format(count)
    gathered, errors = Gathering(), Errors()
    for one in complete:
        errors.take(one)
    for one in found:
        if one.properties:
            gathered.take(one.id, one.seed, one.properties)
    yield from first_lines([_line(line) for line in gathered.lines()], _MOST_SHOWN)
    yield from errors.lines(len(found))
    yield from first_lines([f'failed: {one.id} {shown_text(one.configuration)} replication {one.replication}: '
                            f'{_line(one.error)}' for one in failed], _MOST_SHOWN)
    try:
        yield from workers.lines(path, time.time())
    except ConfigurationError as problem:
        yield _line(problem)
    yield from first_lines([f'not to be read: {_line(problem)}' for problem in damaged], _MOST_SHOWN)


def _read(path: str, plan: Plan) -> Tuple[List[Result], List[str]]:
    """Return the Results of the trials that have ended, and the errors of those that cannot be read."""
    found, damaged = [], []
    for one in plan.trials:
        try:
            result = records.read_planned(path, plan, one)
        except ConfigurationError as problem:
            damaged.append(str(problem))
        else:
            found += [result] if result is not None else []
    return found, damaged


def _line(text: object) -> str:
    """Return a text as one line that any terminal can show."""
    return printable(str(text)[:1000])
