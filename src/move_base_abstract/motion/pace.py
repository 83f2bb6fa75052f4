"""Legs and routes at a pace that differs from their law. The pose at any instant is still computed exactly."""
from __future__ import annotations

from typing import TYPE_CHECKING, List, NamedTuple, Tuple, Union

if TYPE_CHECKING:
    from ..common.geometry import Pose2D
    from .leg import Leg
    from .route import Route

    AnyLeg = Union[Leg, Route, 'PacedLeg']


class Pace(NamedTuple):
    """How a leg differs from its law: first ``delay_ns`` [ns] at rest, then all takes ``factor`` times as long."""

    delay_ns: int
    factor: float


#: PhasedRoute.tail of a leg that has no tail
_NO_TAIL = (0.0, 1.0, 0.0, 0.0)


class PacedLeg:
    """A :class:`Leg` or :class:`Route` at a :class:`Pace`: the same poses, each at another instant. Immutable."""

    __slots__ = ('depart_ns', 'arrive_ns', 'start', 'end', 'distance', 'corners', '_leg', '_law_ns', '_begin_ns', '_ns')

    depart_ns: int
    arrive_ns: int
    start: Pose2D
    end: Pose2D
    distance: float
    corners: Tuple[Tuple[float, float], ...]
    _begin_ns: int
    _ns: int

    @property
    def manner(self) -> Tuple[float, ...]:
        """How it differs from its law: the delay at the start [ns], the travel time [ns], and the leg's ``tail``."""
        return (self._begin_ns - self.depart_ns, self._ns, *self.tail)

    @property
    def tail(self) -> Tuple[float, float, float, float]:
        """The same as :attr:`.phased_route.PhasedRoute.tail`."""
        tail: Tuple[float, float, float, float] = getattr(self._leg, 'tail', _NO_TAIL)
        return tail

    def __init__(self, leg: AnyLeg, pace: Pace) -> None:
        self._leg = leg
        self.start, self.end, self.distance, self.corners = leg.start, leg.end, leg.distance, leg.corners
        self._law_ns = leg.duration_ns
        self._ns = int(round(self._law_ns * pace.factor))
        self.depart_ns = leg.depart_ns
        self._begin_ns = leg.depart_ns + pace.delay_ns
        self.arrive_ns = self._begin_ns + self._ns

    @property
    def duration_ns(self) -> int:
        """The simulated time that the trip takes, including the delay [ns]."""
        return self.arrive_ns - self.depart_ns

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """The points ((x, y), ...) [m] between which the leg is straight, from its start to its end."""
        return self._leg.way

    def even_instants_ns(self, ramp_pieces: int) -> List[int]:
        """Return the same as :meth:`.route.Route.even_instants_ns`; the delay at the start is one piece."""
        of_law = self._leg.duration_ns
        inner = [instant - self.depart_ns for instant in self._leg.even_instants_ns(ramp_pieces)] if of_law else []
        # Rounded up, since _leg_ns rounds down.
        paced = (self._begin_ns + -(-elapsed * self._ns // of_law) for elapsed in inner)
        return sorted({self.depart_ns, self._begin_ns, *paced, self.arrive_ns})

    def smooth_ns(self) -> List[Tuple[int, float]]:
        """Return the same as :meth:`.route.Route.smooth_ns`; the delay at the start is one span."""
        of_law = self._leg.duration_ns
        if not of_law or not self._ns:
            return [(self.arrive_ns, 0.0)]
        begin_ns, square = self._begin_ns, (of_law / self._ns) ** 2
        return [(begin_ns, 0.0), *((begin_ns - (self.depart_ns - end_ns) * self._ns // of_law, most * square)
                                   for end_ns, most in self._leg.smooth_ns())]

    def distance_at(self, now_ns: int) -> float:
        """Return the distance [m] driven since the departure, at ``now_ns`` [ns]."""
        return self._leg.distance_at(self._leg_ns(now_ns))

    def guess_ns(self, distance: float) -> int:
        """Return the instant [ns] at which ``distance`` [m] are driven; rounding may shift it by a few ns."""
        whole_ns = self._leg.duration_ns
        elapsed_ns = self._leg.guess_ns(distance) - self._leg.depart_ns
        return self._begin_ns + (elapsed_ns * self._ns // whole_ns if whole_ns else self._ns)

    def covers_ns(self, distance: float) -> int:
        """Return the same as :meth:`.leg.Leg.covers_ns`: the inverse of :meth:`_leg_ns`, without a search."""
        elapsed_ns = self._leg.covers_ns(distance) - self._leg.depart_ns
        if elapsed_ns == 0:
            return self.depart_ns
        return self._begin_ns - (-elapsed_ns * self._ns // self._law_ns)  # rounded up

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose at ``now_ns`` [ns]: the start until the delay is over, the end from the arrival on."""
        if now_ns < self._begin_ns:
            return self.start  # the leg itself would already have its first heading if its turns take no time
        return self._leg.pose_at(self._leg_ns(now_ns))

    def velocity_at(self, now_ns: int) -> Tuple[float, float]:
        """Return (forward [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns]."""
        if not self._begin_ns <= now_ns < self.arrive_ns:
            return 0.0, 0.0
        share = self._law_ns / self._ns
        law_ns = self.depart_ns + (now_ns - self._begin_ns) * self._law_ns // self._ns  # as _leg_ns, without a call
        forward, turning = self._leg.velocity_at(law_ns)
        return forward * share, turning * share

    def corners_ahead(self, now_ns: int) -> Tuple[Tuple[float, float], ...]:
        """Return the ``corners`` that the robot has not reached at ``now_ns`` [ns]."""
        return self._leg.corners_ahead(self._leg_ns(now_ns))

    def _leg_ns(self, now_ns: int) -> int:
        """Return the instant [ns] of the leg's own law that corresponds to ``now_ns`` [ns] at this pace."""
        if now_ns >= self.arrive_ns:
            return max(now_ns, self._leg.arrive_ns)
        elapsed_ns = now_ns - self._begin_ns
        return self.depart_ns + (elapsed_ns * self._law_ns // self._ns if elapsed_ns > 0 else 0)


class TimedLeg(PacedLeg):
    """A :class:`Leg` or :class:`Route` that rests ``delay_ns`` [ns] and then takes ``duration_ns`` [ns]."""

    __slots__ = ()

    def __init__(self, leg: AnyLeg, duration_ns: int, delay_ns: int = 0) -> None:
        super().__init__(leg, Pace(delay_ns, 1.0))
        self._ns = duration_ns
        self.arrive_ns = self._begin_ns + duration_ns
