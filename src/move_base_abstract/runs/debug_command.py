"""The command that leads into the debugger before a fault. All that tell of faults print it."""
from __future__ import annotations

import itertools
import os
from typing import Iterable, List, Optional, Sequence

from ..common.shown import pasted
from ..common.units import exact_seconds
from . import event_log, run_file

_BEFORE_NS = 10 ** 8  # of simulated time, between the place to which the command leads and the fault
_START_NS = 10 ** 9  # simulated time begins at 1 s


def of_run(words: Sequence[str], faults: Iterable[Optional[int]] = ()) -> str:
    """Return the command that leads to 0.1 s before the first of the ``faults`` [ns, None: unknown], else to the start.

    ``words``: options of lockstep_launch and its launch file; or ['--log', the path of an event log].
    """
    known = [fault for fault in faults if fault is not None]
    wanted = min(known) - _BEFORE_NS if known else 0
    return _typed(words, ['--at', seconds(wanted)] if wanted > _START_NS else [])


def of_log(path: str, faults: Iterable[Optional[int]] = ()) -> str:
    """Return the same for the run of an event log; '' if no file beside the log says what started its run."""
    return of_run(['--log', path], faults) if has_start(path) else ''


def of_instant(path: str, instant_ns: int) -> str:
    """Return the command that leads to the row of an event log before those of an instant [ns]; or '', as of_log()."""
    if not has_start(path):
        return ''
    with event_log.opened(path) as log:
        count = sum(1 for _ in itertools.takewhile(lambda row: row.time_ns < instant_ns, log.rows()))
    return _typed(['--log', path], ['--row', str(count)] if count else [])


def has_start(path: str) -> bool:
    """Return whether a file beside the event log says what started its run."""
    return os.path.isfile(path + run_file.SUFFIX)


def _typed(words: Sequence[str], where: List[str]) -> str:
    return 'rosrun move_base_abstract ' + pasted('debug', *words, *where)


def seconds(time_ns: int) -> str:
    """Return a time [ns] in seconds, exactly and without zeros at the end: '41.2'."""
    return exact_seconds(time_ns).rstrip('0').rstrip('.')
