"""Which properties a run has broken, by its event log and the ends of its processes.

The built-in properties hold in every good run of any system: see BUILT_IN of :mod:`..lockstep.property_names`. The
properties of nodes are their :mod:`.statements`. A property is broken only if the log shows it: for example, a run that
was ended at an instant may have open goals.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from ..lockstep.property_names import ALL, BUILT_IN, SOMETIMES
from ..runs import ends, event_log
from ..runs.event_log import EventLog
from ..runs.story import Story
from ..runs.trace import TraceEntry
from . import statements

_STANDSTILLS = {'deadlock': 'no_standstill', 'zero_delay_loop': 'no_zero_delay_loop'}
_QUIET = ('idle', 'deadlock')  # values of ended_by after which nothing could have ended a goal any more
_OF_THE_RUN = 'the run'


class Broken(NamedTuple):
    """A property that a run has broken: one of BUILT_IN, or 'always' or 'never_again' for a statement of a node."""

    property: str
    instant_ns: Optional[int]  # ns, simulated; None: unknown
    node: str  # or the robot
    text: str
    details: Tuple[str, ...] = ()

    def words(self) -> str:
        """Return a line of text with all fields."""
        when = '' if self.instant_ns is None else 'at {:.9f} s, '.format(self.instant_ns * 1e-9)
        more = ' ({})'.format(', '.join(self.details)) if self.details else ''
        return '{}: {}{}: {}{}'.format(self.property, when, self.node, self.text, more)

    def told(self) -> Dict[str, Any]:
        """Return everything as plain values, for files."""
        return {**self._asdict(), 'details': list(self.details), 'words': self.words()}

    def key(self) -> Tuple[str, ...]:
        """Return the key of the property: the name of a built-in one; for a statement its node and text, too."""
        return (self.property,) if self.property in BUILT_IN else (self.property, self.node, self.text)


class Run(NamedTuple):
    """A run that is over: the path of its event log, and the ends of its processes, if they are known."""

    log: str
    processes: Sequence[ends.End] = ()


class Judgement(NamedTuple):
    """The result for a run.

    ``broken``: the broken properties in the order of their instants; ``statements``: {(node, kind, text): STATED,
    BROKEN or HELD}.
    """

    broken: Tuple[Broken, ...]
    statements: Dict[Tuple[str, str, str], str]

    def chosen(self, names: Sequence[str]) -> Tuple[Broken, ...]:
        """Return the broken properties with these ``names``, which are of NAMES in lockstep.property_names."""
        return self.broken if ALL in names else tuple(one for one in self.broken if one.property in names)

    def never_held(self) -> List[Tuple[str, str]]:
        """Return (node, text) of each ``sometimes`` that never held in this run."""
        return [(node, text) for (node, kind, text), outcome in self.statements.items()
                if kind == SOMETIMES and outcome != statements.HELD]

    def told(self) -> Dict[str, Any]:
        """Return everything as plain values, for files."""
        return {'broken': [one.told() for one in self.broken],
                'statements': [[*key, outcome] for key, outcome in self.statements.items()]}


def judge(run: Run) -> List[Broken]:
    """Return the properties that a run has broken, by their instants. :raises EventLogError: if its log is none."""
    return list(judgement_on(run).broken)


def judgement_on(run: Run) -> Judgement:
    """Return the whole Judgement on a run. :raises EventLogError: if its log is none."""
    with event_log.opened(run.log) as log:
        return judge_log(log, run.processes)


def judge_log(log: EventLog, processes: Sequence[ends.End] = (),
              hear: Callable[[TraceEntry], object] = lambda _row: None) -> Judgement:
    """Return the Judgement on a run by its EventLog, which is read to the end, and the ends of its processes.

    ``hear`` is called with each row.
    """
    story, told, found = Story(log.start_ns), ends.Log(), []
    stated: Dict[Tuple[str, str, str], str] = {}
    for row in log.rows():
        hear(row)
        told.take(row)
        story.take(*row)
        made = statements.read_row(row.values) if row.kind == statements.ROW else None
        if made is not None:
            stated[row.robot, made.kind, made.text] = made.outcome
            if made.outcome == statements.BROKEN:
                found.append(Broken(made.kind, row.time_ns, row.robot, made.text, made.details))
    end = log.end or {}
    found += [*_of_robots(story), *_of_the_end(end)]
    if end.get('ended_by') in _QUIET:
        found += _open_goals(end, story)
    if not processes:  # they were not looked at, but the log names those that died
        told.end(end)
        processes = ends.judge((), told)
    found += _of_processes(processes, told)
    in_order = sorted(found, key=lambda one: (one.instant_ns is None, one.instant_ns or 0, one.property, one.node,
                                              one.text))
    return Judgement(tuple(in_order), stated)


def _of_robots(story: Story) -> Iterator[Broken]:
    """Yield what the rows of robots have broken, but for goals that never end."""
    for one in story.overfull:
        yield Broken('capacities_kept', one.time_ns, one.robot, 'it {} {}, which has room for {}'.format(
            'works at' if one.works else 'came into', one.where, one.room), one.robots)
    for time_ns, robot in story.emptied:
        yield Broken('charged', time_ns, robot, 'its battery is empty')
    for time_ns, robot, circle in story.circles:
        pairs = ', '.join('{} for {}'.format(*pair) for pair in zip(circle[::2], circle[1::2]))
        yield Broken('no_standstill', time_ns, robot, 'robots wait for each other, to the end of the run', (pairs,))


def _open_goals(end: Dict[str, Any], story: Story) -> Iterator[Broken]:
    """Yield the goals for which clients still wait, whichever node was to do them, and goals and tasks of robots."""
    texts = []
    for one in end.get('open_goals', []):
        texts.append('{} of its goals never {} on {}'.format(
            one['count'], 'ends' if one['count'] == 1 else 'end', one['action']))
        yield Broken('every_goal_ends', end.get('at_ns'), str(one['client']), texts[-1])
    for robot in story.robots.values():
        since_ns = robot.begun('goal')
        if since_ns is not None and not any(robot.name in text for text in texts):  # each goal is reported once
            yield Broken('every_goal_ends', since_ns, robot.name, 'the goal to which it departed then never ends')
    for name, task, since_ns in story.open_tasks():
        yield Broken('every_goal_ends', since_ns, name, 'the task that it got then never ends', (str(task),))


def _of_processes(processes: Iterable[ends.End], log: ends.Log) -> Iterable[Broken]:
    """Yield exceptions that were not caught, and crashes. Such an exception is not reported as a crash, too."""
    for node, told in log.uncaught.items():
        yield Broken('no_exception', told[0][0], node, told[0][1])
    for one in processes:
        is_told = one.node in log.uncaught and one.code in (None, 0, 1)  # 1: Python's exit code after an exception
        if one.crash is not None and not is_told:
            yield Broken('no_crash', one.time_ns, one.node, one.crash)


def _of_the_end(end: Dict[str, Any]) -> Iterable[Broken]:
    name = _STANDSTILLS.get(end.get('ended_by', ''))
    if name is not None:
        yield Broken(name, end.get('at_ns'), _OF_THE_RUN, str(end.get('reason', '')))
