"""Deliberate faults of single goals, each with a chance: a late result, an aborted goal, a wrong pose.

Unlike failures, their purpose is to find what clients take for granted. They come only with a ``buggify_seed`` other
than 0, which in lockstep is the seed of chaos. Each fault has a name that is the same in each run, so a user can choose
single faults.
"""
from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Tuple

from ..common.kinds import integer, number
from ..common.parameter_table import Parameter
from ..common.units import seconds_to_ns
from ..engine.alarm import Alarm
from ..engine.chance import Purpose
from ..goals.events import Lapse
from .failures import ABORT, SILENT, STALL

if TYPE_CHECKING:
    from ..engine.chance import Chance
    from ..engine.event_queue import EventQueue
    from ..engine.stream import Stream
    from .failing import Failing

JUMP, MUTE = 'jump', 'mute'
LAPSES = (JUMP, MUTE)


class Lapsing:
    """The lapses of one robot, one at a time; their beginnings and ends are told to ``stream`` (Stream)."""

    def __init__(self, robot: Any, queue: EventQueue, stream: Stream) -> None:
        self._robot = robot
        self._stream = stream
        self._end = Alarm(queue, robot.index)
        self._now: Optional[Tuple[str, str]] = None  # kind and cause

    def begin(self, kind: str, cause: str, now_ns: int, until_ns: int, by: Tuple[float, float, float]) -> None:
        """Begin a lapse at ``now_ns`` [ns] that lasts until ``until_ns`` [ns]; if there is one already, do nothing.

        ``by``: the jump of the reported pose from the true one (x, y [m], yaw [rad]), for a lapse of the kind JUMP.
        """
        if self._now is not None:
            return
        self._now = kind, cause
        if kind == JUMP:
            self._robot.reported.jump(now_ns, *by)
        else:
            self._robot.reported.is_mute = True
        self._end.set(until_ns, self._be_right)
        self._stream.tell(Lapse(now_ns, self._robot.name, kind, cause, True, by if kind == JUMP else ()))

    def _be_right(self, now_ns: int) -> None:
        if self._now is not None:
            (kind, cause), self._now = self._now, None
            self._robot.reported.shift, self._robot.reported.is_mute = None, False
            self._stream.tell(Lapse(now_ns, self._robot.name, kind, cause, False))

    def reset(self, now_ns: int) -> None:
        """End the lapse, since the robot is placed at its start at ``now_ns`` [ns]."""
        self._end.cancel()
        self._be_right(now_ns)

    def restart(self, by_ns: int) -> None:
        """Note that the clock has restarted and events have been shifted by ``by_ns`` [ns]."""
        self._end.shift(by_ns)

    def close(self) -> None:
        """Note that the robot is removed."""
        self._end.cancel()


LATE_RESULT = 'late_result'


class Fault(NamedTuple):
    """A kind of deliberate faults.

    ``place``: the draw of a goal that decides whether it comes; it must stay, since the meaning of a seed depends on
    it. ``becomes``: the kind of failure or of lapse that the robot has. ``happens``: what happens, for the page;
    ``said``: the same after the name of a robot, for a decision of chaos; of a jump, with how far [m] and by how much
    [rad] it goes.
    """

    name: str
    place: int
    becomes: str
    happens: str
    said: str


#: a goal has at most one fault: the first that is drawn
FAULTS = (
    Fault(LATE_RESULT, 0, STALL, "the robot stands for up to 10 s, one millisecond before the goal's end",
          'stood still for a while'),
    Fault('abort', 1, ABORT, 'the goal is ABORTED on the way, and the robot takes the next one', 'gave its goal up'),
    Fault('stop', 2, STALL, 'the robot stands for up to 10 s on the way', 'stood still for a while'),
    Fault('silent', 3, SILENT, 'the robot stands and is silent', 'said nothing for a while'),
    Fault('jump', 6, JUMP, 'for up to 10 s on the way, the robot reports a pose that is wrong by up to 1 m in x and in '
          'y and by up to 0.2 rad', 'took itself to be {:.2f} m and {:.2f} rad beside where it was, for a while'),
    Fault('mute', 7, MUTE, 'for up to 10 s on the way, the robot reports no pose',
          'drove on without a pose or feedback for a while'),
)
_BY_NAME = {fault.name: fault for fault in FAULTS}
_SAID = {fault.becomes: fault.said for fault in FAULTS}
#: the kinds of rows of a log in which something goes wrong with a robot, also on purpose
GOES_WRONG = ('failed', 'lapse_began')
_SHARE, _SECONDS, _X, _Y, _YAW = 4, 5, 8, 9, 10  # the use of the other draws of a goal
CAUSE = 'chaos '  # the beginning of the cause of such a failure; the name of the fault follows
_LONGEST_S = 10.0  # s, simulated: the longest time of a stop, a silence, a delay, or a wrong or missing pose
_FARTHEST_M, _FARTHEST_RAD = 1.0, 0.2  # the largest jump of a pose along each axis, and its largest turn
_BEFORE_END_NS = 1_000_000  # a result is late because the robot stops this long before the end of its leg
_CHANCE = number(0.0, 1.0)


def _chances(value: Any) -> Tuple[Tuple[str, float], ...]:
    """Return ((kind, chance), ...) of a mapping, in the order of FAULTS."""
    if not isinstance(value, dict) or not set(value) <= set(_BY_NAME):
        raise ValueError
    return tuple((kind, _CHANCE(value[kind])) for kind in _BY_NAME if kind in value)


def _names(value: Any) -> Tuple[str, ...]:
    if not isinstance(value, (list, tuple)) or not all(isinstance(one, str) for one in value):
        raise ValueError
    return tuple(value)


