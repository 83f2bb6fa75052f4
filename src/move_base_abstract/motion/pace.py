"""Legs and routes at a pace that differs from their law. The pose at any instant is still computed exactly."""
from __future__ import annotations

from typing import Iterator, NamedTuple, Tuple

from ..common.units import NS_PER_S
from .pieces import Motion, Piece, Placed, stand


class Pace(NamedTuple):
    """How a leg differs from its law: first ``delay_ns`` [ns] at rest, then all takes ``factor`` times as long."""

    delay_ns: int
    factor: float


class PacedLeg(Motion):
    """A :class:`Leg` or :class:`Route` at a :class:`Pace`: the same way, each place at another instant. Immutable."""

    __slots__ = ('corners', '_leg', '_law_ns', '_begin_ns', '_ns')

    def __init__(self, leg: Motion, pace: Pace) -> None:
        self._leg = leg
        self._kept = None
        self.start, self.end, self.distance, self.corners = leg.start, leg.end, leg.distance, leg.corners
        self._law_ns = leg.duration_ns
        self._ns = int(round(self._law_ns * pace.factor))
        self.depart_ns = leg.depart_ns
        self._begin_ns = leg.depart_ns + pace.delay_ns
        self.arrive_ns = self._begin_ns + self._ns

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """The points ((x, y), ...) [m] between which the leg is straight, from its start to its end."""
        return self._leg.way

    def _stretches(self) -> Iterator[Placed]:
        if self._begin_ns > self.depart_ns:
            yield stand(self.start, self.depart_ns), 0.0
        if not self._law_ns:
            yield stand(self.end, self._begin_ns), self.distance
        elif self._ns:
            pieces, driven = self._leg._law()
            for piece, before in zip(pieces, driven):
                yield self._paced(piece, before)

    def _paced(self, piece: Piece, driven: float) -> Placed:
        """Return a piece of the leg at this pace; it begins at the first nanosecond that is not before its own."""
        elapsed, share = (piece.begin_ns - self.depart_ns) * self._ns, self._law_ns / self._ns
        begin_ns = self._begin_ns - (-elapsed // self._law_ns)  # rounded up
        late = -elapsed % self._law_ns / self._law_ns / NS_PER_S
        _, x, y, yaw, ux, uy, v, a, w, k = piece
        v, a, w, k = v * share, a * share * share, w * share, k * share
        return Piece(begin_ns, x + v * late * ux, y + v * late * uy, yaw + w * late, ux, uy, v + (a - k * v) * late, a,
                     w - k * w * late, k), driven + abs(v) * late


class TimedLeg(PacedLeg):
    """A :class:`Leg` or :class:`Route` that rests ``delay_ns`` [ns] and then takes ``duration_ns`` [ns]."""

    __slots__ = ()

    def __init__(self, leg: Motion, duration_ns: int, delay_ns: int = 0) -> None:
        super().__init__(leg, Pace(delay_ns, 1.0))
        self._ns = duration_ns
        self.arrive_ns = self._begin_ns + duration_ns
