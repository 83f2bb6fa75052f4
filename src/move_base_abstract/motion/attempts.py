"""Goals that are tried several times, as the branch ``rasberry`` of the original package does (see :mod:`.original`).

There an attempt fails with a chance of 0.01 before the robot departs; the robot waits for 5 s and tries again, at most
3 times, then the goal is aborted. How often it has tried is forgotten only when it departs, so that after an aborted
goal the next one that fails at once is aborted at once.
"""
from dataclasses import dataclass

from ..common.units import seconds_to_ns
from ..engine.chance import Chance, Purpose
from .pace import Pace, PacedLeg


@dataclass(frozen=True)
class Attempts:
    """With ``chance`` (0..1) an attempt fails; the robot waits for ``pause`` [s] before each of ``retries`` more."""

    chance: float = 0.01
    retries: int = 3
    pause: float = 5.0


class GoalAttempts:
    """What :class:`Attempts` mean for the goals of one robot, one after the other; answers as GoalDurations does."""

    def __init__(self, attempts, seed=0, robot_name=''):
        self._attempts = attempts
        self._draw = Chance(seed, robot_name).uniform
        self._number = 0
        self._used = 0  # retries, since the robot departed last
        self._ready_ns = None
        self._fails = False

    @property
    def failure_text(self):
        """What the client of a goal that fails is told."""
        return 'The goal was given up after {} retries'.format(self._attempts.retries)

    def next_goal(self):
        """The robot works on its next goal."""
        self._number += 1
        self._ready_ns = None

    def paced(self, leg):
        """Return ``leg`` behind the pauses of its goal, which are waited for once."""
        if self._ready_ns is None:
            self._ready_ns = leg.depart_ns + seconds_to_ns(self._try() * self._attempts.pause)
        return PacedLeg(leg, Pace(max(0, self._ready_ns - leg.depart_ns), 1.0))

    def _try(self):
        """Return how many pauses there are before the robot departs, or gives up."""
        tried = 0
        while self._draw(self._number, Purpose.ATTEMPT, tried) <= self._attempts.chance:
            if self._used == self._attempts.retries:
                self._fails = True
                return tried
            tried += 1
            self._used += 1
        self._fails, self._used = False, 0
        return tried

    def failure_ns(self, leg):
        """Return at which instant [ns] of ``leg`` the robot gives up, or None: it arrives."""
        return max(leg.depart_ns, self._ready_ns) if self._fails else None

    def interrupted(self, _leg, _now_ns):
        """It will go on: nothing is drawn anew."""
