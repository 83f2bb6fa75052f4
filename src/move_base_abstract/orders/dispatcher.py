"""The decisions of a dispatcher: rows of robots and orders come in, goals for robots come out. No ROS, no fleet.

The dispatcher first takes in everything that happens at one instant; then :meth:`Dispatcher.decide` returns what is to
be done. So the order in which messages of one instant arrive changes nothing.
"""
from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import Any, Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..common.errors import ConfigurationError, SimulatorError
from ..common.shown import shown
from ..common.units import NS_PER_S
from ..motion.geometry import Pose2D
from ..tasks.arrivals import Task
from ..tasks.places import Place
from . import rows
from .charging import Charger, Charging
from .fleet_state import (
    AT_CHARGER,
    DRIVING,
    FREE,
    FULL_CHARGE,
    HEARD,
    HEARD_AHEAD,
    OTHERS,
    PARKING,
    TO_CHARGER,
    WORKING,
    RobotStart,
    RobotState,
    make_states,
)
from .look_ahead import LookAhead
from .order import LOAD, UNLOAD, Order, fault_of
from .parking import Parking
from .policies import Distance, OpenOrder, Policy, Question
from .settings import RESTART, DispatchSettings
from .undone import undone, why_open


class PolicyError(SimulatorError):
    """A policy has failed, or has chosen something that cannot be done; the text says why."""


class Drive(NamedTuple):
    """Send the robot a goal; ``priority``: the robot's new priority, to be set before that, None: it keeps its own."""

    robot: str
    goal_id: str
    pose: Pose2D
    priority: Optional[int] = None


class WorkOn(NamedTuple):
    """Let the robot work where it stands."""

    robot: str
    goal_id: str
    task: Task


class GiveUp(NamedTuple):
    """Cancel what the robot does: its work if ``is_work``, otherwise its goal."""

    robot: str
    goal_id: str
    is_work: bool


Command = Union[Drive, WorkOn, GiveUp]


