"""Robots that get stuck where their way passes an obstacle too closely: if and where they do, and how goals then end.

A real robot that passes the end of a wall too closely stays there. It gives up each goal that it gets afterwards, after
some seconds without driving, until somebody moves it.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from ..common.units import seconds_to_ns
from ..engine.alarm import Alarm
from ..engine.chance import Purpose
from ..engine.factors import along
from ..goals.outcome import NO_CONTROL

if TYPE_CHECKING:
    from ..common.kinds import Pairs
    from ..engine.chance import Chance
    from ..engine.event_queue import EventQueue
    from ..goals.navigator import Navigator

_WAY_OUT = 1.0  # m; a robot that departs from where it was stuck does not get stuck again on this distance


class Sticking:
    """Finds where on its legs a robot gets stuck, by ``chances`` ((clearance [m], chance), ...); one draw per goal."""

    def __init__(self, chances: Pairs, navigator: Navigator, chance: Chance) -> None:
        self._chances = chances
        self._navigator = navigator
        self._chance = chance
        self._stuck_goal = 0  # the number of the last goal on whose way it got stuck; once per goal is enough
        self._place: Any = None  # where it got stuck

    def due_ns(self, leg: Any) -> Optional[int]:
        """Return the instant [ns] of ``leg`` at which the robot gets stuck, None if it does not or there is no map."""
        occupancy = getattr(self._navigator.planner, 'occupancy', None)
        number = self._navigator.goal_number
        if not self._chances or occupancy is None or number == self._stuck_goal or not leg.distance > 0.0:
            return None
        from ..maps.clearance import ClearanceField  # imported here, since only robots with a map need numpy
        clearance, distance = ClearanceField.on(occupancy, self._chances[-1][0]).least_along(
            leg.way, _WAY_OUT if (leg.start.x, leg.start.y) == self._place else 0.0)
        if self._chance.uniform(number, Purpose.STUCK) >= along(self._chances, clearance):
            return None
        due_ns: int = leg.covers_ns(distance)
        return due_ns

    def got_stuck(self, now_ns: int) -> None:
        """Note that the robot is stuck; on the way to this goal it will not get stuck again."""
        pose = self._navigator.robot.pose_at(now_ns)
        self._stuck_goal, self._place = self._navigator.goal_number, (pose.x, pose.y)


class GivingUp:
    """Gives up each goal of a robot that is stuck, and is held, after ``patience`` [s]; knows if it was moved away."""

    def __init__(self, patience: float, navigator: Navigator, queue: EventQueue, robot_index: int) -> None:
        self._patience_ns = seconds_to_ns(patience)
        self._navigator = navigator
        self._alarm = Alarm(queue, robot_index)
        self._goal_number = 0
        self._place: Any = None

    def begin(self, now_ns: int, keeps_goal: bool) -> None:
        """Note that the robot is stuck from ``now_ns`` [ns] on, where it stands; ``keeps_goal``: it gives none up."""
        pose = self._navigator.robot.pose_at(now_ns)
        self._place, self._goal_number = (pose.x, pose.y), 0
        if not keeps_goal:
            self.goal_changed(now_ns)

    def goal_changed(self, now_ns: int) -> None:
        """Note that the robot has got a goal, or has none any more."""
        navigator = self._navigator
        if not navigator.is_active:
            self._alarm.cancel()
        elif self._alarm.due_ns is None or navigator.goal_number != self._goal_number:
            self._goal_number = navigator.goal_number
            self._alarm.set(now_ns + self._patience_ns, lambda due_ns: navigator.shut_down(NO_CONTROL, due_ns))

    def was_moved(self, now_ns: int) -> bool:
        """Return whether the robot stands somewhere else than where it got stuck."""
        pose = self._navigator.robot.pose_at(now_ns)
        return self._place is not None and (pose.x, pose.y) != self._place

    def end(self) -> None:
        """Note that the robot is no longer stuck."""
        self._place = None
        self._alarm.cancel()

    def shift(self, by_ns: int) -> None:
        """Note that events have been shifted by ``by_ns`` [ns]."""
        self._alarm.shift(by_ns)
