"""The states of robots between the events of a log. One table says which events begin a state, and which end it.

A row ``X_began`` of any participant begins the state X, and a row ``X_ended`` ends it; X is one of failed, charging,
task and waiting.
"""
import json
import re
from typing import NamedTuple

from move_base_abstract.runs.run_difference import MESSAGES

#: the kinds of events of the radio; hosts get no rows in the timeline
RADIO = ('radio', 'radio_lost', 'link', 'host')


class State(NamedTuple):
    """A state of the timeline: its name on the page, and the kinds of events that begin and end it."""

    name: str
    begin: tuple = ()
    end: tuple = ()


#: if several states hold at the same time, the first one is shown; a robot in none of them is idle
STATES = (
    State('failed', ('failed', 'failed_began'), ('repaired', 'failed_ended')),
    State('charging', ('charging_began',), ('charging_ended',)),
    State('moving', ('departed',), ('stands',)),
    State('task', ('task_began',), ('task_ended',)),
    State('waiting', ('waiting_began', 'held'), ('waiting_ended', 'released')),
)
IDLE = 'idle'
NAMES = tuple(state.name for state in STATES) + (IDLE,)
#: the endings of a goal or task that the page marks as failures
FAILED_ENDINGS = ('ABORTED', 'REJECTED', 'LOST')
_ENDINGS = {'ended': 1, 'task_ended': 1}  # {kind: the place of the ending among its values}
_GOALS = '/move_base/goal'  # in a log with messages, a message on this topic gives the robot something to do
_BEGINS = {kind: number for number, state in enumerate(STATES) for kind in state.begin}
_ENDS = {kind: number for number, state in enumerate(STATES) for kind in state.end}
_WAITING = [state.name for state in STATES].index('waiting')


class Span(NamedTuple):
    """A state, by its place in NAMES, from ``begin_ns`` to ``end_ns``."""

    begin_ns: int
    end_ns: int
    state: int


class Timeline:
    """One row of the timeline.

    A robot has ``spans`` (without those in which it is idle) and ``failures`` [ns]; other names have ``ticks`` [ns].
    """

    def __init__(self, name, is_robot):
        self.name = name
        self.is_robot = is_robot
        self.spans = []
        self.failures = []
        self.ticks = []
        self._holds = [0] * len(STATES)  # per state, how often it has begun and not ended
        self._shown = len(STATES)
        self._since_ns = 0

    def begin(self, state, time_ns):
        """Begin a state, perhaps once more: two tasks at the same time must both end."""
        self._holds[state] += 1
        self._show(time_ns)

    def begin_once(self, state, time_ns):
        """Begin a state, unless it has begun already."""
        self._holds[state] = max(1, self._holds[state])
        self._show(time_ns)

    def end(self, state, time_ns):
        """End a state once; a state that has not begun stays so."""
        self._holds[state] = max(0, self._holds[state] - 1)
        self._show(time_ns)

    def end_once(self, state, time_ns):
        """End a state, however often it has begun."""
        self._holds[state] = 0
        self._show(time_ns)

    def close(self, time_ns):
        """End all states at the end of the log."""
        self._holds = [0] * len(STATES)
        self._show(time_ns)

    def _show(self, time_ns):
        now = next((state for state, count in enumerate(self._holds) if count), len(STATES))
        if now == self._shown:
            return
        if self._shown < len(STATES) and time_ns > self._since_ns:
            self.spans.append(Span(self._since_ns, time_ns, self._shown))
        self._shown, self._since_ns = now, time_ns


def find_timelines(recording, robots):
    """Return the Timelines of a Recording: those of ``robots`` (names) in natural order, then those of other names.

    Of these, names with rows of their own come before nodes of which the log has only messages.
    """
    found = {name: Timeline(name, True) for name in sorted(robots, key=natural)}
    owners, others, nodes = {}, {}, {}
    for time_ns, name, kind, values in recording:
        if kind in RADIO:
            continue
        if kind in MESSAGES:
            sender = (json.loads(values) or [''])[0]
            nodes.setdefault(sender, Timeline(sender, False)).ticks.append(time_ns)
            _take_goal(found.get(name[:-len(_GOALS)].strip('/')) if name.endswith(_GOALS) else None, kind, time_ns)
            continue
        if name not in owners:
            owners[name] = _owner(name, found)
        if owners[name] is None:
            others.setdefault(name, Timeline(name, False)).ticks.append(time_ns)
        else:
            _take(owners[name], time_ns, kind, values)
    for timeline in found.values():
        timeline.close(recording.end_ns)
    rest = [others[name] for name in sorted(others, key=natural)]
    return [*found.values(), *rest, *(nodes[name] for name in sorted(nodes, key=natural) if name)]


def natural(name):
    """Return a key that sorts names with their numbers by value: robot_2 before robot_10."""
    return [(0, int(text), '') if text[0] in '0123456789' else (1, 0, text) for text in
            re.findall(r'[0-9]+|[^0-9]+', name)], name


def _owner(name, robots):
    """Return the Timeline of the robot whose name this is, or in whose namespace it lies; None if there is none."""
    parts = name.strip('/').split('/')
    for count in range(len(parts), 0, -1):
        robot = robots.get('/'.join(parts[:count]))
        if robot is not None:
            return robot
    return robots.get(name)


def _take(timeline, time_ns, kind, values):
    """Take a row about a robot."""
    if kind in _ENDINGS:
        texts = json.loads(values)
        if len(texts) > _ENDINGS[kind] and texts[_ENDINGS[kind]] in FAILED_ENDINGS:
            timeline.failures.append(time_ns)
    if kind == 'departed':
        timeline.end_once(_BEGINS[kind], time_ns)
    if kind == 'held':  # a robot that is held already may be held again for other reasons
        timeline.begin_once(_WAITING, time_ns)
    elif kind in _BEGINS:
        timeline.begin(_BEGINS[kind], time_ns)
    elif kind in _ENDS:
        timeline.end(_ENDS[kind], time_ns)
    elif kind == 'ended':
        timeline.end(_WAITING, time_ns)


def _take_goal(timeline, kind, time_ns):
    """Take a goal that was sent to a robot. Until the goal has ended, the robot waits whenever it does not move."""
    if timeline is not None and kind == 'message':
        timeline.begin(_WAITING, time_ns)