class Dispatcher:
    """Decides which robot does which order, and which robots charge.

    ``places``: {name: Place}; ``distance``: as in :mod:`.policies`; ``tell(row)`` is called with each row (robot, kind,
    values...) for the event log, see :mod:`.rows`.
    """

    def __init__(self, starts: Sequence[RobotStart], chargers: Sequence[Charger], places: Mapping[str, Place],
                 settings: DispatchSettings, policy: Policy, distance: Distance,
                 tell: Callable[[rows.Row], object]) -> None:
        reserve = settings.charge_reserve if chargers else None
        levels = (FULL_CHARGE, *settings.levels) if reserve is not None or FULL_CHARGE in (
            settings.charge_until, settings.charge_when_idle, settings.charge_full) else settings.levels
        self._ahead = None if reserve is None else LookAhead(
            reserve, [(one.pose.x, one.pose.y) for one in chargers], distance,
            {one.name: one.takes for one in starts if one.takes is not None})
        self._states = make_states(starts, levels)
        #: the states of the robots (RobotState), by their indices
        self.robots = list(self._states.values())
        self._places = places
        self._settings = settings
        self._policy = policy
        self._distance = distance
        self._take_row = tell
        self._parking = Parking(
            places.values() if settings.park_when_idle else (), distance, self._send, self._tell, self._ahead)
        self._charging = Charging(settings, chargers, distance, self._send, self._tell, self._parking, self._ahead)
        self._open: Dict[str, OpenOrder] = {}  # in the order of arrival
        self._in_turn: List[OpenOrder] = []  # the same by priority, then arrival
        self._turns: List[Tuple[int, int]] = []  # by which they are sorted
        self._seen: Dict[str, int] = {}  # {id: number of times that the order was assigned to a robot}
        self._refused: Dict[str, None] = {}  # the ids of orders that cannot be done
        self._commands: Dict[str, Command] = {}
        self._cancels: List[Command] = []

    @property
    def open_orders(self) -> List[str]:
        """The ids of the orders that no robot does, in the order of their arrival."""
        return list(self._open)

    def undone(self, what_holds: Optional[Callable[[str], str]] = None) -> Iterator[str]:
        """Yield a text for each order that is not done, and for each robot that is on its way for none.

        ``what_holds(robot)`` says in words why a robot with a goal does not go on. With it, the texts also say why.
        """
        if what_holds is None:
            return undone(self.robots, self._open.values(), self._refused)
        question = self._question(self._free(), 0)
        return undone(self.robots, self._open.values(), self._refused, lambda robot: ', ' + what_holds(robot),
                      lambda one: ', ' + why_open(one, question))

    @property
    def waits_for_charge(self) -> bool:
        """Whether a robot that must charge is charging while orders, or robots without a charger, wait."""
        return any(robot.must_charge and robot.is_charging for robot in self.robots) and (
            bool(self._open) or any(robot.awaits_charger_since is not None or (
                self._ahead is not None and robot.phase == TO_CHARGER and not robot.moves) for robot in self.robots))

    def hears(self, robot: str, kind: str) -> bool:
        """Return whether the dispatcher needs rows of this kind of this robot."""
        return robot in self._states and (kind in HEARD or self._ahead is not None and kind in HEARD_AHEAD)

    def happened(self, robot: str, kind: str, values: Sequence[Any]) -> Optional[str]:
        """Take in a row of a robot for which :meth:`hears` is true; return a warning, if there is one."""
        state = self._states[robot]
        was_empty = state.is_empty
        state.hear(kind, values)
        if was_empty or not state.is_empty or state.awaits_charger_since is None:
            return None
        return 'It has waited for a charger since {:.1f} s: all that it could reach were taken.'.format(
            state.waits_from_ns / NS_PER_S)

    def arrived(self, order: Order, now_ns: int) -> None:
        """Take in an order at ``now_ns`` [ns]. An order that cannot be done is refused: a row says why."""
        fault = fault_of(order, self._places)
        if fault is None and order.order_id in self._seen:
            fault = 'id: {} was given to an order before; each order needs an id of its own'.format(
                shown(order.order_id))
        if fault is None and self._ahead is not None:
            fault = self._ahead.fault_of(order, self.robots)
        if fault is not None:
            self.refuse(order.order_id, fault)
            return
        self._seen[order.order_id] = 0
        self._refused.pop(order.order_id, None)  # it has come again, put right
        deadline_ns = None if order.deadline_ns is None else now_ns + order.deadline_ns
        self._put(OpenOrder(order, now_ns, deadline_ns, 0, 0))
        stops = [value for stop in order.stops for value in (stop.place, stop.pose.x, stop.pose.y, stop.action)]
        self._tell(rows.DISPATCHER, 'order_arrived', order.order_id, order.priority, deadline_ns or 0, *stops)

    def refuse(self, order_id: object, why: str) -> None:
        """Refuse an order that cannot be done; ``why``: what is wrong with it, for the row."""
        name = order_id if isinstance(order_id, str) else shown(order_id)
        if name not in self._seen:  # otherwise it is another order that has this id
            self._refused[name] = None
        self._tell(rows.DISPATCHER, 'order_refused', name, why)

    def decide(self, now_ns: int) -> List[Command]:
        """Return the commands for ``now_ns`` [ns], by the robots' indices; cancellations come first.

        If the policy fails, or chooses something that cannot be done, a row says so, and no robot gets an order now.

        :raises ConfigurationError: if the policy raises it.
        """
        for robot in self.robots:
            self._go_on(robot, now_ns)
        self._charging.look(self.robots)
        try:
            self._assign(now_ns)
        except PolicyError as error:
            self._tell(rows.DISPATCHER, 'policy_failed', str(error))
        finally:
            self._charging.send(self.robots, now_ns)
            self._parking.send(self.robots, now_ns)
        commands = [*self._cancels, *(self._commands[robot.name] for robot in self.robots
                                      if robot.name in self._commands)]
        self._commands, self._cancels = {}, []
        return commands

    # --- one robot ---------------------------------------------------------------------------------------------------

    def _go_on(self, robot: RobotState, now_ns: int) -> None:
        """Act on the end of what the robot did, on its failure, or on a goal from elsewhere."""
        ending, robot.ending = robot.ending, None
        why = rows.ROBOT_FAILED if robot.is_lost else rows.SHORT if (
            self._ahead is not None and self._ahead.cannot_finish(robot)) else None
        if ending is None and robot.goal_id and why is not None:
            self._cancels.append(GiveUp(robot.name, robot.goal_id, robot.phase == WORKING))
            robot.goal_id = robot.parking = ''
            robot.must_charge |= why == rows.SHORT
            self._give_back(robot, why, now_ns)
        elif ending is not None and robot.phase in (DRIVING, WORKING):
            self._stop_ended(robot, ending, now_ns)
        elif ending is not None and robot.phase == PARKING:
            self._parking.ended(robot, ending.succeeded, now_ns)
        elif ending is not None and robot.phase != OTHERS:
            self._charging.ended(robot, ending.succeeded, now_ns)
        elif robot.phase == OTHERS and robot.order is not None:
            self._give_back(robot, rows.TAKEN, now_ns, OTHERS)

    def _stop_ended(self, robot: RobotState, ending: Any, now_ns: int) -> None:
        one: Any = robot.order
        if not ending.succeeded:
            why = rows.ROBOT_EMPTY if robot.is_empty else rows.ROBOT_FAILED if robot.has_failed else ending.text
            self._give_back(robot, why or rows.TAKEN, now_ns)
        elif robot.phase == DRIVING and one.order.stops[robot.stop].duration_ns:
            task = one.order.stops[robot.stop].task(self._goal_id(robot), one.order.priority)
            robot.phase = WORKING
            self._tell_stop(robot, rows.WORKS)
            self._commands[robot.name] = WorkOn(robot.name, task.task_id, task)
            robot.goal_id = task.task_id
        else:
            self._stop_done(robot, one, now_ns)

    def _stop_done(self, robot: RobotState, one: OpenOrder, now_ns: int) -> None:
        action = one.order.stops[robot.stop].action
        robot.carries += (action == LOAD) - (action == UNLOAD)
        self._tell_stop(robot, rows.DONE)
        robot.stop += 1
        if robot.stop < len(one.order.stops):
            self._drive(robot)
            return
        robot.let_go(FREE, now_ns)
        robot.carries = 0
        robot.done += 1
        is_late = one.deadline_ns is not None and now_ns > one.deadline_ns
        self._tell_done(robot, one, rows.LATE if is_late else rows.DONE, now_ns)

    def _tell_done(self, robot: RobotState, one: OpenOrder, code: str, now_ns: int) -> None:
        late = () if one.deadline_ns is None else (now_ns - one.deadline_ns,)
        self._tell(robot.name, 'order_done', one.order.order_id, code, now_ns - one.arrived_ns, *late)

    def _give_back(self, robot: RobotState, why: str, now_ns: int, phase: str = FREE) -> None:
        """Take the order back from the robot: another robot may do it, unless there were too many attempts."""
        self._charging.leave(robot)
        one = robot.let_go(phase, now_ns)
        if one is None:
            return
        tried = one.tried + (why not in rows.ROBOTS_FAULTS)
        stop = 0 if robot.carries > 0 and self._settings.after_failure == RESTART else robot.stop
        robot.carries = 0
        self._tell(robot.name, 'order_returned', one.order.order_id, why, stop + 1)
        if tried >= self._settings.attempts:
            self._tell_done(robot, one, rows.FAILED, now_ns)
            return
        self._put(one._replace(tried=tried, next_stop=stop))

    def _drive(self, robot: RobotState) -> None:
        one: Any = robot.order
        robot.phase = DRIVING
        self._tell_stop(robot, rows.DRIVES)
        self._send(robot, one.order.stops[robot.stop].pose, self._goal_id(robot))

    def _goal_id(self, robot: RobotState) -> str:
        """Return the id of a goal for the present stop of the robot's order; it is unique."""
        one: Any = robot.order
        return '{}.{}.{}'.format(one.order.order_id, robot.assigned, robot.stop + 1)

    def _send(self, robot: RobotState, pose: Pose2D, goal_id: str) -> None:
        robot.goal_id, robot.parking, robot.bound_for = goal_id, '', (pose.x, pose.y)
        priority = robot.own_priority if robot.order is None else max(robot.own_priority, robot.order.order.priority)
        is_new, robot.priority = priority != robot.priority, priority
        self._commands[robot.name] = Drive(robot.name, goal_id, pose, priority if is_new else None)

    # --- all of them -------------------------------------------------------------------------------------------------

    def _free(self) -> List[RobotState]:
        """Return the robots that may begin with an order."""
        return [robot for robot in self.robots if robot.phase in (FREE, AT_CHARGER, PARKING)
                and not robot.is_out_of_order and not robot.must_charge
                and (not robot.goal_id or robot.phase == PARKING)]

    def _assign(self, now_ns: int) -> None:
        """Ask the policy which robots begin with which orders."""
        free = self._free()
        if not free or not self._open:
            return
        question = self._question(free, now_ns)
        try:
            chosen = self._checked(question, free)
        except PolicyError:
            left = self._without_faulty(question, free)
            if not left:
                raise
            chosen = self._checked(question._replace(orders=left), free)
        for robot, one in chosen:
            if not self._is_short(robot.name, one):
                self._begin(robot, one, now_ns)
        self._charging.lack(free, self._in_turn)

    def _question(self, free: Sequence[RobotState], now_ns: int) -> Question:
        return Question(list(self._in_turn), [robot.as_free(now_ns) for robot in free],
                        [robot.as_free(now_ns) for robot in self.robots if robot.order is not None
                         and not robot.must_charge], now_ns, self._distance, self._is_short)

    def _is_short(self, robot: str, one: OpenOrder) -> bool:
        """Return whether a free robot lacks the charge for an order."""
        return self._ahead is not None and self._ahead.is_short(self._states[robot], one)

    def _without_faulty(self, question: Question, free: Sequence[RobotState]) -> List[OpenOrder]:
        """Refuse the orders with each of which alone the policy fails, and return the others.

        Return none, and refuse none, if it fails with all of them or with none: then the fault is its own.
        """
        faults: Dict[str, str] = {}
        for one in question.orders:
            try:
                self._checked(question._replace(orders=[one]), free)
            except PolicyError as error:
                faults[one.order.order_id] = str(error)
        if not 0 < len(faults) < len(question.orders):
            return []
        for order_id, fault in faults.items():
            self._take_out(order_id)
            self._refused[order_id] = None
            self._tell(rows.DISPATCHER, 'order_refused', order_id, fault)
        return [one for one in question.orders if one.order.order_id not in faults]

    def _put(self, one: OpenOrder) -> None:
        """Have an order open: it comes after those of its priority and instant."""
        turn = _turn(one)
        at = bisect_right(self._turns, turn)
        self._turns.insert(at, turn)
        self._in_turn.insert(at, one)
        self._open[one.order.order_id] = one

    def _take_out(self, order_id: str) -> None:
        """Have an order no longer open."""
        one = self._open.pop(order_id)
        at = self._in_turn.index(one, bisect_left(self._turns, _turn(one)))
        del self._turns[at], self._in_turn[at]

    def _begin(self, robot: RobotState, one: OpenOrder, now_ns: int) -> None:
        self._take_out(one.order.order_id)
        self._charging.leave(robot)
        robot.tried_now.clear()
        robot.begin(one, now_ns)
        self._seen[one.order.order_id] += 1
        robot.assigned = self._seen[one.order.order_id]
        self._tell(robot.name, 'order_assigned', one.order.order_id, robot.assigned)
        self._drive(robot)

    def _checked(self, question: Question, free: Sequence[RobotState]) -> List[Tuple[RobotState, OpenOrder]]:
        """Return what the policy chooses, by the robots' indices.

        :raises PolicyError: if the policy fails, or chooses something that cannot be done.
        """
        known, taken, found = {robot.name: robot for robot in free}, set(), []
        try:
            pairs = [(str(robot), str(order)) for robot, order in self._policy.choose(question)]
        except (ConfigurationError, MemoryError):
            raise
        except Exception as error:
            raise PolicyError('the policy {} has failed: {}: {}'.format(
                type(self._policy).__name__, type(error).__name__, error)) from error
        for robot, order in pairs:
            one = None if order in taken else self._open.get(order)
            taken.add(order)
            state = known.pop(robot, None)
            if one is None or state is None:
                raise PolicyError('the policy {} chose {} for {}; allowed: a robot of question.robots and an order of '
                                  'question.orders, each at most once'.format(
                                      type(self._policy).__name__, shown(order), shown(robot)))
            found.append((state, one))
        return sorted(found, key=lambda pair: pair[0].index)

    def _tell(self, robot: str, kind: str, *values: Any) -> None:
        self._take_row((robot, kind, *values))

    def _tell_stop(self, robot: RobotState, what: str) -> None:
        one: Any = robot.order
        self._tell(robot.name, 'order_stop', one.order.order_id, robot.stop + 1, what)


def _turn(one: OpenOrder) -> Tuple[int, int]:
    """Return by what open orders are sorted: higher priority, then earlier arrival."""
    return -one.order.priority, one.arrived_ns
