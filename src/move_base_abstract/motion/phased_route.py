"""A route in the phases of a real robot (:class:`.approach.MotionPhases`). Any instant is still computed exactly."""
from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Sequence, Tuple, Union

from .backwards import backwards_pieces, length_backwards, parted
from .geometry import Pose2D, normalize_angle
from .leg import Tolerances
from .phases import Profile, eased_turn, even, turn_piece
from .route import CornerLaw, Route

if TYPE_CHECKING:
    from .approach import MotionPhases
    from .leg import MotionLimits
    from .phases import Segment


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
        profile = even(math.fsum(piece.length for piece in before), speed)
        self._add(partial(backwards_pieces, segments=before, profile=profile, yaw=yaw, driven=driven), profile.seconds)
        heading, course = before[-1].course + math.pi, (behind or before)[0 if behind else -1].course
        end = before[-1].at(before[-1].length)
        self._turn_for(end, heading, math.copysign(math.pi, self.start_turn) + normalize_angle(
            course - before[-1].course), self._phases.start_turn_seconds(self.start_turn), driven + length)
        return self._drive_on(behind, limits, driven + length)

    def _turn_for(self, place: Union[Pose2D, Segment], yaw: float, turn: float, seconds: float, driven: float) -> None:
        """Add a turn by ``turn`` [rad] that takes ``seconds`` [s], at an even rate."""
        if seconds:
            self._add(partial(turn_piece, place=place, yaw=yaw, rate=turn / seconds, driven=driven), seconds)

    def _turn_to_drive(self, first: Segment, yaw: float, turn: float, limits: MotionLimits, driven: float) -> None:
        if not self._parts:
            self.start_turn = turn
        self._turn_for(first, yaw, turn, self._phases.start_turn_seconds(turn), driven)

    def _turn_at_goal(self, begin: Pose2D, turn: float, whole: float, _limits: MotionLimits,
                      tolerances: Tolerances) -> None:
        seconds, speed = self._spin
        if seconds:
            swing = 0.5 * seconds * speed
            self._turn_for(begin, begin.yaw, swing, 0.5 * seconds, self.distance)
            self._turn_for(begin, begin.yaw + swing, -swing, 0.5 * seconds, self.distance)
        length = self.distance + tolerances.xy
        profile = self._phases.end_turn(whole, self.start_turn, length, tolerances.yaw)
        self._add(partial(eased_turn, begin=begin, turn=turn, profile=profile, driven=self.distance), profile.seconds)

    def _profile(self, length: float, limits: MotionLimits) -> Profile:
        return self._phases.drive(length, limits)
