"""The leg durations of the original package of this name (TAROS 2023), to replicate studies published with it.

The facts are from its source, github.com/laurencejbelliott/move_base_abstract: ``main`` at d53d827, ``rasberry`` at
bc8e2f7.

``main``: a leg of the length d > 0 with top speed v and acceleration a takes d/v + v/(2a), however short it is; without
an acceleration it takes d/v. The robot is shown as if it stood for v/(2a) and then drove at v. With pose_update_freq 0
the loop of the original counts whole seconds, so the leg takes the next whole number of seconds.

``rasberry``: a leg takes d/v. The robot is shown half-way as long as it travels.
"""
from __future__ import annotations

import math
from typing import Optional, Tuple

from ..common.units import seconds_to_ns
from .geometry import Pose2D
from .leg import Leg, MotionLimits, Tolerances, trip
from .pace import Pace, PacedLeg
from .pieces import Piece, stand

MAIN, RASBERRY = 'move_base_abstract', 'move_base_abstract_rasberry'
PROFILES = (MAIN, RASBERRY)
#: the default rate at which each profile reports the pose of a robot on its way [Hz, simulated]
POSE_RATES = {MAIN: 0.5, RASBERRY: 0.0}


def is_rasberry(law: Optional[OriginalLaw]) -> bool:
    """Return whether ``law`` (OriginalLaw or None) is that of the branch ``rasberry``."""
    return law is not None and law.profile == RASBERRY


class OriginalLaw:
    """How long a leg takes, and where its robot is meanwhile, in the original's ``profile`` (one of PROFILES)."""

    def __init__(self, profile: str = MAIN, pose_update_freq: float = 1.0) -> None:
        """``pose_update_freq`` [Hz, simulated]: if it is 0, legs of ``main`` last whole seconds."""
        self.profile = profile
        self._is_whole = profile == MAIN and pose_update_freq == 0.0

    def seconds(self, distance: float, limits: MotionLimits) -> float:
        """Return the time [s] that a leg of ``distance`` [m] takes with these MotionLimits."""
        if distance <= 0.0:
            return 0.0
        seconds = distance / limits.max_speed
        if self.profile == MAIN and limits.acceleration != math.inf:
            seconds += limits.max_speed / (2.0 * limits.acceleration)
        return float(math.ceil(seconds)) if self._is_whole else seconds

    def leg(self, start: Pose2D, goal: Pose2D, limits: MotionLimits, depart_ns: int) -> PacedLeg:
        """Return the leg from ``start`` to ``goal`` (Pose2D). Turns take no time, and there are no tolerances."""
        straight = Leg(start, goal, MotionLimits(limits.max_speed), Tolerances(), depart_ns)
        total_ns = seconds_to_ns(self.seconds(straight.distance, limits))
        if self.profile == RASBERRY:
            return HalfwayLeg(straight, Pace(0, 1.0))
        return PacedLeg(straight, Pace(total_ns - straight.duration_ns, 1.0))

    def compare(self, distance: float, limits: MotionLimits) -> str:
        """Return a text that compares the time for ``distance`` [m] by this law with that by the exact one."""
        exact = trip(distance, limits.max_speed, limits.acceleration)[2]
        return "{:.1f} m at {:g} m/s{}: {:.1f} s by the original's formula, {:.1f} s exact".format(
            distance, limits.max_speed, '' if limits.acceleration == math.inf else
            ' with {:g} m/s^2'.format(limits.acceleration), self.seconds(distance, limits), exact)


class HalfwayLeg(PacedLeg):
    """A leg whose robot is shown half-way, with the heading 0, from the end of its delay to the arrival.

    The distance that it has driven grows as on its law.
    """

    __slots__ = ()

    @property
    def pieces(self) -> Tuple[Piece, ...]:
        """The pieces in which the robot stands at its start and half-way; none if the motion takes no time."""
        start, end = self.start, self.end
        stands = ((start, self.depart_ns, self._begin_ns),
                  (Pose2D((start.x + end.x) / 2.0, (start.y + end.y) / 2.0), self._begin_ns, self.arrive_ns))
        return tuple(stand(pose, begin_ns) for pose, begin_ns, end_ns in stands if begin_ns < end_ns)
