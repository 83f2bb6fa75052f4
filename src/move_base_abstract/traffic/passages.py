"""The instants at which a robot on its way enters and leaves an area: computed, never polled."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, List, NamedTuple, Optional

from .outline import BORDER

if TYPE_CHECKING:
    from .outline import Outline


class Passage(NamedTuple):
    """A robot's stay in an area on one leg: ``enter_ns`` and ``leave_ns`` [ns], the latter None if it ends inside.

    From ``enter_ns`` on the robot is at the border or inside; from ``leave_ns`` on it is at the border or outside. Each
    is the first nanosecond at which that is true. A robot that is inside at the departure, or at the border on its way
    in, enters at the departure.
    """

    enter_ns: int
    leave_ns: Optional[int]


def passages(leg: Any, outline: Outline) -> List[Passage]:
    """Return the :class:`Passage` objects of a leg or route through ``outline`` (Outline), in their order.

    A robot enters or leaves when it has driven as far as the border. So if it turns in place there, it enters or leaves
    before the turn.
    """
    way = leg.way
    pieces = outline.pieces_inside(way)
    ends_inside = outline.contains(*way[-1])
    if not pieces:
        return [Passage(leg.depart_ns, None)] if ends_inside and way[0] == way[-1] else []
    length = math.fsum(math.hypot(x - a, y - b) for (a, b), (x, y) in zip(way, way[1:]))
    return [Passage(instant_at(leg, begin) if begin > BORDER else leg.depart_ns,
                    None if ends_inside and end >= length - BORDER else instant_at(leg, end))
            for begin, end in pieces]


def instant_at(leg: Any, distance: float) -> int:
    """Return the first instant [ns] of ``leg`` at which ``distance`` [m] are covered, or the arrival.

    It is exact to the nanosecond, since the distance never decreases.
    """
    due_ns: int = leg.covers_ns(distance)
    return due_ns
