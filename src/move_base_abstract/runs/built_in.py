"""The built-in properties, which hold in every good run of any system: one row of BUILT_IN for each.

To add one, write a function that yields what has broken it, and a row. Options, schema, errors, reports and the table
in docs/properties.md come from the rows.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from ..common import kinds
from ..common.kinds import Kind
from . import ends
from .story import Story

ALWAYS, SOMETIMES, NEVER_AGAIN = 'always', 'sometimes', 'never_again'  # the kinds of statements of nodes
ALL = 'all'
_QUIET = ('idle', 'deadlock')  # values of ended_by after which nothing could have ended a goal any more
_OF_THE_RUN = 'the run'


class Broken(NamedTuple):
    """A property that a run has broken: a built-in one, or 'always' or 'never_again' for a statement of a node."""

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


class Facts(NamedTuple):
    """What a run has left: its Story, the end record of its log, what the log says of processes, and their ends.

    ``asked``: the properties that it must keep, of chosen().
    """

    story: Story
    end: Dict[str, Any]
    log: ends.Log
    processes: Sequence[ends.End]
    asked: Dict[str, float]


#: what has broken a property: (instant [ns] or None, node or robot, text, details)
Breaks = Iterator[Tuple[Optional[int], str, str, Tuple[str, ...]]]


class Property(NamedTuple):
    """A built-in property.

    ``sentence``: it holds in every good run; ``page``: 'holds if ...' in docs/properties.md; ``judge(facts, number)``:
    yields what has broken it. ``number``: the number that it takes (``NAME=NUMBER``), or None. ``default``: the number
    if none is given; None: then it is checked only if a number is given.
    """

    name: str
    sentence: str
    page: str
    judge: Callable[[Facts, float], Breaks]
    number: Optional[Kind] = None
    default: Optional[float] = None

    @property
    def is_usual(self) -> bool:
        """Whether it is one of ``all``."""
        return self.number is None or self.default is not None


def _crashes(facts: Facts, _number: float) -> Breaks:
    """Yield the crashes. An exception that no_exception reports is not reported as a crash, too."""
    told = facts.log.uncaught if 'no_exception' in facts.asked else {}
    for one in facts.processes:
        is_told = one.node in told and one.code in (None, 0, 1)  # 1: Python's code after an exception
        if one.crash is not None and not is_told:
            yield one.time_ns, one.node, one.crash, ()


def _exceptions(facts: Facts, _number: float) -> Breaks:
    for node, told in facts.log.uncaught.items():
        yield told[0][0], node, told[0][1], ()


def _standstills(facts: Facts, _number: float) -> Breaks:
    yield from _ended_by('deadlock', facts)
    for time_ns, robot, circle in facts.story.circles:
        pairs = ', '.join('{} for {}'.format(*pair) for pair in zip(circle[::2], circle[1::2]))
        yield time_ns, robot, 'robots wait for each other, to the end of the run', (pairs,)


def _loops(facts: Facts, _number: float) -> Breaks:
    return _ended_by('zero_delay_loop', facts)


def _ended_by(what: str, facts: Facts) -> Breaks:
    if facts.end.get('ended_by') == what:
        yield facts.end.get('at_ns'), _OF_THE_RUN, str(facts.end.get('reason', '')), ()


def _open_goals(facts: Facts, _number: float) -> Breaks:
    """Yield the goals for which clients still wait, whichever node was to do them, and goals and tasks of robots."""
    if facts.end.get('ended_by') not in _QUIET:
        return
    texts = []
    for one in facts.end.get('open_goals', []):
        texts.append('{} of its goals never {} on {}'.format(
            one['count'], 'ends' if one['count'] == 1 else 'end', one['action']))
        yield facts.end.get('at_ns'), str(one['client']), texts[-1], ()
    for robot in facts.story.robots.values():
        since_ns = robot.begun('goal')
        if since_ns is not None and not any(robot.name in text for text in texts):  # each goal is reported once
            yield since_ns, robot.name, 'the goal that it took in then never ends', ()
    for name, task, since_ns in facts.story.open_tasks():
        yield since_ns, name, 'the task that it got then never ends', (str(task),)


def _overfull(facts: Facts, _number: float) -> Breaks:
    for one in facts.story.overfull:
        yield one.time_ns, one.robot, 'it {} {}, which has room for {}'.format(
            'works at' if one.works else 'came into', one.where, one.room), one.robots


def _emptied(facts: Facts, _number: float) -> Breaks:
    for one in facts.story.emptied:
        yield one.time_ns, one.robot, 'its battery is empty', (one.words,)


#: {name: Property}
BUILT_IN = {one.name: one for one in (
    Property('no_crash', 'no node crashes', 'no node [crashes](lockstep_launch.md#crashes)', _crashes),
    Property('no_exception', 'every exception is caught',
             'no participant has an uncaught exception (events `uncaught`, `unasked`)', _exceptions),
    Property('no_standstill', 'no node and no robot waits for ever', 'the run does not end in a '
             "[deadlock](lockstep.md#idle-and-deadlock), and at its end no robots wait for each other's places",
             _standstills),
    Property('no_zero_delay_loop', 'simulated time goes on',
             'the run does not end in a loop of messages at one instant', _loops),
    Property('every_goal_ends', 'no goal is open when nothing is left that could happen',
             'when nothing is left that could happen, no client of any action waits for a goal, no robot has a goal, '
             'and no task is open', _open_goals),
    Property('capacities_kept', 'no zone, lane or place holds more robots than it has room for',
             'no [zone](zones.md), [lane](lanes.md) or place holds more robots than it has room for', _overfull),
    Property('charged', 'no robot stands with an empty battery away from a charger',
             "no robot's [battery](battery.md) gets empty while it is not charged", _emptied))}


def _check(where: str, value: Any) -> str:
    name, equals, number = value.partition('=') if isinstance(value, str) else ('', '', '')
    asked = BUILT_IN.get(name)
    takes = asked.number if asked is not None else None
    if name not in (ALL, *BUILT_IN, ALWAYS, NEVER_AGAIN) or (equals and takes is None):
        raise kinds.error(where, value, ', '.join((ALL, *_forms(), ALWAYS, NEVER_AGAIN)))
    if takes is not None and (equals or not (asked and asked.is_usual)):
        try:
            given = kinds.as_number(number)
        except ValueError:
            raise kinds.error(where, value, f'{name}=NUMBER') from None
        takes.check(f'{where}: {name}', given)
    return str(value)


def _forms() -> List[str]:
    return [one.name if one.number is None else f'{one.name}=NUMBER' for one in BUILT_IN.values()]


def _schema() -> kinds.Schema:
    names = {'enum': [ALL, *(name for name, one in BUILT_IN.items() if one.is_usual), ALWAYS, NEVER_AGAIN]}
    numbered = '|'.join(name for name, one in BUILT_IN.items() if one.number is not None)
    return {'anyOf': [names, {'type': 'string', 'pattern': f'^({numbered})=[-+.0-9e]+$'}]} if numbered else names


#: the kind of the names of properties in options: NAME, or NAME=NUMBER if it takes a number
KIND = Kind(_check, _schema())


def chosen(names: Iterable[str]) -> Dict[str, float]:
    """Return {property: its number, or 0} of the properties that ``names`` ask for; they are of KIND."""
    found: Dict[str, float] = {}
    for word in names:
        name, _, number = word.partition('=')
        if name == ALL:
            usual = {one.name: one.default or 0.0 for one in BUILT_IN.values() if one.is_usual}
            found = {**usual, ALWAYS: 0.0, NEVER_AGAIN: 0.0, **found}
        else:
            asked = BUILT_IN.get(name)
            found[name] = float(number) if number else (asked.default or 0.0) if asked is not None else 0.0
    return found


def judge(facts: Facts) -> Iterator[Broken]:
    """Yield the built-in properties that a run must keep and has broken."""
    for one in BUILT_IN.values():
        if one.name in facts.asked:
            for broken in one.judge(facts, facts.asked[one.name]):
                yield Broken(one.name, *broken)