TABLE = (
    Parameter('buggify', (), _chances,
              'Chance per goal of each deliberate fault; if several are drawn, only the first one in this order '
              'comes.',
              'a mapping with some of {}; each a chance in 0..1 per goal'.format(', '.join(_BY_NAME))),
    Parameter('buggify_seed', 0, integer(0),
              "Seed of the deliberate faults; in lockstep the run's `chaos_seed`.",
              'a whole number >= 0; 0: no deliberate faults'),
    Parameter('buggify_only', (), _names,
              "Names of the deliberate faults that may come; in lockstep the run's `chaos_only`.",
              'a list of names of faults; empty: all may come'),
)


@dataclass(frozen=True)
class Buggify:
    """The deliberate faults of a robot.

    ``chances``: ((kind, chance), ...), each > 0; ``only``: the names of the faults that may come, empty: all.
    """

    chances: Tuple[Tuple[str, float], ...]
    seed: int
    only: Tuple[str, ...] = ()


def read_buggify(values: Mapping[str, Any]) -> Optional[Buggify]:
    """Return the :class:`Buggify` in ``values`` (of :data:`TABLE`), None if there are no deliberate faults."""
    chances = tuple((kind, chance) for kind, chance in values['buggify'] if chance > 0.0)
    return Buggify(chances, values['buggify_seed'], values['buggify_only']) if chances and values[
        'buggify_seed'] else None


def name_of(robot: str, kind: str, goal_number: int) -> str:
    """Return the name of a fault of a robot's goal, 12 hexadecimal digits."""
    return hashlib.sha256(f'{robot}/{kind}/{goal_number}'.encode()).hexdigest()[:12]


class Buggifying:
    """Applies a :class:`Buggify` to one robot; ``chance``: the Chance of its seed and the robot.

    ``failing``: the Failing of the robot, by which it fails. The fault of a goal is drawn when the robot first departs
    for that goal.
    """

    def __init__(self, buggify: Buggify, robot: Any, navigator: Any, queue: Any, chance: Chance,
                 failing: Failing, stream: Stream) -> None:
        self._buggify = buggify
        self._robot = robot
        self._navigator = navigator
        self._chance = chance
        self._failing = failing
        self._lapsing = Lapsing(robot, queue, stream)
        self._alarm = Alarm(queue, robot.index)
        self._goal = 0  # the number of the goal of the last draw
        self._kind: Optional[str] = None  # the kind of the fault that is still to come, None: none
        robot.follow(self._motion_changed)

    def _motion_changed(self, _now_ns: int) -> None:
        self._alarm.cancel()
        leg = self._robot.leg
        if leg is None:
            return
        if self._navigator.goal_number != self._goal:
            self._goal, self._kind = self._navigator.goal_number, None
            self._kind = self._drawn()
        if self._kind is not None:
            end_ns = max(leg.depart_ns, leg.arrive_ns - _BEFORE_END_NS)
            share = 1.0 if self._kind == LATE_RESULT else self._uniform(_SHARE)
            self._alarm.set(leg.depart_ns + int(share * (end_ns - leg.depart_ns)), self._go_wrong)

    def _drawn(self) -> Optional[str]:
        for kind, chance in self._buggify.chances:
            if self._uniform(_BY_NAME[kind].place) < chance:
                only = self._buggify.only
                return kind if not only or name_of(self._robot.name, kind, self._goal) in only else None
        return None

    def _uniform(self, place: int) -> float:
        return self._chance.uniform(self._goal, Purpose.BUGGIFY, place)

    def _go_wrong(self, due_ns: int) -> None:
        kind, self._kind = self._kind, None
        assert kind is not None
        cause = CAUSE + name_of(self._robot.name, kind, self._goal)
        becomes = _BY_NAME[kind].becomes
        lasts_ns = 0 if becomes == ABORT else seconds_to_ns(_LONGEST_S * self._uniform(_SECONDS))
        if becomes in LAPSES:
            self._lapsing.begin(becomes, cause, due_ns, due_ns + lasts_ns, (
                self._either_way(_X, _FARTHEST_M), self._either_way(_Y, _FARTHEST_M),
                self._either_way(_YAW, _FARTHEST_RAD)))
        else:
            self._failing.fail(cause, due_ns, becomes, lasts_ns * 1e-9)

    def _either_way(self, place: int, farthest: float) -> float:
        return farthest * (2.0 * self._uniform(place) - 1.0)

    def reset(self, now_ns: int) -> None:
        """Note that the robot is placed at its start at ``now_ns`` [ns]: no fault is ahead of it."""
        self._alarm.cancel()
        self._lapsing.reset(now_ns)

    def restart(self, by_ns: int) -> None:
        """Note that the clock has restarted and events have been shifted by ``by_ns`` [ns]."""
        self._alarm.shift(by_ns)
        self._lapsing.restart(by_ns)

    def close(self) -> None:
        """Note that the robot is removed."""
        self._alarm.cancel()
        self._lapsing.close()


def decisions(rows: Iterable[Any]) -> Iterator[Dict[str, Any]]:
    """Yield a decision, in the form of chaos' own, for each TraceEntry in which a robot went wrong on purpose."""
    for row in rows:
        values = row.values
        if row.kind in GOES_WRONG and len(values) >= 2 and str(values[1]).startswith(CAUSE):
            yield {'name': values[1][len(CAUSE):], 'time_ns': row.time_ns, 'what': 'buggify',
                   'says': f'{row.robot} {_words(values)}'}


def _words(values: List[Any]) -> str:
    """Return in words what went wrong with a robot, from the values of its row."""
    said = _SAID.get(values[0], str(values[0]))
    return said.format(math.hypot(*values[2:4]), abs(values[4])) if values[2:] else said
