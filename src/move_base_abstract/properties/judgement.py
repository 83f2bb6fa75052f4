"""Which properties a run has broken, by its event log and the ends of its processes.

The built-in properties are a table, :mod:`..runs.built_in`; those of nodes are their :mod:`.statements`. A property is
broken only if the log shows it: for example, a run that was ended at an instant may have open goals.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, List, NamedTuple, Sequence, Tuple

from ..runs import built_in, ends, event_log
from ..runs.built_in import ALL, SOMETIMES, Broken, Facts
from ..runs.event_log import EventLog
from ..runs.story import Story
from ..runs.trace import TraceEntry
from . import statements


class Run(NamedTuple):
    """A run that is over: the path of its event log, and the ends of its processes, if they are known.

    ``properties``: those that it must keep, of :data:`..runs.built_in.KIND`; ``allowed``: of these, names of those that
    it may break.
    """

    log: str
    processes: Sequence[ends.End] = ()
    properties: Sequence[str] = (ALL,)
    allowed: Sequence[str] = ()


class Judgement(NamedTuple):
    """The result for a run.

    ``broken``: the broken properties in the order of their instants; ``statements``: {(node, kind, text): STATED,
    BROKEN or HELD}; ``judged``: the names of the properties by which it was judged, none if it never ran.
    """

    broken: Tuple[Broken, ...] = ()
    statements: Dict[Tuple[str, str, str], str] = {}
    judged: Tuple[str, ...] = ()

    def never_held(self) -> List[Tuple[str, str]]:
        """Return (node, text) of each ``sometimes`` that never held in this run."""
        return [(node, text) for (node, kind, text), outcome in self.statements.items()
                if kind == SOMETIMES and outcome != statements.HELD]

    def told(self) -> Dict[str, Any]:
        """Return everything as plain values, for files."""
        return {'judged': list(self.judged), 'broken': [one.told() for one in self.broken],
                'statements': [[*key, outcome] for key, outcome in self.statements.items()]}


def judge(run: Run) -> List[Broken]:
    """Return the properties that a run has broken, by their instants. :raises EventLogError: if its log is none."""
    return list(judgement_on(run).broken)


def judgement_on(run: Run) -> Judgement:
    """Return the whole Judgement on a run. :raises EventLogError: if its log is none."""
    with event_log.opened(run.log) as log:
        return judge_log(log, run.processes, run.properties, run.allowed)


def judge_log(log: EventLog, processes: Sequence[ends.End] = (), properties: Sequence[str] = (ALL,),
              allowed: Sequence[str] = (), hear: Callable[[TraceEntry], object] = lambda _row: None) -> Judgement:
    """Return the Judgement on a run by its EventLog, which is read to the end, and the ends of its processes.

    ``properties``, ``allowed``: those of a Run. ``hear`` is called with each row.
    """
    asked = {name: number for name, number in built_in.chosen(properties).items() if name not in allowed}
    story, told, found = Story(log.start_ns, keeps_spans=True), ends.Log(), []
    stated: Dict[Tuple[str, str, str], str] = {}
    for row in log.rows():
        hear(row)
        told.take(row)
        story.take(*row)
        made = statements.read_row(row.values) if row.kind == statements.ROW else None
        if made is not None:
            stated[row.robot, made.kind, made.text] = made.outcome
            if made.outcome == statements.BROKEN and made.kind in asked:
                found.append(Broken(made.kind, row.time_ns, row.robot, made.text, made.details))
    end = log.end or {}
    story.close(end.get('at_ns'))
    if not processes:  # they were not looked at, but the log names those that died
        told.end(end)
        processes = ends.judge((), told)
    found += built_in.judge(Facts(story, end, told, processes, asked))
    in_order = sorted(found, key=lambda one: (one.instant_ns is None, one.instant_ns or 0, one.property, one.node,
                                              one.text))
    # Told to end before time had started, or without an end: nothing that is not broken was kept.
    has_run = log.end is not None and (end.get('ended_by'), end.get('at_ns')) != ('other', log.start_ns)
    return Judgement(tuple(in_order), stated, tuple(asked) if has_run else ())
