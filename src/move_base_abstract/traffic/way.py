"""Where on its way a robot enters zones and lanes, and where it leaves them: distances along a leg, in order."""
from __future__ import annotations

from itertools import accumulate
from math import hypot
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
)

from ..maps.kept import Kept
from .outline import BORDER

if TYPE_CHECKING:
    from .area import Area
    from .nodes import NodeAreas


class Stay(NamedTuple):
    """A piece of a way in ``area``: from ``begin`` [m] to ``end`` [m] along it, None: the way ends inside."""

    area: Area
    begin: float
    end: Optional[float]


class Crossing(NamedTuple):
    """A point of a way, at ``distance`` [m], at which a robot enters the areas ``enters`` and leaves ``leaves``."""

    distance: float
    enters: Tuple[Area, ...]
    leaves: Tuple[Area, ...]

    def leaves_anyway(self) -> Tuple[Area, ...]:
        """Return the areas that a robot leaves here even if it may not go on.

        At a node with a capacity these are all that end there but the node, in which it stands. Elsewhere there are
        none: the robot keeps its places until it has got the next ones.
        """
        if all(area.point is None for area in self.leaves):
            return ()
        return tuple(area for area in self.leaves if area.point is None)


class ZoneIndex:
    """Finds zones by coordinates: ``areas`` (Area, ...), which have outlines, in the order in which they are given."""

    def __init__(self, areas: Iterable[Any]) -> None:
        self._stays: Callable[..., Tuple[Stay, ...]] = Kept(lambda way: tuple(self._find_stays(way)), len)
        self._boxes = sorted(((*area.outline.box, number, area) for number, area in enumerate(areas)),
                             key=lambda box: box[0])

    def near(self, x_min: float, y_min: float, x_max: float, y_max: float) -> List[Any]:
        """Return the areas whose bounding boxes overlap this box [m]; a common border is not enough."""
        found = []
        for left, low, right, high, number, area in self._boxes:
            if left >= x_max:
                break
            if right > x_min and low < y_max and high > y_min:
                found.append((number, area))
        return [area for _, area in sorted(found, key=lambda one: one[0])]

    def stays(self, way: Tuple[Tuple[float, float], ...]) -> Tuple[Stay, ...]:
        """Return the :class:`Stay` objects of ``way`` ((x, y), ...) [m] by area. They are cached, since ways repeat."""
        return self._stays(way)

    def _find_stays(self, way: Tuple[Tuple[float, float], ...]) -> Iterator[Stay]:
        xs, ys = [x for x, _ in way], [y for _, y in way]
        for area in self.near(min(xs), min(ys), max(xs), max(ys)):
            pieces = area.outline.pieces_inside(way)
            length = sum(hypot(x - a, y - b) for (a, b), (x, y) in zip(way, way[1:])) if pieces else 0.0
            for begin, end in pieces:
                ends_inside = end >= length - BORDER and area.outline.contains(*way[-1])
                yield Stay(area, begin, None if ends_inside else end)

    def at(self, x: float, y: float) -> List[Area]:
        """Return the areas that contain (x, y) [m]."""
        return [area for area in self.near(x, y, x, y) if area.outline.contains(x, y)]


def stays_on_lanes(leg: Any, area_of: Callable[[int], Optional[Area]]) -> List[Stay]:
    """Return the Stays of ``leg`` on lanes; ``area_of(edge)`` returns the area of an edge, or None if it has none."""
    stays: List[Any] = []
    begun = 0.0
    for edge, end, _ in _pieces(leg):
        area = None if edge is None else area_of(edge)
        if area is not None and end > begun:
            if stays and stays[-1].area is area and stays[-1].end == begun:
                stays[-1] = stays[-1]._replace(end=end)
            else:
                stays.append(Stay(area, begun, end))
        begun = end
    if stays and stays[-1].end >= leg.distance and leg.corners.ends_on_lane:
        stays[-1] = stays[-1]._replace(end=None)
    return stays


