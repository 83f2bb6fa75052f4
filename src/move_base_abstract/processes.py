"""Processes that control robots: SimPy's generators on a fleet's own clock. Needs SimPy (3 or 4), but no ROS.

    env = Environment(make_scenario({'robots': [{'name': 'bot', 'max_speed': 2.0}]}))

    def patrol(env, bot):
        for _ in range(3):
            yield bot.go(10.0, 0.0)
            yield env.timeout(5.0)
            yield bot.go(0.0, 0.0)

    env.process(patrol(env, env.robot('bot')))
    env.run(until=60.0)

All of SimPy can be used: processes, interrupts, conditions, resources, stores. Only its heap of events is replaced: all
events are in the fleet's queue, in integer nanoseconds. At one instant the robots' events come first, then SimPy's
urgent events (new processes and interrupts), then all others in the order in which they were scheduled.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

import simpy
from simpy.core import EmptySchedule, StopSimulation
from simpy.events import NORMAL, URGENT, Event

from .common.arguments import as_float, check_kind
from .common.kinds import check_keys
from .common.units import NS_PER_S, check_reachable, seconds_to_ns
from .fleet.fleet import Fleet
from .fleet.member import Member
from .fleet.robot_rows import ROW_KINDS
from .fleet.user_calls import AFTER_USERS
from .goals.outcome import GoalState
from .scenario import Scenario

if TYPE_CHECKING:
    from .maps.occupancy import OccupancyMap
    from .maps.planning import StraightLinePlanner
    from .runs.trace import TraceEntry
    from .tasks.arrivals import Task

__all__ = ['Environment', 'Outcome', 'Robot']


class Outcome(NamedTuple):
    """The ending of a goal or a task: its id, its state, the text for the client, and the instant [ns]."""

    goal_id: str
    state: GoalState
    text: str
    time_ns: int

    @property
    def succeeded(self) -> bool:
        """Whether the goal was reached, or the task was done."""
        return self.state is GoalState.SUCCEEDED


class Robot(Member):
    """A robot for processes. ``go``, ``work`` and ``when`` return events of SimPy, to be yielded or combined."""

    _fleet: _Fleet

    def go(self, x: float, y: float, yaw: float = 0.0) -> Event:
        """Send the robot to (x, y) [m], ``yaw`` [rad], in the frame ``map``; the event's value is an :class:`Outcome`.

        A goal that fails raises no exception: look at ``outcome.succeeded``. A newer goal ends this one as PREEMPTED.
        """
        return self._fleet.env.ending('goal', self.name, self.send(x, y, yaw))

    def work(self, task: Task) -> Event:
        """Have the robot do ``task`` (:class:`.arrivals.Task`) where it stands; the event's value is its Outcome.

        :raises ConfigurationError: if the scenario says nothing of places.
        """
        return self._fleet.env.ending('task', self.name, self.send_task(task))

    def when(self, kind: str, *values: Any) -> Event:
        """Return the event of the robot's next entry of ``kind`` in the trace; its value is that :class:`.TraceEntry`.

        With ``values``, only an entry whose values begin with these counts: ``bot.when('entered', 'zone dock')``.

        :raises ConfigurationError: if there is no such kind.
        """
        self._now_ns()
        check_kind(kind, str, 'kind')
        check_keys({kind: None}, [row.kind for row in ROW_KINDS], "robot '{}'".format(self.name), 'when: ')
        return self._fleet.env.happening(self.name, kind, values)


class _Fleet(Fleet):
    """The fleet of the environment ``env``."""

    _member_type = Robot

    def __init__(self, env: Environment, *options: Any) -> None:
        self.env = env
        super().__init__(*options)


class Environment(simpy.Environment):  # type: ignore[misc]
    """SimPy's environment on a fleet. Times are in seconds and kept in whole nanoseconds, which is exact for 100 days.

    The other arguments are those of :class:`Fleet`. Time begins at ``start_ns`` [ns].
    """

    def __init__(self, scenario: Scenario = Scenario(()), start_ns: int = 0,
                 planner: Optional[StraightLinePlanner] = None, trace: Optional[Iterable[TraceEntry]] = (),
                 occupancy: Optional[OccupancyMap] = None) -> None:
        self._endings: Dict[Tuple[str, str, str], Event] = {}  # {(kind, robot, goal id): event}
        self._happenings: List[Tuple[Event, str, str, Tuple[Any, ...]]] = []  # (event, robot, kind, values)
        self.fleet = _Fleet(self, scenario, start_ns, self._ended('goal'), planner, trace, occupancy,
                            self._ended('task'), self._happened)
        super().__init__()

    @property
    def now(self) -> float:
        """The present simulated time [s]."""
        return self.fleet.now_ns / NS_PER_S

    def robot(self, name: str) -> Robot:
        """Return the :class:`Robot` of that name. :raises ConfigurationError: if there is none."""
        return self.fleet.robot(name)  # type: ignore[return-value]

    @property
    def robots(self) -> List[Robot]:
        """All robots, in the order of their indices."""
        return self.fleet.robots  # type: ignore[return-value]

    def schedule(self, event: Event, priority: int = NORMAL, delay: float = 0) -> None:
        """Have ``event`` happen after ``delay`` [s]; SimPy's events call this."""
        self._put(event, priority, self.fleet.now_ns + seconds_to_ns(delay))

    def run(self, until: Union[None, float, Event] = None) -> Any:
        """Run up to the time ``until`` [s], or until the event ``until`` happens, and return that event's value.

        At the time ``until`` itself the robots' events have happened. As in SimPy, the processes' events of that time
        have not. Without ``until`` the run goes on until no events are left; like :meth:`Fleet.run`, it does not wait
        for batteries to be charged.

        :raises ValueError: if ``until`` is not in the future.
        :raises RuntimeError: if nothing is left to happen and the event ``until`` has not happened.
        """
        if until is None:
            self.fleet.run()
            return None
        if not isinstance(until, Event):
            until = self._stop(as_float(until, 'until'))
        elif until.callbacks is None:
            return until.value
        until.callbacks.append(StopSimulation.callback)
        try:
            self.fleet.run()
        except StopSimulation as stop:
            return stop.args[0]
        raise RuntimeError('nothing is left to happen at {} s, and {} has not happened'.format(self.now, until))

    def step(self) -> None:
        """Let everything of the next instant happen. :raises simpy.core.EmptySchedule: if nothing is left to happen."""
        due_ns = self.fleet.simulation.next_due_ns()
        if due_ns is None:
            raise EmptySchedule
        self.fleet.run(due_ns)

    def peek(self) -> float:
        """Return the time [s] of the next event of a robot or a process; infinity if there is none."""
        due_ns = self.fleet.simulation.next_due_ns()
        return math.inf if due_ns is None else due_ns / NS_PER_S

    def ending(self, kind: str, robot: str, goal_id: str) -> Event:
        """Return the event of the end of a goal or a task that the robot has just got; ``kind``: 'goal' or 'task'."""
        return self._endings.setdefault((kind, robot, goal_id), Event(self))

    def happening(self, robot: str, kind: str, values: Sequence[Any]) -> Event:
        """Return the event of the robot's next entry of ``kind`` in the trace; see :meth:`Robot.when`."""
        self._happenings.append((Event(self), robot, kind, tuple(values)))
        return self._happenings[-1][0]

    def _put(self, event: Event, priority: int, due_ns: int) -> None:
        check_reachable(due_ns, 'an event would be')
        self.fleet.simulation.queue.schedule(
            due_ns, AFTER_USERS + priority, lambda _due_ns, _now_ns: self._happen(event))

    def _happen(self, event: Event) -> None:
        self._queue.append((self.now, NORMAL, 0, event))  # SimPy's own queue, which holds no other event
        super().step()

    def _stop(self, until: float) -> Event:
        until_ns = seconds_to_ns(until)
        if until_ns <= self.fleet.now_ns:
            raise ValueError('until: got {} s; allowed: a time after the present, {} s'.format(until, self.now))
        event = Event(self)
        event._ok, event._value = True, None
        self._put(event, URGENT - 1, until_ns)
        return event

    def _ended(self, kind: str) -> Callable[[str, str, GoalState, str, int], None]:
        def ended(robot: str, goal_id: str, state: GoalState, text: str, now_ns: int) -> None:
            event = self._endings.pop((kind, robot, goal_id), None)
            if event is not None:
                event.succeed(Outcome(goal_id, state, text, now_ns))
        return ended

    def _happened(self, entry: TraceEntry) -> None:
        waiting, self._happenings = self._happenings, []
        for one in waiting:
            event, robot, kind, values = one
            if (robot, kind) == (entry.robot, entry.kind) and values == entry.values[:len(values)]:
                event.succeed(entry)
            else:
                self._happenings.append(one)
