"""When two robots on their ways come near, to the nanosecond, without stepping through time.

Take a span of time in which both robots drive straight on. The difference of their positions would be a straight line
in time if there were no acceleration. It differs from the chord between its ends by at most the *bulge* a h^2 / 8 [m],
where a bounds the acceleration of the difference and h is the length of the span. So the distance to the chord, minus
the bulge, is a lower bound of their distance.

If that bound is too large, the span is left out at once. Otherwise it is halved, and the earlier half comes first,
until the distance surely falls during the whole span, or until the bulge is below BULGE, so that the distance is
convex. (At constant speed there is no bulge, and the quadratic is solved at once.) Then the instant is found by
bisection on the robots' own poses, compared exactly, near the roots of the chords.

So the result is exact. It can only miss a pass that dips below the distance by less than BULGE.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Iterator, NamedTuple, Optional, Tuple

from ..common.geometry import share_along
from ..common.units import NS_PER_S
from ..engine.instants import first_ns

if TYPE_CHECKING:
    from .track import Span, Track

#: the largest bulge that is neglected [m]
BULGE = 1e-7
_CLOSE = 1e-4  # m; the accuracy of the smallest distance
_SURELY = 1e-6  # m; the largest error of an interpolated position in a span
_REFINED = 3  # the number of improvements of a guess
Place = Tuple[float, float]


class Window(NamedTuple):
    """A span of time [ns] in which both robots drive straight on, with the Spans of their tracks."""

    begin_ns: int
    end_ns: int
    one: Span
    other: Span

    @property
    def most(self) -> float:
        """A bound for the sum of their accelerations [m/s^2]."""
        return self.one.most + self.other.most

    def is_surely_beyond(self, radius: float) -> bool:
        """Return whether the ends of the spans suffice to know that they stay further apart than ``radius`` [m]."""
        if self.one.most or self.other.most:
            return False
        (x, y), (to_x, to_y) = _between(self.one, self.begin_ns), _between(self.one, self.end_ns)
        (other_x, other_y), (other_to_x, other_to_y) = (
            _between(self.other, self.begin_ns), _between(self.other, self.end_ns))
        return _on_chord((other_x - x, other_y - y), (other_to_x - to_x, other_to_y - to_y))[1] > radius + _SURELY


def _between(span: Span, now_ns: int) -> Place:
    """Return the interpolated position [m] of a robot at ``now_ns`` [ns] in a span of constant speed."""
    begin_ns, end_ns, _, x, y, to_x, to_y, _ = span
    share = (now_ns - begin_ns) / (end_ns - begin_ns)
    return x + share * (to_x - x), y + share * (to_y - y)


def windows(one: Track, other: Track, from_ns: int, to_ns: int) -> Iterator[Window]:
    """Yield the :class:`Window` objects of two tracks from ``from_ns`` to ``to_ns`` [ns], in order."""
    first, second = iter(one.spans), iter(other.spans)
    a, b = next(first), next(second)
    while from_ns < to_ns:
        end_ns = min(a.end_ns, b.end_ns, to_ns)
        if end_ns > from_ns:
            yield Window(from_ns, end_ns, a, b)
            from_ns = end_ns
        if from_ns < to_ns:
            if a.end_ns <= b.end_ns:
                a = next(first)
            else:
                b = next(second)


def gap(one: Track, other: Track, now_ns: int) -> Place:
    """Return the vector (x, y) [m] from ``one`` to ``other`` at ``now_ns`` [ns]."""
    x, y = one.place_at(now_ns)
    to_x, to_y = other.place_at(now_ns)
    return to_x - x, to_y - y


def distance(one: Track, other: Track, now_ns: int) -> float:
    """Return the distance of two robots [m] at ``now_ns`` [ns]."""
    return math.hypot(*gap(one, other, now_ns))


def first_within(one: Track, other: Track, radius: float, window: Window) -> Optional[int]:
    """Return the first instant [ns] in ``window`` at which they are no further apart than ``radius`` [m], or None."""
    if window.is_surely_beyond(radius):
        return None
    begin_ns, end_ns, most = window.begin_ns, window.end_ns, window.most
    begin, end = gap(one, other, begin_ns), gap(one, other, end_ns)
    if math.hypot(*begin) <= radius:
        return begin_ns
    open_ = [(begin_ns, end_ns, begin, end)]
    while open_:
        begin_ns, end_ns, begin, end = open_.pop()
        bulge = _bulge(most, end_ns - begin_ns)
        share, nearest = _on_chord(begin, end)
        if nearest - bulge > radius:
            continue
        if bulge > BULGE and end_ns - begin_ns > 1 and not _surely_falls(most, end_ns - begin_ns, begin, end):
            middle_ns = (begin_ns + end_ns) // 2
            middle = gap(one, other, middle_ns)
            if math.hypot(*middle) > radius:
                open_.append((middle_ns, end_ns, middle, end))
            open_.append((begin_ns, middle_ns, begin, middle))
            continue
        least_ns = begin_ns + int(math.ceil(share * (end_ns - begin_ns)))
        if distance(one, other, least_ns) <= radius:
            return _falling_to(one, other, radius, begin_ns, least_ns)
    return None


def _falling_to(one: Track, other: Track, radius: float, begin_ns: int, end_ns: int) -> int:
    """Return the first instant [ns] within ``radius`` [m]; the distance falls below it between the two instants."""
    low_ns, high_ns, begin, end = begin_ns, end_ns, gap(one, other, begin_ns), gap(one, other, end_ns)
    guess_ns = begin_ns
    for _ in range(_REFINED):
        guess_ns = low_ns + int(_crossing(begin, end, radius) * (high_ns - low_ns))
        if not low_ns < guess_ns < high_ns:
            break
        place = gap(one, other, guess_ns)
        if math.hypot(*place) <= radius:
            high_ns, end = guess_ns, place
        else:
            low_ns, begin = guess_ns, place
    return first_ns(low_ns, high_ns, lambda at_ns: distance(one, other, at_ns) <= radius, guess_ns)


def first_beyond(one: Track, other: Track, radius: float, window: Window) -> Optional[int]:
    """Return the first instant [ns] in ``window`` at which they are further apart than ``radius`` [m], or None.

    They are no further apart at its beginning. If they are further apart by less than BULGE and come back, the result
    may be None.
    """
    begin_ns, end_ns, most = window.begin_ns, window.end_ns, window.most
    open_ = [(begin_ns, end_ns, gap(one, other, begin_ns), gap(one, other, end_ns))]
    while open_:
        begin_ns, end_ns, begin, end = open_.pop()
        bulge = _bulge(most, end_ns - begin_ns)
        farthest = max(math.hypot(*begin), math.hypot(*end))
        if farthest + (bulge if bulge > BULGE else 0.0) <= radius:
            continue
        if bulge > BULGE and end_ns - begin_ns > 1:
            middle_ns = (begin_ns + end_ns) // 2
            middle = gap(one, other, middle_ns)
            if math.hypot(*middle) <= radius:
                open_.append((middle_ns, end_ns, middle, end))
            open_.append((begin_ns, middle_ns, begin, middle))
            continue
        return first_ns(begin_ns, end_ns, lambda at_ns: distance(one, other, at_ns) > radius)
    return None


def closest(one: Track, other: Track, window: Window) -> Tuple[float, int]:
    """Return (the smallest distance [m] in ``window``, to a tenth of a millimetre; the instant [ns] of it)."""
    begin_ns, end_ns, most = window.begin_ns, window.end_ns, window.most
    begin, end = gap(one, other, begin_ns), gap(one, other, end_ns)
    best = min((math.hypot(*begin), begin_ns), (math.hypot(*end), end_ns))
    open_: Any = [(begin_ns, end_ns, begin, end)]
    while open_:
        begin_ns, end_ns, begin, end = open_.pop()
        share, nearest = _on_chord(begin, end)
        bulge = _bulge(most, end_ns - begin_ns)
        if nearest - bulge > best[0] - _CLOSE:
            continue
        split = bulge > _CLOSE and end_ns - begin_ns > 1
        middle_ns = (begin_ns + end_ns) // 2 if split else begin_ns + int(share * (end_ns - begin_ns))
        middle = gap(one, other, middle_ns)
        best = min(best, (math.hypot(*middle), middle_ns))
        if split:
            open_ += [(middle_ns, end_ns, middle, end), (begin_ns, middle_ns, begin, middle)]
    return best


def _bulge(most: float, duration_ns: int) -> float:
    seconds = duration_ns / NS_PER_S
    return 0.125 * most * seconds * seconds


def _surely_falls(most: float, duration_ns: int, begin: Place, end: Place) -> bool:
    """Return whether the distance surely falls all the time while the difference goes from ``begin`` to ``end`` [m]."""
    seconds = duration_ns / NS_PER_S
    (x, y), (to_x, to_y) = begin, end
    vx, vy, off = (to_x - x) / seconds, (to_y - y) / seconds, 0.5 * most * seconds  # m/s; off: the speed's error
    bulge = 0.25 * off * seconds
    farthest = max(math.hypot(x, y), math.hypot(to_x, to_y)) + bulge
    # The scalar product of position and speed is largest at the end of the chord; all possible errors are added.
    return to_x * vx + to_y * vy + farthest * off + bulge * math.hypot(vx, vy) < 0.0


def _on_chord(begin: Place, end: Place) -> Tuple[float, float]:
    """Return (share in 0..1 of the chord at which it is nearest to the origin, distance there [m])."""
    (x, y), (to_x, to_y), share = begin, end, share_along(begin, end, 0.0, 0.0)
    return share, math.hypot(x + share * (to_x - x), y + share * (to_y - y))


def _crossing(begin: Place, end: Place, radius: float) -> float:
    """Return the share, 0..1, of the chord at which it comes within ``radius`` [m] of the origin, about."""
    (x, y), (to_x, to_y) = begin, end
    dx, dy = to_x - x, to_y - y
    square, half = dx * dx + dy * dy, x * dx + y * dy
    rest = x * x + y * y - radius * radius
    root = math.sqrt(max(0.0, half * half - square * rest))
    # The smaller root, written so that nothing cancels: half < 0 if they come nearer.
    return min(1.0, max(0.0, rest / (root - half))) if root > half else 1.0
