"""A route in the phases of a real robot (:class:`.approach.MotionPhases`). Any instant is still computed exactly."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, List, Sequence, Tuple, Union

from ..common.units import NS_PER_S
from .backwards import Backwards, length_backwards, parted
from .geometry import Pose2D, normalize_angle
from .leg import Tolerances
from .route import CornerLaw, Route, Turn

if TYPE_CHECKING:
    from .approach import ApproachProfile, MotionPhases
    from .leg import MotionLimits
    from .route import Segment


class PhasedRoute(Route):
    """A :class:`Route`, with or without corners, of a robot that begins and ends it by ``phases`` (MotionPhases).

    ``start_turn`` [rad]: the angle by which the robot turns at the start. ``backwards`` (length [m], speed [m/s]): the
    first part of its first drive, which it drives backwards before it turns. ``spin`` (time [s], rate [rad/s]): the
    turning to and fro at the goal, before its last turn.
    """

    __slots__ = ('start_turn', '_phases', '_backwards', '_spin', '_made_of', '_first_length')

    def __init__(self, start: Pose2D, goal: Pose2D, corners: Sequence[Tuple[float, float]], limits: MotionLimits,
                 phases: MotionPhases, tolerances: Tolerances = Tolerances(), depart_ns: int = 0,
                 law: CornerLaw = CornerLaw.KEEP, backwards: Tuple[float, float] = (0.0, 1.0),
                 spin: Tuple[float, float] = (0.0, 0.0)) -> None:
        self._phases, self._backwards, self._spin = phases, backwards, spin
        self._made_of = start, goal, corners, limits, phases, tolerances, depart_ns, law
        self.start_turn = self._first_length = 0.0
        super().__init__(start, goal, corners, limits, tolerances, depart_ns, law)

    @property
    def tail(self) -> Tuple[float, float, float, float]:
        """The motion that is not in its law: (backwards [m], backwards [m/s], spin [s], spin [rad/s])."""
        return (*self._backwards, *self._spin)

    def going_backwards(self, extra: float, speed: float) -> PhasedRoute:
        """Return the route that takes ``extra`` [s] longer because it begins backwards at ``speed`` [m/s].

        If the whole first drive backwards does not take that much longer, all of it is driven backwards.
        """
        limits = self._made_of[3]
        length = length_backwards(extra, self._first_length, speed, lambda rest: self._profile(rest, limits).seconds)
        return PhasedRoute(*self._made_of, backwards=(length, speed)) if length > 0.0 else self

    def spinning(self, extra: float, speed: float) -> PhasedRoute:
        """Return the route that takes ``extra`` [s] longer, by turning to and fro at ``speed`` [rad/s] at the goal."""
        return PhasedRoute(*self._made_of, spin=(extra, speed))

    def _drive(self, pieces: Sequence[Segment], yaw: float, limits: MotionLimits, driven: float) -> float:
        length, speed = self._backwards
        if not self._parts:
            self._first_length = math.fsum(piece.length for piece in pieces)
        if self._parts or not length:
            return super()._drive(pieces, yaw, limits, driven)
        self.start_turn = normalize_angle(pieces[0].course - yaw)
        before, behind = parted(pieces, length)
        part = Backwards(before, speed, yaw, driven)
        self._add(part, part.seconds)
        heading, course = before[-1].course + math.pi, (behind or before)[0 if behind else -1].course
        end = before[-1].at(before[-1].length)
        self._add_turn(end, heading, math.copysign(math.pi, self.start_turn) + normalize_angle(
            course - before[-1].course), self._phases.start_turn_seconds(self.start_turn), driven + length)
        return self._drive_on(behind, limits, driven + length)

    def _add_turn(self, place: Union[Pose2D, Segment], yaw: float, turn: float, seconds: float, driven: float) -> None:
        self._add(Turn(place.x, place.y, yaw, turn, abs(turn) / seconds if seconds else math.inf, driven), seconds)

    def _turn_to_drive(self, first: Segment, yaw: float, turn: float, limits: MotionLimits, driven: float) -> None:
        if not self._parts:
            self.start_turn = turn
        self._add_turn(first, yaw, turn, self._phases.start_turn_seconds(turn), driven)

    def _turn_at_goal(self, begin: Pose2D, turn: float, whole: float, _limits: MotionLimits,
                      tolerances: Tolerances) -> None:
        seconds, speed = self._spin
        if seconds:
            swing = 0.5 * seconds * speed
            self._add_turn(begin, begin.yaw, swing, 0.5 * seconds, self.distance)
            self._add_turn(begin, begin.yaw + swing, -swing, 0.5 * seconds, self.distance)
        length = self.distance + tolerances.xy
        profile = self._phases.end_turn(whole, self.start_turn, length, tolerances.yaw)
        self._add(_EasedTurn(begin, turn, profile, self.distance), profile.seconds)

    def _profile(self, length: float, limits: MotionLimits) -> ApproachProfile:
        return self._phases.drive(length, limits)


class _EasedTurn:
    """A turn in place by ``turn`` [rad] from the pose ``begin``; it slows down towards its end as ``profile`` does."""

    __slots__ = ('_begin', '_turn', '_profile', '_driven')

    def __init__(self, begin: Pose2D, turn: float, profile: ApproachProfile, driven: float) -> None:
        self._begin, self._turn, self._profile, self._driven = begin, turn, profile, driven

    @staticmethod
    def guess(_distance: float) -> None:
        """Return None: the robot drives no distance during a turn."""

    def even_instants(self, ramp_pieces: int) -> List[float]:
        return self._profile.changes(ramp_pieces)

    def smooth(self) -> List[Tuple[float, float]]:
        return [(self._profile.seconds, 0.0)]

    def _of_profile(self, value: float) -> float:
        """Return the angle of the turn [rad], or its rate [rad/s], that corresponds to one of the profile."""
        return self._turn * value / self._profile.distance if self._profile.distance else 0.0

    def pose_at(self, elapsed_ns: int) -> Pose2D:
        turned = self._of_profile(self._profile.covered(elapsed_ns / NS_PER_S))
        return Pose2D(self._begin.x, self._begin.y, self._begin.yaw + turned)

    def velocity_at(self, elapsed_ns: int) -> Tuple[float, float]:
        return 0.0, self._of_profile(self._profile.speed(elapsed_ns / NS_PER_S))

    def distance_at(self, _elapsed_ns: int) -> float:
        return self._driven
