"""The motion of the Mesa model's robots: straight at constant speed, or from cell to cell in eight directions."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, List, Tuple, Type, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits

if TYPE_CHECKING:
    from ..config import TrialConfig


@dataclass(frozen=True)
class StraightTrip:
    """A straight leg, with the simulator's own law of motion."""

    leg: Leg

    @classmethod
    def between(cls, start: Tuple[float, float], goal: Tuple[float, float], speed: float,
                depart_ns: int) -> StraightTrip:
        """Return the trip from start to goal, (x, y) in the map frame [m], at speed [m/s]."""
        return cls(Leg(Pose2D(*start), Pose2D(*goal), MotionLimits(speed), depart_ns=depart_ns))

    @property
    def arrive_ns(self) -> int:
        """When it ends [ns]."""
        return self.leg.arrive_ns

    def place_at(self, now_ns: int) -> Tuple[float, float]:
        """Return (x, y) [m] at an instant [ns]."""
        pose = self.leg.pose_at(now_ns)
        return pose.x, pose.y

    def bends(self) -> List[Any]:
        """Return the list of (time_ns, x, y) at which its direction changes: an empty one."""
        return []


@dataclass(frozen=True)
class EightWayTrip:
    """Steps between the centres of 2 m cells, diagonal ones first, as in the published Mesa study.

    Each step takes the time of its longer side, so a diagonal step goes 2.83 m in the time of 2 m.
    """

    start: tuple  # (x, y), m
    goal: tuple
    depart_ns: int
    step_ns: int  # time of 2 m at the robot's speed

    STEP_M = 2.0

    @classmethod
    def between(cls, start: Tuple[float, float], goal: Tuple[float, float], speed: float,
                depart_ns: int) -> EightWayTrip:
        """Return the trip from start to goal, (x, y) of centres of cells [m], at speed [m/s] along a cell's edge."""
        return cls(start, goal, depart_ns, seconds_to_ns(cls.STEP_M / speed))

    def _steps(self) -> Tuple[int, int]:
        """Return the signed numbers of steps (along x, along y)."""
        return tuple(round((b - a) / self.STEP_M) for a, b in zip(self.start, self.goal))

    @property
    def arrive_ns(self) -> int:
        """When it ends [ns]."""
        return self.depart_ns + max(map(abs, self._steps())) * self.step_ns

    def place_at(self, now_ns: int) -> Tuple[float, float]:
        """Return (x, y) [m] of its cell at an instant [ns]: it makes a step when the time of the step is over."""
        done = max(0, (now_ns - self.depart_ns) // self.step_ns)
        return tuple(begin + self.STEP_M * math.copysign(min(done, abs(steps)), steps)
                     for begin, steps in zip(self.start, self._steps()))

    def bends(self) -> List[Tuple[int, float, float]]:
        """Return the list of (time_ns, x, y) at which its direction changes: one item if it has both kinds of steps."""
        shorter, longer = sorted(map(abs, self._steps()))
        if shorter in (0, longer):
            return []
        bend_ns = self.depart_ns + shorter * self.step_ns
        return [(bend_ns, *self.place_at(bend_ns))]


MOTIONS = {'euclidean': StraightTrip, 'eight': EightWayTrip}


def motion_named(name: str, config: TrialConfig) -> Union[Type[EightWayTrip], Type[StraightTrip]]:
    """Return the class of trips that a name stands for.

    Eight directions need cells of 2 m, and dwells of whole steps.

    :raises ConfigurationError: for an unknown name, or if the configuration does not allow it.
    """
    if name not in MOTIONS:
        raise ConfigurationError(f'motion must be one of {", ".join(sorted(MOTIONS))}, got {name!r}')
    if name == 'eight':
        step_s = EightWayTrip.STEP_M / config.speed
        if config.cell_m != EightWayTrip.STEP_M:
            raise ConfigurationError(f"motion 'eight' needs cell_m 2, got {config.cell_m}")
        if config.dwell_spread_s or seconds_to_ns(config.dwell_s) % seconds_to_ns(step_s):
            raise ConfigurationError(f"motion 'eight' needs dwells of whole steps of {step_s:g} s, "
                                     f'got {config.dwell_s!r} -+ {config.dwell_spread_s!r}')
    return MOTIONS[name]

