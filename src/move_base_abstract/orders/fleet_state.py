"""What a dispatcher knows about each robot from its rows: where it stands, what it does, and its condition."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, NamedTuple, Optional, Sequence, Tuple

from ..goals.events import ABOVE, BELOW, EMPTY, FULL, SET
from ..motion.geometry import Pose2D
from .look_ahead import Takes, in_millionths
from .policies import FreeRobot, OpenOrder

FULL_CHARGE = 1.0
#: the kind of failure that ends the goal by itself, after a while
STUCK = 'stuck'
#: what a robot does (its phase). OTHERS: it has a goal that the dispatcher did not send
FREE, DRIVING, WORKING, TO_CHARGER, AT_CHARGER, HOMING, PARKING, OTHERS = (
    'free', 'driving', 'working', 'to charger', 'at charger', 'homing', 'parking', 'taken')
HOME = ''  # among the names of chargers and places
#: the kinds of rows that a dispatcher needs
HEARD = ('stands', 'departed', 'ended', 'task_ended', 'battery', 'failed', 'repaired', 'charging_began',
         'charging_ended')
#: the kinds that it needs besides if robots look ahead
HEARD_AHEAD = ('task_began', 'waiting_began')


class RobotStart(NamedTuple):
    """A robot at the beginning: where it stands, and its state of charge, 0..1 (None: it has no battery).

    ``takes``: what driving and work take of its battery, see LookAhead.
    """

    name: str
    pose: Pose2D
    charge: Optional[float] = None
    priority: int = 0
    takes: Optional[Takes] = None


class Ending(NamedTuple):
    """How the robot's goal or work has ended."""

    succeeded: bool
    text: str


