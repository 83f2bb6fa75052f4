"""Where on its way a robot comes into zones and lanes, and leaves them: places along a leg, in their order."""
from itertools import accumulate
from math import hypot
from typing import NamedTuple, Optional, Tuple

from .outline import BORDER


class Stay(NamedTuple):
    """A piece of a way in ``area``: from ``begin`` [m] to ``end`` [m] along it, None: it ends inside."""

    area: object
    begin: float
    end: Optional[float]


class Crossing(NamedTuple):
    """At ``distance`` [m] a robot comes into the areas ``enters`` and out of the areas ``leaves``."""

    distance: float
    enters: Tuple
    leaves: Tuple


def stays_in_zones(leg, areas):
    """Return the :class:`Stay` objects of ``leg`` in those of ``areas`` that have an outline, by area."""
    way = leg.way
    xs, ys = [x for x, _ in way], [y for _, y in way]
    x_min, x_max, y_min, y_max = min(xs), max(xs), min(ys), max(ys)
    stays = []
    for area in areas:
        box = area.outline.box
        if x_max <= box[0] or x_min >= box[2] or y_max <= box[1] or y_min >= box[3]:
            continue
        pieces = area.outline.pieces_inside(way)
        length = sum(hypot(x - a, y - b) for (a, b), (x, y) in zip(way, way[1:])) if pieces else 0.0
        for begin, end in pieces:
            ends_inside = end >= length - BORDER and area.outline.contains(*way[-1])
            stays.append(Stay(area, begin, None if ends_inside else end))
    return stays


def stays_on_lanes(leg, area_of):
    """Return the Stays of ``leg`` on lanes; ``area_of(edge)`` gives the area of an edge, or None where it has none."""
    lanes = getattr(leg.corners, 'lanes', ())
    points = [(leg.start.x, leg.start.y), *leg.corners]
    lengths = [hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:])]
    ends = [*accumulate(lengths), leg.distance][:len(lanes)]
    stays, begun = [], 0.0
    for edge, planned_end in zip(lanes, ends):
        area = None if edge is None else area_of(edge)
        end = min(planned_end, leg.distance)
        if area is not None and end > begun:
            if stays and stays[-1].area is area and stays[-1].end == begun:
                stays[-1] = stays[-1]._replace(end=end)
            else:
                stays.append(Stay(area, begun, end))
        begun = end
    if stays and stays[-1].end >= leg.distance and leg.corners.ends_on_lane:
        stays[-1] = stays[-1]._replace(end=None)
    return stays


def crossings(stays, held):
    """Return the :class:`Crossing` objects of ``stays`` in their order, for a robot with places in ``held`` (areas).

    What lies no more than a micrometre apart is one. A place that is held without a stay at the beginning of the way is
    left there.
    """
    at_begin = [stay.area for stay in stays if stay.begin <= BORDER]
    changes = [(0.0, None, area) for area in held if area not in at_begin]
    for area, begin, end in stays:
        if begin > BORDER or area not in held:
            changes.append((begin if begin > BORDER else 0.0, area, None))
        if end is not None:
            changes.append((end, None, area))
    found = []
    for distance, entered, left in sorted(changes, key=lambda change: change[0]):
        if not found or distance - found[-1].distance > BORDER:
            found.append(Crossing(distance, (), ()))
        last = found[-1]
        found[-1] = Crossing(last.distance, last.enters + ((entered,) if entered else ()),
                             last.leaves + ((left,) if left else ()))
    return found
