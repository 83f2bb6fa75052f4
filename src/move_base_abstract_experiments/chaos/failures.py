"""Find what is wrong with a run: one Failure, or none. To add a kind of failure, add a row to KINDS."""
from __future__ import annotations

from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence

from move_base_abstract.faults.buggify import GOES_WRONG
from move_base_abstract.properties import Judgement, judge_log, statements
from move_base_abstract.runs import event_log
from move_base_abstract.runs.built_in import ALL, BUILT_IN
from move_base_abstract.runs.trace import TraceEntry

from ..records import Result

#: the built-in properties that fail under their own name, unless a kind before says more; kinds have the others
PROPERTIES = tuple(name for name in BUILT_IN if name not in ('no_crash', 'no_exception', 'no_zero_delay_loop'))


class Failure(NamedTuple):
    """A property that failed. ``name``: equal in all runs that fail in this way; ``text``: what happened, and when.

    ``instant_ns``: when [ns, simulated], None: unknown.
    """

    name: str
    text: str
    instant_ns: Optional[int] = None


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
        read = event_log.of_bytes(log, 'events.jsonl')
        judged = judge_log(read, (), properties,
                           hear=lambda row: events.append(row) if row.kind in GOES_WRONG else None)
        end = read.end or {}
    return Evidence(result, events, end, judged)


def _broken_properties(run: Evidence) -> Iterator[Failure]:
    """Yield the broken statements of nodes; the text of a statement is the name of its Failure."""
    for one in run.judged.broken:
        if one.property in statements.KINDS:
            yield Failure(one.text, f'{one.property}: {one.text}, said by {one.node}{_at(one.instant_ns or 0)}'
                          + (f': {", ".join(one.details)}' if one.details else ''), one.instant_ns)


def _crashes(run: Evidence) -> Iterator[Failure]:
    """Yield the crashes: a node ended by a signal or with an exit code other than 0, or had an uncaught exception."""
    instants = {one['node']: one['at'] for one in run.result.ends if one['crashed']}
    for text in run.result.crashes:
        node = text.split(' ')[0]
        at = instants.get(node)  # s
        yield Failure(f'crash {node}', text, None if at is None else round(at * 1e9))


def _ended_by(name: str) -> Callable[[Evidence], Iterator[Failure]]:
    """Return what yields a Failure of this name if the end record says that the run was ended by that."""
    def find(run: Evidence) -> Iterator[Failure]:
        if run.end.get('ended_by') == name:
            yield Failure(name, str(run.end.get('reason', '')), run.end.get('at_ns'))
    return find


def _built_in(run: Evidence) -> Iterator[Failure]:
    """Yield the broken built-in properties: robots that wait for each other, goals that never end, overfull places."""
    for one in run.judged.broken:
        if one.property in PROPERTIES:
            yield Failure(one.property, one.words(), one.instant_ns)


def _unfinished(run: Evidence) -> Iterator[Failure]:
    """Yield a Failure if the run did not come to its end."""
    if not run.result.is_complete:
        yield Failure('unfinished', str(run.result.error), run.end.get('at_ns'))


class Kind(NamedTuple):
    """A kind of failures: the ``names`` that they have or begin with, and when they come, for the page."""

    names: Sequence[str]
    when: str
    find: Callable[[Evidence], Iterator[Failure]]


#: in the order in which they are looked for
KINDS = (
    Kind((), "a node's [`always` or `never_again`](properties.md) is broken", _broken_properties),
    Kind(('crash',), 'a node [crashed](lockstep_launch.md#crashes); the name of the node follows', _crashes),
    Kind(('deadlock',), 'no participant wants to wake up, and one of them waits for something that is '
         '[owed](lockstep.md#idle-and-deadlock) to it', _ended_by('deadlock')),
    Kind(('zero_delay_loop',), 'there are too many rounds at one instant', _ended_by('zero_delay_loop')),
    Kind(PROPERTIES, 'one of these [properties](properties.md) is broken', _built_in),
    Kind(('unfinished',), 'the run did not come to its end: it took more than 120 s of wall time, or could not go on',
         _unfinished),
)
#: the names of failures, without those of statements
NAMES = [name for kind in KINDS for name in kind.names]


def of_run(run: Evidence, wanted: Sequence[str] = ()) -> Optional[Failure]:
    """Return the first Failure of a run, or None.

    wanted: the names that count, or their first words; empty: all count.
    """
    for kind in KINDS:
        for failure in kind.find(run):
            if not wanted or any(is_meant(failure.name, name) for name in wanted):
                return failure
    return None


def is_meant(name: str, wanted: str) -> bool:
    """Return whether a Failure of this name is meant by ``wanted``: its name, or its first words."""
    return name == wanted or name.startswith(wanted + ' ')


def _at(time_ns: int) -> str:
    return f' at {time_ns * 1e-9:.9g} s'
