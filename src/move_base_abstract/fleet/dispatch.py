"""A fleet in plain Python whose robots do the scenario's orders, which its dispatcher gives to them as they arrive.

    dispatch = Dispatch(read_scenario('my_warehouse/scenario.yaml'), policy='batch')
    dispatch.run()
    dispatch.fleet.write_log('run.jsonl')

The decisions are those of the node ``dispatcher``: both use the same core, :class:`.Dispatcher`.
"""
from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any, Callable, Dict, Optional, Sequence, Tuple, Union

from ..common.arguments import check_function, check_kind, check_method
from ..common.kinds import error
from ..common.shown import shown_text
from ..common.units import LAST_NS, far_ahead
from ..motion.geometry import Pose2D, quaternion_of_yaw, yaw_of_quaternion
from ..orders.dispatcher import Drive, GiveUp, PolicyError
from ..orders.order import Order, fault_of
from ..orders.policies import make_policy
from ..orders.rows import DISPATCHER
from ..orders.settings import DispatchSettings
from ..runs.metrics import fleet_metrics
from ..runs.story import Story
from ..scenario import Scenario
from ..tasks.arrivals import NEXT
from .dispatch_world import Decisions, check_levels
from .fleet import SCENARIO, Fleet
from .member import FleetWarning
from .user_calls import AFTER_USERS

if TYPE_CHECKING:
    from ..orders.dispatcher import Command
    from ..orders.policies import Policy
    from ..runs.trace import TraceEntry

#: the place of a decision at its instant: after the events of robots and users, before those of processes
_DECISION = AFTER_USERS - 1
_MOST_TOLD = 5  # orders and robots in a warning