@dataclass
class RobotState:
    """The state of one robot; ``index``: its number, in the order of names."""

    index: int
    name: str
    home: Pose2D
    at: Tuple[float, float] = (0.0, 0.0)
    phase: str = FREE
    goal_id: str = ''
    order: Optional[OpenOrder] = None
    stop: int = 0  # index of the present stop of its order
    assigned: int = 0  # the number of times that its order was assigned to a robot, including this one
    carries: int = 0
    begun: int = 0  # the number of orders that it has begun
    done: int = 0  # and done
    busy_ns: int = 0  # how long it had orders [ns]; while it has one, less the instant at which that began
    ending: Optional[Ending] = None
    charger: str = ''
    parking: str = ''  # the parking place where it stands, or to which it drives
    parked_at: Tuple[float, float] = (0.0, 0.0)  # the point where it stands there
    is_charging: bool = False
    stands_in: str = ''  # the charger that charges it, or that charged it last
    must_charge: bool = False
    awaits_charger_since: Optional[int] = None  # its number in the queue, None: it does not wait
    waits_from_ns: int = 0  # when it began to wait for a charger
    is_told_to_wait: bool = False
    own_priority: int = 0  # while it has no order
    priority: int = 0  # the priority that was last sent to it
    has_failed: bool = False
    is_lost: bool = False  # it has failed in such a way that its goal may never end
    is_empty: bool = False
    moves: bool = False
    bound_for: Tuple[float, float] = (0.0, 0.0)  # where it was sent last
    works: bool = False  # known if robots look ahead
    wants: int = 0  # if it must charge, the charge [millionths] that it needs at least to be free again
    charge: Optional[int] = None  # the least that its charge may be now [millionths], None: it has no battery
    below: Dict[float, bool] = field(default_factory=dict)  # {level: whether its charge is below it}
    #: {charger, parking place or HOME: instant [ns] at which the way to it failed, or to HOME, ended}
    tried_now: Dict[str, int] = field(default_factory=dict)
    sent: Dict[str, Tuple[int, int]] = field(default_factory=dict)  # {purpose: (instant [ns] of the last goal, number)}

    @property
    def is_out_of_order(self) -> bool:
        """Whether it can do nothing now: it has failed, or its battery is empty."""
        return self.has_failed or self.is_empty

    def new_id(self, purpose: str, now_ns: int) -> str:
        """Return an id for a goal of no order, one that the robot has not had; with a used one it would not go."""
        last_ns, number = self.sent.get(purpose, (now_ns - 1, 0))
        number = number + 1 if last_ns == now_ns else 1
        self.sent[purpose] = now_ns, number
        return '{}.{}'.format(purpose, now_ns) + ('.{}'.format(number) if number > 1 else '')

    def is_below(self, level: float) -> bool:
        """Return whether the charge is below ``level``, one of the levels; that of a robot without battery never is."""
        return self.below.get(level, False)

    def hear(self, kind: str, values: Sequence[Any]) -> None:
        """Take in a row of the robot; its ``kind`` is one of :data:`HEARD`."""
        if kind == 'stands':
            self.moves, self.at = False, (float(values[0]), float(values[1]))
        elif kind in ('ended', 'task_ended'):
            self.works = False
            self._goal_ended(*values[:3])
        elif kind in HEARD_AHEAD:
            self.works = kind == 'task_began'
        elif kind == 'departed':
            self.moves = True
            if not self.goal_id and self.phase != OTHERS:
                self.phase, self.charger, self.parking = OTHERS, '', ''
        elif kind == 'battery':
            self._charge_passed(float(values[0]), values[1])
        elif kind in ('failed', 'repaired'):
            self.has_failed = kind == 'failed'
            self.is_lost = kind == 'failed' and values[0] != STUCK
        else:
            self.is_charging, self.stands_in = kind == 'charging_began', values[0]
            if FULL_CHARGE in self.below and not self.is_charging:
                self.below[FULL_CHARGE] = True
            self._note_charge()

    def _goal_ended(self, goal_id: str, state: str, text: str) -> None:
        if goal_id == self.goal_id:
            self.ending = Ending(state == 'SUCCEEDED', text)
            self.goal_id = ''
        elif self.phase == OTHERS:
            self.phase = FREE

    def _charge_passed(self, level: float, what: str) -> None:
        if what == EMPTY:
            self.is_empty = True
        elif what == SET:
            self.is_empty = level <= 0.0
        elif what in (ABOVE, FULL):
            self.is_empty = False
        for known in self.below:
            if what in (SET, FULL):
                self.below[known] = _is_below(level, known)
            elif what == ABOVE and known <= level:
                self.below[known] = False
            elif what in (BELOW, EMPTY) and level <= known:
                self.below[known] = True
        self._note_charge()

    def _note_charge(self) -> None:
        if self.charge is not None:
            sure = (level for level, is_below in self.below.items() if not is_below and (
                level < FULL_CHARGE or self.is_charging))
            self.charge = in_millionths(max(sure, default=0.0))

    def begin(self, one: OpenOrder, now_ns: int) -> None:
        """Begin with an order at ``now_ns`` [ns]."""
        self.order, self.stop, self.carries = one, one.next_stop, 0
        self.begun += 1
        self.busy_ns -= now_ns

    def let_go(self, phase: str, now_ns: int) -> Optional[OpenOrder]:
        """Return the order that the robot has, None: it has none, and have it without one at ``now_ns`` [ns]."""
        one, self.order, self.phase = self.order, None, phase
        if one is not None:
            self.busy_ns += now_ns
        return one

    def as_free(self, now_ns: int) -> FreeRobot:
        """Return what a policy gets to know at ``now_ns`` [ns]; a robot with an order is where the order ends."""
        if self.order is None:
            return FreeRobot(self.name, *self.at, self.begun, self.done, self.busy_ns)
        pose = self.order.order.stops[-1].pose
        return FreeRobot(self.name, pose.x, pose.y, self.begun, self.done, self.busy_ns + now_ns)


def make_states(starts: Sequence[RobotStart], levels: Sequence[float]) -> Dict[str, RobotState]:
    """Return {name: RobotState} of robots at the start; ``levels``: the states of charge on which decisions depend."""
    states = {}
    for index, one in enumerate(starts):
        state = RobotState(index, one.name, one.pose, (one.pose.x, one.pose.y))
        state.own_priority = state.priority = one.priority
        if one.charge is not None:
            state.below = {level: _is_below(one.charge, level) for level in levels}
            state.is_empty, state.charge = one.charge <= 0.0, 0
            state._note_charge()
        states[one.name] = state
    return states


def _is_below(charge: float, level: float) -> bool:
    """Return whether ``charge`` is at or below ``level``, as a battery reports; for FULL_CHARGE, whether below it."""
    return charge < level if level == FULL_CHARGE else charge <= level
