"""The energy that a leg takes until any instant, in closed form: nothing is integrated.

The model is that of rmf_battery (Open Robotics). Changing the speed v takes m a v watts, where a is the size of the
acceleration; braking takes as much as speeding up. In the same way, turning takes I alpha omega watts. Friction takes
f m g v. The first two energies are m and I times the total variation of v^2 / 2 and of omega^2 / 2. Between the
instants at which the law of motion changes, both only rise or only fall, so the variation there is the difference of
two values. A speed that is reached in no time costs as much as one that is reached quickly.
"""
from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING, NamedTuple, Tuple

from ..motion.pieces import velocity_of

if TYPE_CHECKING:
    from ..motion.pieces import Motion

GRAVITY = 9.81  # m/s^2, as in rmf_battery


class Mechanics(NamedTuple):
    """A robot's ``mass`` [kg], ``moment_of_inertia`` about the vertical axis [kg m^2] and ``friction_coefficient``."""

    mass: float
    moment_of_inertia: float
    friction_coefficient: float


class LegEnergy:
    """The energy that a leg of any kind takes.

    ``before``: the kinetic energy (of driving, of turning) [J] with which it begins.
    """

    def __init__(self, leg: Motion, mechanics: Mechanics, before: Tuple[float, float] = (0.0, 0.0)) -> None:
        self._leg = leg
        self._half_mass, self._half_moment = 0.5 * mechanics.mass, 0.5 * mechanics.moment_of_inertia
        self._instants = [piece.begin_ns for piece in leg.pieces]
        self._begins = []  # (energy taken up to then [J], (kinetic energy of driving, of turning) then [J])
        energy, self._before = 0.0, before
        for piece, end_ns in leg.spans():
            at_begin = self._kinetic(piece.v, 0.0, piece.w)
            energy += _change(before, at_begin)
            self._begins.append((energy, at_begin))
            before = self._kinetic(*velocity_of(piece, end_ns - 1))
            energy += _change(at_begin, before)
        self._whole = energy + _change(before, (0.0, 0.0))
        self._friction = mechanics.friction_coefficient * mechanics.mass * GRAVITY

    def until(self, now_ns: int, goes_on: bool = False) -> float:
        """Return the energy [J] from the departure to ``now_ns`` [ns], which is not before the departure.

        ``goes_on``: another leg goes on from there, so that a change of the velocity at that very instant is none.
        """
        friction: float = self._friction * self._leg.distance_at(now_ns)
        if now_ns >= self._leg.arrive_ns:
            return self._whole + friction
        at_ns = max(self._leg.depart_ns, now_ns - 1) if goes_on else now_ns
        energy, at_begin = self._begins[bisect_right(self._instants, at_ns) - 1]
        return energy + _change(at_begin, self._kinetic(*self._leg.velocity_at(at_ns))) + friction

    def stopping(self, now_ns: int) -> float:
        """Return the energy [J] that stopping takes if the robot leaves the leg at ``now_ns`` [ns]."""
        return _change(self._kinetic(*self._leg.velocity_at(now_ns)), (0.0, 0.0))

    def kinetic(self, now_ns: int) -> Tuple[float, float]:
        """Return the kinetic energy (of driving, of turning) [J] just before ``now_ns`` [ns]."""
        return self._before if now_ns <= self._leg.depart_ns else self._kinetic(*self._leg.velocity_at(now_ns - 1))

    def _kinetic(self, forward: float, lateral: float, turning: float) -> Tuple[float, float]:
        return (self._half_mass * forward * forward + self._half_mass * lateral * lateral,
                self._half_moment * turning * turning)


def energy_of_way(distance: float, speed: float, mechanics: Mechanics) -> float:
    """Return the energy [J] of a straight way of ``distance`` [m] from rest to rest, up to ``speed`` [m/s]."""
    if distance <= 0.0:
        return 0.0
    return mechanics.mass * speed * speed + mechanics.friction_coefficient * mechanics.mass * GRAVITY * distance


def _change(one: Tuple[float, float], other: Tuple[float, float]) -> float:
    return abs(one[0] - other[0]) + abs(one[1] - other[1])
