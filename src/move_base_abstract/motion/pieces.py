"""Motion as pieces: the one formula for the pose and the velocity of a robot at an instant, and what follows from it.

C++ (``src/motion/piece.h``) and the replay's JavaScript have the same formula. One table of cases holds all three
(``test/data/pieces.json``). So Python and C++ agree to the last bit, the operations stand in the same order there.
"""
from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from itertools import accumulate
from typing import Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from ..engine.instants import first_ns
from .geometry import Pose2D

_NS_PER_S = 1e9  # a float: the difference of instants becomes one before it is divided, as in C++
_INF = math.inf
new = tuple.__new__  # ``new(Piece, numbers)`` makes a piece of all ten numbers in half the time


class Piece(NamedTuple):
    """A span of a motion that one formula describes; it holds until the next piece begins.

    At ``begin_ns`` [ns] the robot is at ``x``, ``y`` [m] with the heading ``yaw`` [rad], in the global frame. It drives
    along the unit vector (``ux``, ``uy``) with the speed ``v`` [m/s] and the constant acceleration ``a`` [m/s^2], and
    turns at the rate ``w`` [rad/s]. A robot that drives backwards has a negative ``v``, and the vector points against
    its way. With ``k`` [1/s] > 0 speed and turn rate fall exponentially at that rate; 0: they do not. With ``k`` -1 the
    vector turns with the robot, so that the way is an arc, and ``a`` is 0.
    """

    begin_ns: int
    x: float
    y: float
    yaw: float
    ux: float
    uy: float
    v: float = 0.0
    a: float = 0.0
    w: float = 0.0
    k: float = 0.0


#: a piece, and the distance [m] driven before it
Placed = Tuple[Piece, float]


def stand(pose: Pose2D, since_ns: int) -> Piece:
    """Return the piece of a robot that stands at ``pose`` from ``since_ns`` [ns] on."""
    return Piece(since_ns, pose.x, pose.y, pose.yaw, math.cos(pose.yaw), math.sin(pose.yaw))


def gone(piece: Piece, now_ns: int) -> Tuple[float, float]:
    """Return (the way [m] along the piece's vector, the time [s] that its turn took at the first rate)."""
    begin_ns, _, _, _, _, _, v, a, _, k = piece
    elapsed = (now_ns - begin_ns) / _NS_PER_S
    g = elapsed if k <= 0.0 else (1.0 - math.exp(-k * elapsed)) / k
    return v * g + 0.5 * a * elapsed * elapsed, g


def acceleration_of(piece: Piece) -> float:
    """Return the size of the largest acceleration [m/s^2] that occurs in ``piece``."""
    return abs(piece.v * (piece.k if piece.k > 0.0 else piece.w)) if piece.k else abs(piece.a)


def pose_of(piece: Piece, now_ns: int) -> Pose2D:
    """Return the pose at ``now_ns`` [ns] of a robot that moves as ``piece`` says."""
    if piece.k < 0.0:
        return _on_arc(piece, now_ns)
    s, g = gone(piece, now_ns)
    return Pose2D(piece.x + s * piece.ux, piece.y + s * piece.uy, piece.yaw + piece.w * g)


def velocity_of(piece: Piece, now_ns: int) -> Tuple[float, float, float]:
    """Return (forward, lateral [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns], as :func:`pose_of` does."""
    if piece.k < 0.0:
        _, _, _, yaw, ux, uy, v, _, w, _ = piece
        cosine, sine = math.cos(yaw), math.sin(yaw)
        if ux == cosine and uy == sine:  # straight ahead, so that it has the very speed
            return v, 0.0, w
        return v * (ux * cosine + uy * sine), v * (uy * cosine - ux * sine), w
    elapsed = (now_ns - piece.begin_ns) / _NS_PER_S
    h = 1.0 if piece.k == 0.0 else math.exp(-piece.k * elapsed)
    return piece.v * h + piece.a * elapsed, 0.0, piece.w * h


def seconds_over(way: float, speed: float, acceleration: float, rate: float) -> float:
    """Return the time [s] in which a piece covers ``way`` [m]: the inverse of its formula.

    ``speed`` [m/s] >= 0, ``acceleration`` [m/s^2] and ``rate`` [1/s] are those of the piece.
    """
    if way <= 0.0:
        return 0.0
    if rate > 0.0:
        left = 1.0 - rate * way / speed
        return -math.log(left) / rate if left > 0.0 else _INF
    root = speed + math.sqrt(max(0.0, speed * speed + 2.0 * acceleration * way))
    return 2.0 * way / root if root else _INF


def _on_arc(piece: Piece, now_ns: int) -> Pose2D:
    """Return the pose at ``now_ns`` [ns] on an arc: the end of its chord, which halves the angle of its turn."""
    _, x, y, yaw, ux, uy, v, _, w, _ = piece
    elapsed = (now_ns - piece.begin_ns) / _NS_PER_S
    half = 0.5 * w * elapsed
    sine, cosine = math.sin(half), math.cos(half)
    chord = v * elapsed if half == 0.0 else v * elapsed * (sine / half)
    return Pose2D(x + chord * (ux * cosine - uy * sine), y + chord * (uy * cosine + ux * sine), yaw + w * elapsed)


