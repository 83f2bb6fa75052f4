"""Goals that are tried several times, as in the branch ``rasberry`` of the original package (see :mod:`.original`).

In that branch an attempt fails with a chance of 0.01 before the robot departs. The robot waits for 5 s and tries again,
at most 3 times; then the goal is aborted. The number of retries is reset only when the robot departs. So if a goal was
aborted and the first attempt of the next goal fails, that goal is aborted at once.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Optional

from ..common.units import seconds_to_ns
from ..engine.chance import Chance, Purpose
from .original import HalfwayLeg
from .pace import Pace

if TYPE_CHECKING:
    from .pieces import Motion


@dataclass(frozen=True)
class Attempts:
    """An attempt fails with ``chance`` (0..1); the robot waits for ``pause`` [s] before each of ``retries`` retries."""

    chance: float = 0.01
    retries: int = 3
    pause: float = 5.0


class GoalAttempts:
    """Apply :class:`Attempts` to the goals of one robot, one after the other. It has the interface of GoalDurations."""

    def __init__(self, attempts: Attempts, seed: int = 0, robot_name: str = '') -> None:
        self._attempts = attempts
        self._draw = Chance(seed, robot_name).uniform
        self._number = 0
        self._used = 0  # retries since the robot last departed
        self._ready_ns: Optional[int] = None
        self._fails = False

    @property
    def failure_text(self) -> str:
        """The text that the client gets when its goal fails."""
        return 'The goal was given up after {} retries'.format(self._attempts.retries)

    def next_goal(self) -> None:
        """Note that the robot begins to work on its next goal."""
        self._number += 1
        self._ready_ns = None

    def paced(self, leg: Motion) -> HalfwayLeg:
        """Return ``leg``, preceded by the pauses of its goal; the robot makes these pauses only once per goal."""
        if self._ready_ns is None:
            self._ready_ns = leg.depart_ns + seconds_to_ns(self._try() * self._attempts.pause)
        return HalfwayLeg(leg, Pace(max(0, self._ready_ns - leg.depart_ns), 1.0))

    def _try(self) -> int:
        """Return the number of pauses before the robot departs or gives up."""
        tried = 0
        while self._draw(self._number, Purpose.ATTEMPT, tried) <= self._attempts.chance:
            if self._used == self._attempts.retries:
                self._fails = True
                return tried
            tried += 1
            self._used += 1
        self._fails, self._used = False, 0
        return tried

    def failure_ns(self, leg: Motion) -> Optional[int]:
        """Return the instant [ns] at which the robot gives up ``leg``, or None if it arrives."""
        return max(leg.depart_ns, self._ready_ns or 0) if self._fails else None

    def interrupted(self, _leg: Motion, _now_ns: int) -> None:
        """Note that the robot was interrupted on its leg and will go on: nothing is drawn again."""
