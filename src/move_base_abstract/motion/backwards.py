"""Driving backwards along the first part of a way, in closed form, and dividing a way for it."""
from __future__ import annotations

import math
from bisect import bisect_right
from itertools import accumulate
from typing import TYPE_CHECKING, Callable, List, Optional, Sequence, Tuple

from ..common.units import NS_PER_S
from .geometry import Pose2D, normalize_angle

if TYPE_CHECKING:
    from .route import Segment

_HALVINGS = 60  # steps of the bisection for a length


class Backwards:
    """Straight ``pieces`` (Segment, ...) that are driven backwards at ``speed`` [m/s], evenly.

    They begin ``driven`` [m] after the departure. Meanwhile the heading turns evenly from ``yaw`` [rad] until the
    robot's back points in the direction in which it drives.
    """

    __slots__ = ('seconds', '_pieces', '_begins', '_speed', '_turn', '_driven')

    def __init__(self, pieces: Sequence[Segment], speed: float, yaw: float, driven: float) -> None:
        ends = list(accumulate(piece.length for piece in pieces))
        self.seconds = ends[-1] / speed
        self._pieces, self._begins, self._speed, self._driven = pieces, [0.0] + ends[:-1], speed, driven
        self._turn = normalize_angle(pieces[0].course + math.pi - yaw)

    def even_instants(self, _ramp_pieces: int) -> List[float]:
        """Return the times [s after its start] at which the robot passes corners."""
        return [begin / self._speed for begin in self._begins]

    def smooth(self) -> List[Tuple[float, float]]:
        """Return the same as :meth:`.leg.SpeedProfile.smooth`: the speed is constant; a span ends at each corner."""
        return [(end, 0.0) for end in (*(begin / self._speed for begin in self._begins[1:]), self.seconds)]

    def guess(self, distance: float) -> Optional[float]:
        """Return when [s after its start] the robot has driven ``distance`` [m] on its leg, None: after its end."""
        covered = distance - self._driven
        return max(0.0, covered) / self._speed if covered <= self._speed * self.seconds else None

    def pose_at(self, elapsed_ns: int) -> Pose2D:
        """Return the pose ``elapsed_ns`` [ns] after its start."""
        elapsed = min(elapsed_ns / NS_PER_S, self.seconds)
        covered = elapsed * self._speed
        index = bisect_right(self._begins, covered) - 1
        place = self._pieces[index].at(covered - self._begins[index])
        left = self._turn * (1.0 - elapsed / self.seconds)
        return Pose2D(place.x, place.y, normalize_angle(place.yaw + math.pi - left))

    def velocity_at(self, _elapsed_ns: int) -> Tuple[float, float]:
        """Return (forward [m/s], turning [rad/s])."""
        return -self._speed, self._turn / self.seconds

    def distance_at(self, elapsed_ns: int) -> float:
        """Return the distance [m] driven since the departure."""
        return self._driven + self._speed * min(elapsed_ns / NS_PER_S, self.seconds)


def parted(pieces: Sequence[Segment], length: float) -> Tuple[List[Segment], List[Segment]]:
    """Return (the first ``length`` [m] of ``pieces`` (Segment, ...), the rest of them), both as lists of Segments."""
    before: List[Segment] = []
    behind: List[Segment] = []
    for piece in pieces:
        begin = length - sum([one.length for one in before], 0.0)
        if begin >= piece.length:
            before.append(piece)
        elif begin <= 0.0 or behind:
            behind.append(piece)
        else:
            place = piece.at(begin)
            before.append(piece._replace(length=begin))
            behind.append(piece._replace(x=place.x, y=place.y, length=piece.length - begin))
    return before, behind


def length_backwards(extra: float, length: float, speed: float, seconds_of: Callable[[float], float]) -> float:
    """Return the length [m] that must be driven backwards at ``speed`` [m/s] to make a drive ``extra`` [s] longer.

    The drive has the whole ``length`` [m]; ``seconds_of(length)`` returns the time [s] of a drive forwards. If even
    driving all of it backwards adds no more than ``extra``, the result is ``length``.
    """
    low, high = 0.0, length
    whole = seconds_of(length)
    if length / speed - whole <= extra:
        return length
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle / speed + seconds_of(length - middle) - whole < extra:
            low = middle
        else:
            high = middle
    return low