class Motion:
    """What a robot drives from ``depart_ns`` to ``arrive_ns`` [ns]: any instant is answered from its pieces.

    Before the departure it is at its ``start``, from the arrival on at its ``end`` (Pose2D). ``distance`` [m] is the
    length of the way, ``way`` its points ((x, y), ...) [m] between which it is straight, ``corners`` those between its
    ends. The pieces are made at the first question about an instant between the ends. Nothing is integrated, so
    instants may be asked for in any order.
    """

    __slots__ = ('depart_ns', 'arrive_ns', 'start', 'end', 'distance', '_kept')

    depart_ns: int
    arrive_ns: int
    start: Pose2D
    end: Pose2D
    distance: float
    #: whether the robot stands when it begins; otherwise it goes on with the velocity that it has
    is_from_rest = True
    corners: Sequence[Tuple[float, float]] = ()
    _kept: Optional[Tuple[Tuple[Piece, ...], List[float]]]

    def _stretches(self) -> Iterable[Placed]:
        """Return the pieces in order; one that begins before the last one takes its place."""
        raise NotImplementedError

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """The points ((x, y), ...) [m] between which the way is straight, from its start to its end."""
        raise NotImplementedError

    @property
    def duration_ns(self) -> int:
        """The simulated time that the trip takes [ns]."""
        return self.arrive_ns - self.depart_ns

    @property
    def pieces(self) -> Tuple[Piece, ...]:
        """The pieces (Piece, ...) in order; none if the motion takes no time."""
        return self._law()[0]

    def _law(self) -> Tuple[Tuple[Piece, ...], List[float]]:
        """Return (the pieces, the distances [m] driven before each and at the end)."""
        if self._kept is None:
            pieces: List[Piece] = []
            driven: List[float] = []
            for piece, before in self._stretches():
                while pieces and pieces[-1].begin_ns >= piece.begin_ns:
                    pieces.pop()
                    driven.pop()
                if piece.begin_ns < self.arrive_ns:
                    pieces.append(piece)
                    driven.append(before)
            self._kept = tuple(pieces), [*driven, self.distance]
        return self._kept

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose at ``now_ns`` [ns]: the start before the departure, the end from the arrival on."""
        if now_ns < self.depart_ns:
            return self.start
        if now_ns >= self.arrive_ns:
            return self.end
        pieces = self.pieces
        return pose_of(pieces[bisect_right(pieces, (now_ns, _INF)) - 1], now_ns)

    def velocity_at(self, now_ns: int) -> Tuple[float, float, float]:
        """Return (forward, lateral [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns]."""
        if now_ns < self.depart_ns or now_ns >= self.arrive_ns:
            return 0.0, 0.0, 0.0
        pieces = self.pieces
        return velocity_of(pieces[bisect_right(pieces, (now_ns, _INF)) - 1], now_ns)

    def distance_at(self, now_ns: int) -> float:
        """Return the distance [m] driven since the departure, at ``now_ns`` [ns]."""
        if now_ns < self.depart_ns:
            return 0.0
        if now_ns >= self.arrive_ns:
            return self.distance
        pieces, driven = self._law()
        index = bisect_right(pieces, (now_ns, _INF)) - 1
        piece = pieces[index]
        if piece.a < 0.0:  # the same, written so that rounding never makes it fall from one instant to the next
            whole = piece.v / -piece.a
            left = whole - (now_ns - piece.begin_ns) / _NS_PER_S
            way = -0.5 * piece.a * (whole * whole - left * left)
        else:
            way = abs(gone(piece, now_ns)[0])
        return min(driven[index] + way, driven[index + 1])

    def guess_ns(self, distance: float) -> int:
        """Return the instant [ns] at which ``distance`` [m] are driven; rounding may shift it by a few ns."""
        pieces, driven = self._law()
        index = max(0, bisect_left(driven, distance) - 1)
        if index >= len(pieces):
            return self.arrive_ns
        begin_ns, *_, v, a, _, k = pieces[index]
        seconds = seconds_over(distance - driven[index], abs(v), a, k)
        left_ns = self.arrive_ns - begin_ns
        return begin_ns + (int(seconds * _NS_PER_S) if seconds * _NS_PER_S < left_ns else left_ns)

    def covers_ns(self, distance: float) -> int:
        """Return the first instant [ns] at which ``distance`` [m] are driven, or the arrival; it is exact."""
        return first_ns(self.depart_ns, self.arrive_ns, lambda at_ns: self.distance_at(at_ns) >= distance,
                        self.guess_ns(distance))

    def corners_ahead(self, now_ns: int) -> Tuple[Tuple[float, float], ...]:
        """Return the ``corners`` that the robot has not reached at ``now_ns`` [ns]."""
        if not self.corners or now_ns >= self.arrive_ns:
            return ()
        passed = self.distance_at(now_ns)
        points = [(self.start.x, self.start.y), *self.corners]
        lengths = accumulate(math.hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:]))
        return tuple(corner for corner, length in zip(self.corners, lengths) if length > passed)

    def spans(self) -> Iterator[Tuple[Piece, int]]:
        """Yield (a piece, the instant [ns] at which it ends), in order."""
        pieces = self.pieces
        return zip(pieces, (*(piece.begin_ns for piece in pieces[1:]), self.arrive_ns))
