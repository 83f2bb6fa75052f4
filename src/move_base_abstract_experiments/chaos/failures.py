"""Find what is wrong with a run: one Failure, or none. To add a property, add a function to FINDERS."""
from __future__ import annotations

import io
import math
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence

from move_base_abstract.faults.buggify import CAUSE
from move_base_abstract.faults.lapse import JUMP, MUTE
from move_base_abstract.properties import Judgement, judge_log, statements
from move_base_abstract.runs.built_in import ALL, BUILT_IN
from move_base_abstract.runs.event_log import EventLog
from move_base_abstract.runs.trace import TraceEntry

from ..records import Result

#: the kinds of events in which something goes wrong with a robot, also on purpose by buggify
_GOES_WRONG = ('failed', 'lapse_began')
_BUGGIFIED = {'abort': 'gave its goal up', 'stall': 'stood still for a while', 'silent': 'said nothing for a while',
              MUTE: 'drove on without a pose or feedback for a while'}
#: the built-in properties that fail under their own name; the finders of crashes and standstills have the others
OF_ROBOTS = tuple(name for name in BUILT_IN if name not in (
    'no_crash', 'no_exception', 'no_standstill', 'no_zero_delay_loop'))
_STANDSTILLS = ('deadlock', 'zero_delay_loop')  # values of ended_by in the end record


class Failure(NamedTuple):
    """A property that failed. ``name``: equal in all runs that fail in this way; ``text``: what happened, and when."""

    name: str
    text: str


class Evidence(NamedTuple):
    """All that the finders need to know about a run.

    ``events``: the rows in which something goes wrong with a robot; ``end``: the log's end record, or {}; ``judged``:
    its properties.
    """

    result: Result
    events: List[TraceEntry]
    end: Dict[str, Any]
    judged: Judgement


def evidence_of(result: Result, log: Optional[bytes], properties: Sequence[str] = (ALL,)) -> Evidence:
    """Return the Evidence of a run. ``log``: the bytes of its event log, or None; ``properties``: those that count."""
    events: List[TraceEntry] = []
    end: Dict[str, Any] = {}
    judged = Judgement()
    if log is not None:
        text = log.decode('utf-8', 'surrogateescape')
        read = EventLog(io.StringIO(text, newline='\n'), 'events.jsonl')
        judged = judge_log(read, (), properties, lambda row: events.append(row) if row.kind in _GOES_WRONG else None)
        end = read.end or {}
    return Evidence(result, events, end, judged)


def buggified(run: Evidence) -> Iterator[Dict[str, Any]]:
    """Yield a decision for each robot that went wrong on purpose, in the form of those of chaos_decisions."""
    for event in run.events:
        values = event.values
        if len(values) >= 2 and str(values[1]).startswith(CAUSE):
            yield {'name': values[1][len(CAUSE):], 'time_ns': event.time_ns, 'what': 'buggify',
                   'says': f'{event.robot} {_words(values)}'}


def _words(values: List[Any]) -> str:
    """Return in words what went wrong with a robot, from the values of its event."""
    if values[0] == JUMP:
        x, y, yaw = values[2:]
        return f'took itself to be {math.hypot(x, y):.2f} m and {abs(yaw):.2f} rad beside where it was, for a while'
    return str(_BUGGIFIED.get(values[0], values[0]))


def _broken_properties(run: Evidence) -> Iterator[Failure]:
    """Yield the broken statements of nodes; the text of a statement is the name of its Failure."""
    for one in run.judged.broken:
        if one.property in statements.KINDS:
            yield Failure(one.text, f'{one.property}: {one.text}, said by {one.node}{_at(one.instant_ns or 0)}'
                          + (f': {", ".join(one.details)}' if one.details else ''))


def _crashes(run: Evidence) -> Iterator[Failure]:
    """Yield the crashes: a node ended by a signal or with an exit code other than 0, or had an uncaught exception."""
    for text in run.result.crashes:
        yield Failure(f'crash {text.split(" ")[0]}', text)


def _standstill(run: Evidence) -> Iterator[Failure]:
    """Yield a deadlock (a participant waits, but nothing happens any more) or a zero-delay loop (time stands still)."""
    if run.end.get('ended_by') in _STANDSTILLS:
        yield Failure(run.end['ended_by'], str(run.end.get('reason', '')))


def _of_robots(run: Evidence) -> Iterator[Failure]:
    """Yield the broken properties of robots: goals that never end, overfull places, empty batteries."""
    for one in run.judged.broken:
        if one.property in OF_ROBOTS:
            yield Failure(one.property, one.words())


def _unfinished(run: Evidence) -> Iterator[Failure]:
    """Yield a Failure if the run did not come to its end."""
    if not run.result.is_complete:
        yield Failure('unfinished', str(run.result.error))


FINDERS: Sequence[Callable[[Evidence], Iterator[Failure]]] = (
    _broken_properties, _crashes, _standstill, _of_robots, _unfinished)


def of_run(run: Evidence, wanted: Sequence[str] = ()) -> Optional[Failure]:
    """Return the first Failure of a run, or None.

    wanted: the names that count, or their first words; empty: all count.
    """
    for find in FINDERS:
        for failure in find(run):
            if not wanted or any(failure.name == name or failure.name.startswith(name + ' ') for name in wanted):
                return failure
    return None


def _at(time_ns: int) -> str:
    return f' at {time_ns * 1e-9:.9g} s'