class Dispatch:
    """The :class:`Fleet` (:attr:`fleet`) of a ``scenario``, with a dispatcher that has its robots do orders.

    ``policy``: a name, 'module:Class', or an object with ``choose``; None: the scenario's policy. ``seed``: the seed of
    the orders; None: the scenario's. ``on_event`` and ``options``: see Fleet. The orders' times of arrival count from
    the instant at which this object is made.

    :raises ConfigurationError: if the policy is not one of these, or a robot does not report when its charge passes a
        level that the dispatcher uses.
    """

    def __init__(self, scenario: Scenario, policy: Union[None, str, Policy] = None, seed: Optional[int] = None,
                 on_event: Optional[Callable[[TraceEntry], object]] = None, **options: Any) -> None:
        check_kind(scenario, Scenario, 'scenario', SCENARIO)
        if on_event is not None:
            check_function(on_event, 'on_event(entry)')
        settings = scenario.dispatcher or DispatchSettings()
        check_levels(scenario, settings, 'dispatcher')
        if policy is None or isinstance(policy, str):
            policy = make_policy(policy or settings.policy, 'dispatcher')
        else:
            check_method(policy, 'choose', 'policy', 'a name, or an object with choose(question)')
        self._on_event = on_event
        self.fleet = Fleet(scenario, on_event=self._happened, **options)
        self._decisions = Decisions(scenario, settings, policy, self.fleet.simulation.queue, _DECISION, self._tell,
                                    self._act)
        self.core = self._decisions.core
        self._failure: Optional[str] = None  # the first fault of the policy, as a text
        self._has_waited = False  # whether it was said that an order comes much later
        self._begin_ns = self.fleet.now_ns
        self._orders = scenario.orders(seed)
        self._expect()
        self._decisions.soon(self.fleet.now_ns)

    def order(self, order: Order) -> None:
        """Have an :class:`.Order` arrive now, whatever its time of arrival is; one that cannot be done is refused."""
        check_kind(order, Order, 'order')
        is_wrong = fault_of(order, self.fleet.scenario.places or {}) is not None
        self.core.arrived(order if is_wrong else _as_message(order), self.fleet.now_ns)
        self._decisions.soon(self.fleet.now_ns)

    def run(self, until_ns: Optional[int] = None, until: Optional[float] = None) -> int:
        """Run as :meth:`Fleet.run` does; return the time [ns].

        If nothing is left to happen and orders are not done, or robots not where they were sent, the fleet's last
        warning says which, and why.

        :raises PolicyError: at the end of the run, if the policy failed, or chose something that cannot be done.
        """
        now_ns = self.fleet.run(until_ns, until)
        if not self.fleet.simulation.queue.is_busy():
            self._tell_undone(now_ns)
        failure, self._failure = self._failure, None
        if failure is not None:
            raise PolicyError(failure)
        return now_ns

    def _tell_undone(self, now_ns: int) -> None:
        texts = list(islice(self.core.undone(self._what_holds), _MOST_TOLD))
        if texts:
            more = sum(1 for _ in self.core.undone()) - len(texts)
            text = 'Nothing is left to happen, but this is not done: {}{}'.format(
                '; '.join(texts), '; and {} more'.format(more) if more else '')
            self.fleet._note(FleetWarning(now_ns, DISPATCHER, '', text))

    def _what_holds(self, robot: str) -> str:
        held_for = self.fleet.traffic.what_holds(robot) or ', '.join(
            self.fleet.robot(robot).navigator.travel.held_for)
        return 'held for ' + held_for if held_for else 'which waits'

    def metrics(self) -> Dict[str, Optional[float]]:
        """Return {name: number}: the metrics of orders and of the robots' time so far, as in experiments.

        :raises ConfigurationError: if nothing is recorded (``trace=None``).
        """
        if self.fleet.trace is None:
            raise error('trace', None, 'a list', ', so nothing is known of the past')
        story = Story(self._begin_ns, self.fleet.names)
        for entry in self.fleet.trace:
            story.take(*entry)
        story.close(self.fleet.now_ns)
        return fleet_metrics(story)

    def _expect(self) -> None:
        order = next(self._orders, None)
        if order is not None and self._begin_ns + order.arrival_ns <= LAST_NS:
            due_ns = self._begin_ns + order.arrival_ns
            ahead = not self._has_waited and far_ahead(
                NEXT.format('order', shown_text(order.order_id)), due_ns, self.fleet.now_ns)
            if ahead:
                self._has_waited = True
                self.fleet._note(FleetWarning(self.fleet.now_ns, DISPATCHER, '', ahead))
            self.fleet.at(due_ns, lambda _: self._arrives(order))

    def _arrives(self, order: Order) -> None:
        self.order(order)
        self._expect()

    def _happened(self, entry: TraceEntry) -> None:
        if self.core.hears(entry.robot, entry.kind):
            warning = self.core.happened(entry.robot, entry.kind, entry.values)
            if warning is not None:
                self.fleet._note(FleetWarning(entry.time_ns, entry.robot, '', warning))
            self._decisions.soon(self.fleet.now_ns)
        if self._on_event is not None:
            self._on_event(entry)

    def _act(self, commands: Sequence[Command], now_ns: int) -> None:
        """Carry out the commands one by one, like messages: all that one causes at once comes before the next."""
        for command in commands:
            self.fleet.simulation.queue.schedule(now_ns, _DECISION, lambda _due_ns, _now_ns, command=command: (  # type: ignore[misc]
                self._do(command)))

    def _do(self, command: Command) -> None:
        robot = self.fleet.robot(command.robot)
        if isinstance(command, Drive):
            pose = command.pose
            if command.priority is not None:
                robot.set_priority(command.priority)
            robot.send(pose.x, pose.y, pose.yaw, command.goal_id)
        elif isinstance(command, GiveUp):
            (robot.cancel_task if command.is_work else robot.cancel)(command.goal_id)
        else:
            robot.send_task(command.task, command.goal_id)

    def _tell(self, row: Tuple[Any, ...]) -> None:
        if row[1] == 'policy_failed' and self._failure is None:
            self._failure = row[2]
        row = (self.fleet.now_ns, *row)
        if self.fleet._rows is not None:
            self.fleet._rows.take(row)
        self.fleet._user_calls.tell(row)


def _as_message(order: Order) -> Order:
    """Return an order as it is after being sent as a message: plain numbers, its headings as quaternions and back."""
    def through(pose: Pose2D) -> Pose2D:
        return Pose2D(pose.x, pose.y, yaw_of_quaternion(quaternion_of_yaw(pose.yaw)))
    return replace(order, priority=int(order.priority),
                   stops=tuple(replace(stop, pose=through(stop.pose)) for stop in order.stops))