def stays_at_nodes(leg: Any, node_at: Callable[[Optional[int], Tuple[float, float]], Optional[Area]]) -> List[Stay]:
    """Return the Stays of ``leg`` at nodes.

    Each begins where the lane to the node begins, or the straight way to it off the net, and ends where the next lane
    begins. ``node_at(edge, point)`` returns the area of the node at (x, y) [m], an end of ``edge``, or None if it has
    none. The node at which a leg begins has no stay: a robot that stands there holds its place.
    """
    stays: List[Stay] = []
    begun = 0.0
    pieces = _pieces(leg)
    for number, (edge, end, point) in enumerate(pieces):
        is_last = number + 1 == len(pieces) or end >= leg.distance
        is_end = is_last or edge is None or pieces[number + 1][0] != edge
        area = node_at(edge, point) if is_end and not (is_last and leg.corners.ends_on_lane) else None
        if area is not None and end > begun:
            if stays and (stays[-1].area, stays[-1].end) == (area, begun):  # it goes on to its spot
                begun = stays.pop().begin
            stays.append(Stay(area, begun, None if is_last else end))
        if is_last:
            break
        if area is not None or pieces[number + 1][0] != edge:
            begun = end
    return stays


def stays_of(way: Any, zones: ZoneIndex, area_of: Callable[[int], Optional[Area]], nodes: NodeAreas) -> List[Stay]:
    """Return the Stays of ``way``, a leg or a WayBack on a net, in ``zones``, on lanes and at ``nodes``.

    ``area_of(edge)`` returns the area of an edge, or None if it has none.
    """
    at_nodes = stays_at_nodes(way, nodes.end_of) if nodes.areas else ()
    stays = [*zones.stays(way.way), *stays_on_lanes(way, area_of), *at_nodes]
    for node in nodes.at(way.start.x, way.start.y):
        stays = _from_spot(stays, node)
    return stays


def _from_spot(stays: Sequence[Stay], node: Area) -> List[Stay]:
    """Return the Stays of a way that begins at a spot of ``node``: there a robot asks for the first lane already."""
    first = next((stay.end for stay in stays if stay.area is node and stay.begin == 0.0), None)
    return [stay._replace(begin=0.0) if stay.begin == first else stay for stay in stays
            if first is None or stay.area is not node]


def _pieces(leg: Any) -> List[Tuple[Optional[int], float, Tuple[float, float]]]:
    """Return (edge, end [m] along the leg, end (x, y) [m]) of each piece of a leg on a net; edge None: off the net."""
    lanes = getattr(leg.corners, 'lanes', ())
    points = [(leg.start.x, leg.start.y), *leg.corners]
    lengths = [hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:])]
    ends = [*accumulate(lengths), leg.distance][:len(lanes)]
    return [(edge, min(end, leg.distance), point) for edge, end, point in zip(lanes, ends, [*points[1:], leg.way[-1]])]


def with_groups(stays: Sequence[Stay]) -> Sequence[Stay]:
    """Return ``stays`` and the stays in the groups of their areas; adjacent stays in one group become one stay."""
    of_groups: Dict[Area, List[Stay]] = {}
    for stay in sorted((stay for stay in stays if stay.area.group is not None), key=lambda stay: stay.begin):
        group: Any = stay.area.group
        own = of_groups.setdefault(group, [])
        if own and (own[-1].end is None or stay.begin <= own[-1].end + BORDER):
            is_inside = own[-1].end is None or stay.end is None
            own[-1] = own[-1]._replace(end=None if is_inside else max(own[-1].end or 0.0, stay.end or 0.0))
        else:
            own.append(Stay(group, stay.begin, stay.end))
    return [*stays, *(stay for own in of_groups.values() for stay in own)] if of_groups else stays


def crossings(stays: Iterable[Stay], held: Mapping[Area, bool]) -> List[Crossing]:
    """Return the :class:`Crossing` objects of ``stays`` in their order, for a robot with places in ``held`` (areas).

    Crossings no more than a micrometre apart are one. If the robot holds a place in an area without a stay at the
    beginning of the way, it leaves that area there.
    """
    at_begin = [stay.area for stay in stays if stay.begin <= BORDER]
    changes: List[Tuple[float, Optional[Area], Optional[Area]]] = [
        (0.0, None, area) for area in held if area not in at_begin]
    for area, begin, end in stays:
        if begin > BORDER or area not in held:
            changes.append((begin if begin > BORDER else 0.0, area, None))
        if end is not None:
            changes.append((end, None, area))
    found: List[Tuple[float, List[Area], List[Area]]] = []
    for distance, entered, left in sorted(changes, key=lambda change: change[0]):
        if not found or distance - found[-1][0] > BORDER:
            found.append((distance, [], []))
        if entered is not None:
            found[-1][1].append(entered)
        if left is not None:
            found[-1][2].append(left)
    return [Crossing(distance, tuple(enters), tuple(leaves)) for distance, enters, leaves in found]
