"""Let a fleet drive a plan in plain Python, and compute the outcome."""
from __future__ import annotations

import math
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

from move_base_abstract.common.arguments import check_kind
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import GoalState

from .conflicts import Piece, nearest, plan_conflicts, swap_conflicts, vertex_conflicts
from .execution import POLICIES, Execution
from .layout import Grid, Site
from .movingai import Cell
from .plans import Plan

_MOST_TIMES = 100  # times the length of the plan; then the run is given up


class Outcome(NamedTuple):
    """The outcome of a plan; times in steps. ``flow_time``, ``makespan``: None if not all robots have arrived."""

    policy: str
    agents: int
    arrived: int
    planned_flow_time: int
    planned_makespan: int
    flow_time: Optional[float]
    makespan: Optional[float]
    planned_conflicts: Tuple[int, int]  # vertex, swap
    vertex_conflicts: int
    swap_conflicts: int
    near_pairs: int  # pairs of robots that came nearer than `near`
    near: float  # m
    nearest: Optional[float]  # m; the least distance of these pairs, None if there are none
    retries: int
    waits_for: Dict[str, str]


def check_starts(plan: Plan, site: Site) -> None:
    """Check that robots stand where their paths begin.

    :raises ConfigurationError: naming the first robot that does not, or if the numbers of robots and paths differ.
    """
    robots = site.scenario.robots
    if len(robots) != len(plan.paths):
        raise ConfigurationError('the plan has {} agents, but the scenario has {} robots'.format(
            len(plan.paths), len(robots)))
    for spec, path in zip(robots, plan.paths):
        start, (x, y) = spec.settings.start, site.grid.place(path[0])
        if math.hypot(start.x - x, start.y - y) > 1e-6 * site.grid.size:
            raise ConfigurationError('{}: the plan begins at ({:g}, {:g}), the robot stands at ({:g}, {:g}) [m]'.format(
                spec.name, x, y, start.x, start.y))


class Drive:
    """A fleet that drives a Plan in a Site, from the fleet's first instant on. Call :meth:`run`, then :meth:`outcome`.

    :raises ConfigurationError: if the robots do not stand where their paths begin.
    """

    def __init__(self, site: Site, plan: Plan, policy: str) -> None:
        check_starts(plan, site)
        self.fleet: Any = Fleet(site.scenario, on_end=self._on_end)
        self._site = site
        self._names = [spec.name for spec in site.scenario.robots]
        self._numbers = {name: number for number, name in enumerate(self._names)}
        self.execution = Execution(plan, policy, self.fleet.now_ns, site.step_ns, self._send)

    def run(self) -> None:
        """Drive until all robots have come to their goals, or no robot can go on."""
        fleet, execution = self.fleet, self.execution
        for instant_ns in execution.instants_ns:
            fleet.at(instant_ns, lambda _fleet, now_ns=instant_ns: execution.look(now_ns))
        steps = max(execution.plan.costs) + 1
        end_ns = fleet.now_ns + _MOST_TIMES * steps * self._site.step_ns
        while not execution.is_over and fleet.now_ns < end_ns:
            due_ns = fleet.simulation.next_due_ns()
            if due_ns is None or due_ns > end_ns or (execution.waits_for() and not self._is_anything_left()):
                break
            fleet.run(due_ns)

    def _is_anything_left(self) -> bool:
        return bool(self.fleet.simulation.queue.is_busy())

    def _send(self, robot: int, cell: Cell, towards: Cell) -> None:
        self.fleet.robot(self._names[robot]).send(*self._site.grid.pose(cell, towards))

    def _on_end(self, name: str, _goal_id: str, state: Any, _text: str, now_ns: int) -> None:
        self.execution.ended(self._numbers[name], state is GoalState.SUCCEEDED, now_ns)
        if state is not GoalState.SUCCEEDED:
            again_ns = now_ns + self._site.step_ns
            self.fleet.at(again_ns, lambda _fleet: self.execution.look(again_ns))
        self.execution.look(now_ns)

    def outcome(self, near: float) -> Outcome:
        """Return the :class:`Outcome`; robots that come nearer than ``near`` [m] are counted."""
        execution, step_ns = self.execution, self._site.step_ns
        plan, costs = execution.plan, execution.costs_ns()
        arrived = [cost for cost in costs if cost is not None]
        is_over = len(arrived) == len(costs)
        pairs = nearest(pieces_of(self.fleet.trace, self._site, self._numbers, self.fleet.now_ns), near,
                        step_ns / NS_PER_S)
        return Outcome(
            execution._policy, len(costs), len(arrived), sum(plan.costs), max(plan.costs),
            sum(arrived) / step_ns if is_over else None, max(arrived) / step_ns if is_over else None,
            plan_conflicts(plan), len(vertex_conflicts(execution.visits())),
            len(swap_conflicts(move for moves in execution.done for move in moves)), len(pairs), near,
            min(pairs.values()) if pairs else None, execution.retries,
            {self._names[robot]: self._names[other] for robot, other in execution.waits_for().items()})


def pieces_of(trace: List[Any], site: Site, numbers: Dict[str, int], end_ns: int) -> Iterator[Piece]:
    """Yield where robots were, from the rows departed and stands of a trace, as straight pieces at an even speed."""
    places = [(spec.settings.start.x, spec.settings.start.y) for spec in site.scenario.robots]
    since = [trace[0].time_ns if trace else end_ns] * len(places)
    for time_ns, name, kind, values in trace:
        if kind in ('departed', 'stands') and name in numbers:
            robot = numbers[name]
            place = (values[0], values[1]) if kind == 'stands' else places[robot]
            if time_ns > since[robot]:
                yield Piece(robot, since[robot] / NS_PER_S, time_ns / NS_PER_S, places[robot], place)
            places[robot], since[robot] = place, time_ns
    for robot, place in enumerate(places):
        yield Piece(robot, since[robot] / NS_PER_S, end_ns / NS_PER_S, place, place)


def drive(site: Site, plan: Plan, policy: str) -> Drive:
    """Drive a plan to its end; return the :class:`Drive`.

    :raises ConfigurationError: if an argument is of another kind, or the plan does not fit the site.
    """
    check_kind(site, Site, 'site', 'a Site, as read_folder(folder) returns it')
    check_kind(plan, Plan, 'plan', 'a Plan, as read_plan(path) returns it')
    if policy not in POLICIES:
        raise ConfigurationError('policy: got {}; allowed: {}'.format(shown(policy), ', '.join(POLICIES)))
    done = Drive(site, plan, policy)
    done.run()
    return done


__all__ = ['Drive', 'Grid', 'Outcome', 'check_starts', 'drive', 'pieces_of']
