"""From the laws of motion to pieces: a profile says in which phases a way is driven, or a turn is made.

A drive and a turn are made of the same phases: for a turn, read rad instead of m.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, List, NamedTuple, Optional, Sequence, Tuple, Union

from ..common.units import NS_PER_S
from .geometry import Pose2D
from .pieces import Piece, Placed, new, seconds_over

if TYPE_CHECKING:
    from .planned_way import PieceLimit

_SLACK = 1e-3  # ns; an instant that is later than a whole nanosecond by less is that nanosecond


class Phase(NamedTuple):
    """A span of a profile: it begins at ``begin`` [s], after ``covered`` [m], with the ``speed`` [m/s].

    In it the ``acceleration`` [m/s^2] is constant, or the speed falls exponentially at ``rate`` [1/s].
    """

    begin: float
    covered: float
    speed: float
    acceleration: float = 0.0
    rate: float = 0.0

    def at(self, elapsed: float) -> Tuple[float, float]:
        """Return (what is covered [m], the speed [m/s]) at ``elapsed`` [s] after the start of the profile."""
        begin, covered, speed, acceleration, rate = self
        since = elapsed - begin
        if rate:
            h = math.exp(-rate * since)
            return covered + speed * (1.0 - h) / rate, speed * h
        return covered + speed * since + 0.5 * acceleration * since * since, speed + acceleration * since

    def elapsed(self, covered: float) -> float:
        """Return the time [s after the start of the profile] at which ``covered`` [m] are covered."""
        begin, before, speed, acceleration, rate = self
        return begin + seconds_over(covered - before, speed, acceleration, rate)


class Profile(NamedTuple):
    """Travel over ``distance`` [m] in ``seconds`` [s], in ``phases`` (Phase, ...)."""

    distance: float
    seconds: float
    phases: Tuple[Phase, ...]


class Segment(NamedTuple):
    """A straight piece of a route: where it begins [m], its direction [rad], its length [m, > 0] and its PieceLimit."""

    x: float
    y: float
    course: float
    length: float
    limit: Optional[PieceLimit] = None

    def at(self, covered: float) -> Pose2D:
        """Return the pose ``covered`` [m] after its beginning, with the heading along it."""
        return Pose2D(self.x + covered * math.cos(self.course), self.y + covered * math.sin(self.course), self.course)


def even(distance: float, speed: float) -> Profile:
    """Return the profile over ``distance`` [m] at the constant ``speed`` [m/s]."""
    return Profile(distance, distance / speed, (Phase(0.0, 0.0, speed),))


def drive_pieces(begin_ns: int, segments: Sequence[Segment], profile: Profile, driven: float) -> List[Placed]:
    """Return the pieces of a drive along ``segments`` (Segment, ...) that begins at ``begin_ns`` [ns] as ``profile``.

    The robot has ``driven`` so many m before. At each corner a piece begins, at the first nanosecond behind it.
    """
    placed: List[Placed] = []
    following = iter(segments)
    x, y, course, length, _ = next(following)
    ux, uy, before = math.cos(course), math.sin(course), 0.0  # before: the lengths of the segments before this one
    ends = [*[phase.covered for phase in profile.phases[1:]], math.inf]
    for phase, end in zip(profile.phases, ends):
        elapsed = phase.begin
        while True:
            offset_ns = _first_ns(elapsed)
            covered, speed = phase.at(offset_ns / NS_PER_S)
            way = covered - before
            placed.append((new(Piece, (begin_ns + offset_ns, x + way * ux, y + way * uy, course, ux, uy, speed,
                                       phase.acceleration, 0.0, phase.rate)), driven + covered))
            segment = next(following, None) if before + length < end else None
            if segment is None:
                break
            before += length
            x, y, course, length, _ = segment
            ux, uy = math.cos(course), math.sin(course)
            elapsed = phase.elapsed(before)
    return placed


def turn_piece(begin_ns: int, place: Union[Pose2D, Segment], yaw: float, rate: float, driven: float,
               easing: float = 0.0) -> List[Placed]:
    """Return the piece of a turn in place from ``yaw`` [rad], after ``driven`` [m].

    It begins with the ``rate`` [rad/s], which falls exponentially at the rate ``easing`` [1/s].
    """
    return [(new(Piece, (begin_ns, place.x, place.y, yaw, math.cos(yaw), math.sin(yaw), 0.0, 0.0, rate, easing)),
             driven)]


def eased_turn(begin_ns: int, begin: Pose2D, turn: float, profile: Profile, driven: float) -> List[Placed]:
    """Return the pieces of a turn in place by ``turn`` [rad] from the pose ``begin``, which slows down as ``profile``.

    The distance of ``profile`` may be another one than the angle.
    """
    share = turn / profile.distance if profile.distance else 0.0
    placed = []
    for phase in profile.phases:
        offset_ns = _first_ns(phase.begin)
        covered, speed = phase.at(offset_ns / NS_PER_S)
        placed += turn_piece(begin_ns + offset_ns, begin, begin.yaw + share * covered, share * speed, driven,
                             phase.rate)
    return placed


def _first_ns(seconds: float) -> int:
    """Return the first whole nanosecond that is not before ``seconds``."""
    whole = int(seconds)
    return whole * NS_PER_S + math.ceil((seconds - whole) * NS_PER_S - _SLACK)
