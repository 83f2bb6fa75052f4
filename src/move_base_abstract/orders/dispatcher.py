"""The decisions of a dispatcher: rows of robots and orders come in, goals for robots come out. No ROS, no fleet.

All that happens at one instant is taken in first; then :meth:`Dispatcher.decide` says what is to be done. So the order
in which messages of one instant arrive changes nothing.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..common.errors import ConfigurationError, SimulatorError
from ..common.shown import shown
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
    OTHERS,
    WORKING,
    RobotStart,
    RobotState,
    make_states,
)
from .order import LOAD, UNLOAD, Order, fault_of
from .policies import Distance, OpenOrder, Policy, Question
from .settings import RESTART, DispatchSettings


class PolicyError(SimulatorError):
    """What a policy has chosen cannot be done; the text says why."""


class Drive(NamedTuple):
    """Send the robot a goal; ``priority``: that of the robot from before on, None: the one that it has."""

    robot: str
    goal_id: str
    pose: Pose2D
    priority: Optional[int] = None


class WorkOn(NamedTuple):
    """Have the robot work where it stands."""

    robot: str
    goal_id: str
    task: Task


class GiveUp(NamedTuple):
    """Cancel what the robot does: its goal, or its work."""

    robot: str
    goal_id: str
    is_work: bool


Command = Union[Drive, WorkOn, GiveUp]


class Dispatcher:
    """Who does which order, and who charges.

    ``places``: {name: Place}; ``distance``: as of :mod:`.policies`; ``tell(row)`` gets (robot, kind, values...), see
    :mod:`.rows`.
    """

    def __init__(self, starts: Sequence[RobotStart], chargers: Sequence[Charger], places: Mapping[str, Place],
                 settings: DispatchSettings, policy: Policy, distance: Distance,
                 tell: Callable[[rows.Row], object]) -> None:
        levels = (FULL_CHARGE, *settings.levels) if FULL_CHARGE in (
            settings.charge_until, settings.charge_when_idle) else settings.levels
        self._states = make_states(starts, levels)
        #: what is known of the robots, by their indices
        self.robots = list(self._states.values())
        self._places = places
        self._settings = settings
        self._policy = policy
        self._distance = distance
        self._take_row = tell
        self._charging = Charging(settings, chargers, distance, self._send, self._tell)
        self._open: Dict[str, OpenOrder] = {}  # in the order of arrival
        self._in_turn: Optional[List[OpenOrder]] = None  # the same by priority, then arrival; None: they have changed
        self._seen: Dict[str, int] = {}  # {id: how often it was given to a robot}
        self._commands: Dict[str, Command] = {}
        self._cancels: List[Command] = []

    @property
    def open_orders(self) -> List[str]:
        """The ids of the orders that nobody does, in the order of their arrival."""
        return list(self._open)

    @property
    def waits_for_charge(self) -> bool:
        """Whether somebody is being charged for whom, or for whose charger, others wait."""
        return any(robot.must_charge and robot.is_charging for robot in self.robots) and (
            bool(self._open) or any(robot.awaits_charger_since is not None for robot in self.robots))

    def hears(self, robot: str, kind: str) -> bool:
        """Return whether a row is looked at."""
        return kind in HEARD and robot in self._states

    def happened(self, robot: str, kind: str, values: Sequence[Any]) -> None:
        """Take in a row of a robot, of those that :meth:`hears` names."""
        self._states[robot].hear(kind, values)

    def arrived(self, order: Order, now_ns: int) -> None:
        """Take in an order; one that cannot be done is refused."""
        fault = fault_of(order, self._places)
        if fault is None and order.order_id in self._seen:
            fault = 'id: {} was given to an order before; allowed: another one for each'.format(shown(order.order_id))
        if fault is not None:
            order_id = order.order_id if isinstance(order.order_id, str) else shown(order.order_id)
            self._tell(rows.DISPATCHER, 'order_refused', order_id, fault)
            return
        self._seen[order.order_id] = 0
        deadline_ns = None if order.deadline_ns is None else now_ns + order.deadline_ns
        self._in_turn = None
        self._open[order.order_id] = OpenOrder(order, now_ns, deadline_ns, 0, 0)
        stops = [value for stop in order.stops for value in (stop.place, stop.pose.x, stop.pose.y, stop.action)]
        self._tell(rows.DISPATCHER, 'order_arrived', order.order_id, order.priority, deadline_ns or 0, *stops)

    def decide(self, now_ns: int) -> List[Command]:
        """Return what is to be done now, by the robots' indices; what is given up comes first.

        Where the policy fails, or chooses what cannot be done, a row says so, and nobody is given an order now.
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
        commands = [*self._cancels, *(self._commands[robot.name] for robot in self.robots
                                      if robot.name in self._commands)]
        self._commands, self._cancels = {}, []
        return commands

    # --- one robot ---------------------------------------------------------------------------------------------------

    def _go_on(self, robot: RobotState, now_ns: int) -> None:
        """Act on what has come of the robot."""
        ending, robot.ending = robot.ending, None
        if ending is None and robot.goal_id and robot.is_lost:
            self._cancels.append(GiveUp(robot.name, robot.goal_id, robot.phase == WORKING))
            robot.goal_id = ''
            self._give_back(robot, rows.ROBOT_FAILED, now_ns)
        elif ending is not None and robot.phase in (DRIVING, WORKING):
            self._stop_ended(robot, ending, now_ns)
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
        robot.order, robot.phase, robot.carries = None, FREE, 0
        is_late = one.deadline_ns is not None and now_ns > one.deadline_ns
        self._tell_done(robot, one, rows.LATE if is_late else rows.DONE, now_ns)

    def _tell_done(self, robot: RobotState, one: OpenOrder, code: str, now_ns: int) -> None:
        late = () if one.deadline_ns is None else (now_ns - one.deadline_ns,)
        self._tell(robot.name, 'order_done', one.order.order_id, code, now_ns - one.arrived_ns, *late)

    def _give_back(self, robot: RobotState, why: str, now_ns: int, phase: str = FREE) -> None:
        """The robot does not do its order: somebody else does, or nobody, after too many attempts."""
        self._charging.leave(robot)
        one, robot.order, robot.phase = robot.order, None, phase
        if one is None:
            return
        is_robots_fault = why in (rows.ROBOT_FAILED, rows.ROBOT_EMPTY, rows.TAKEN)
        tried = one.tried + (not is_robots_fault)
        stop = 0 if robot.carries > 0 and self._settings.after_failure == RESTART else robot.stop
        robot.carries = 0
        self._tell(robot.name, 'order_returned', one.order.order_id, why, stop + 1)
        if tried >= self._settings.attempts:
            self._tell_done(robot, one, rows.FAILED, now_ns)
            return
        self._in_turn = None
        self._open[one.order.order_id] = one._replace(tried=tried, next_stop=stop)

    def _drive(self, robot: RobotState) -> None:
        one: Any = robot.order
        robot.phase = DRIVING
        self._tell_stop(robot, rows.DRIVES)
        self._send(robot, one.order.stops[robot.stop].pose, self._goal_id(robot))

    def _goal_id(self, robot: RobotState) -> str:
        """Return what a goal of a robot's order is called; no other goal is called so."""
        one: Any = robot.order
        return '{}.{}.{}'.format(one.order.order_id, robot.assigned, robot.stop + 1)

    def _send(self, robot: RobotState, pose: Pose2D, goal_id: str) -> None:
        robot.goal_id = goal_id
        priority = robot.own_priority if robot.order is None else max(robot.own_priority, robot.order.order.priority)
        is_new, robot.priority = priority != robot.priority, priority
        self._commands[robot.name] = Drive(robot.name, goal_id, pose, priority if is_new else None)

    # --- all of them -------------------------------------------------------------------------------------------------

    def _assign(self, now_ns: int) -> None:
        """Have the policy say who begins with what."""
        free = [robot for robot in self.robots if robot.phase in (FREE, AT_CHARGER) and not robot.works_not
                and not robot.must_charge and not robot.goal_id]
        if not free or not self._open:
            return
        if self._in_turn is None:
            self._in_turn = sorted(self._open.values(), key=lambda one: (-one.order.priority, one.arrived_ns))
        question = Question(list(self._in_turn), [robot.as_free() for robot in free],
                            [robot.as_free() for robot in self.robots if robot.order is not None
                             and not robot.must_charge], now_ns, self._distance)
        for robot, one in self._checked(question, free):
            self._begin(robot, one)

    def _begin(self, robot: RobotState, one: OpenOrder) -> None:
        del self._open[one.order.order_id]
        self._in_turn = None
        self._charging.leave(robot)
        robot.tried_now.clear()
        robot.order, robot.stop, robot.carries = one, one.next_stop, 0
        self._seen[one.order.order_id] += 1
        robot.assigned = self._seen[one.order.order_id]
        self._tell(robot.name, 'order_assigned', one.order.order_id, robot.assigned)
        self._drive(robot)

    def _checked(self, question: Question, free: Sequence[RobotState]) -> List[Tuple[RobotState, OpenOrder]]:
        """Return what the policy chooses, by the robots' indices, if it can be done."""
        known, orders, found = {robot.name: robot for robot in free}, dict(self._open), []
        try:
            pairs = [(str(robot), str(order)) for robot, order in self._policy.choose(question)]
        except (ConfigurationError, MemoryError):
            raise
        except Exception as error:
            raise PolicyError('the policy {} has failed: {}: {}'.format(
                type(self._policy).__name__, type(error).__name__, error)) from error
        for robot, order in pairs:
            one: Optional[OpenOrder] = orders.pop(order, None)
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
