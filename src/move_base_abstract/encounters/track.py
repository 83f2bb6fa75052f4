"""What a robot will do as far as it is known: drive its leg, then stand; as spans in which one formula holds."""
from __future__ import annotations

from typing import Any, List, NamedTuple, Tuple

from ..common.units import LAST_NS, NS_PER_S
from ..motion.pieces import acceleration_of

#: the largest number of spans of a track; a longer leg gets spans that are not cut, see Neighbours
MOST_SPANS = 4096


class Span(NamedTuple):
    """A span of time [ns] in which a robot stands, or drives from (x, y) to (to_x, to_y) [m].

    Its acceleration is no more than ``most`` [m/s^2], and it is no more than ``aside`` [m] beside the straight line.
    """

    begin_ns: int
    end_ns: int
    most: float
    x: float
    y: float
    to_x: float
    to_y: float
    aside: float = 0.0


class Track:
    """Where a robot is from ``now_ns`` [ns] on, if nothing interferes.

    ``leg``: the leg under way, or None if the robot stands at ``pose`` (Pose2D). ``spans`` (Span, ...) follow one
    another up to the end of simulated time. None is longer than ``reach`` [m], unless there would be too many.
    """

    __slots__ = ('leg', 'pose', 'end_ns', 'spans')

    def __init__(self, leg: Any, pose: Any, now_ns: int, reach: float) -> None:
        self.leg = leg
        self.pose = pose if leg is None else leg.end
        #: the instant from which on the robot stands [ns]
        self.end_ns: int = now_ns if leg is None else max(now_ns, leg.arrive_ns)
        self.spans: List[Span] = []
        if leg is not None:
            self._cut(leg, now_ns, reach if leg.distance < reach * (MOST_SPANS - 64) else leg.distance)
        end = self.pose
        self.spans.append(Span(self.end_ns, LAST_NS, 0.0, end.x, end.y, end.x, end.y))

    def _cut(self, leg: Any, now_ns: int, reach: float) -> None:
        before_ns, before = now_ns, leg.pose_at(now_ns)
        for piece, piece_end_ns in leg.spans():
            if piece_end_ns <= before_ns:
                continue
            for end_ns in self._instants(leg, before_ns, piece_end_ns, reach):
                end = leg.pose_at(end_ns)
                # a way around a curve is aside by no more than half of its length
                aside = 0.5 * abs(piece.v) * (end_ns - before_ns) / NS_PER_S if piece.k < 0.0 and piece.w else 0.0
                self.spans.append(Span(before_ns, end_ns, acceleration_of(piece), before.x, before.y, end.x, end.y,
                                       aside))
                before_ns, before = end_ns, end

    @staticmethod
    def _instants(leg: Any, begin_ns: int, end_ns: int, reach: float) -> List[int]:
        """Return the ends [ns] of the parts of a piece, each no longer than ``reach`` [m]."""
        begin = leg.distance_at(begin_ns)
        parts = int((leg.distance_at(end_ns) - begin) / reach)
        found = [leg.guess_ns(begin + number * reach) for number in range(1, parts + 1)] if parts else []
        return [*(instant for instant in found if begin_ns < instant < end_ns), end_ns]

    def place_at(self, now_ns: int) -> Tuple[float, float]:
        """Return the position (x, y) [m] at ``now_ns`` [ns], exactly as in the robot's own pose."""
        pose = self.pose if now_ns >= self.end_ns else self.leg.pose_at(now_ns)
        return pose.x, pose.y
