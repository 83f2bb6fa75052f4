"""Markers of zones, places, lanes, their nodes and spots, with the robots that are there and those that wait."""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Callable, ClassVar, List, Mapping, Optional, Tuple

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from move_base_abstract.maps.lane_map import LaneMap

from . import robot_markers

if TYPE_CHECKING:
    from move_base_abstract.scenario import Scenario
    from move_base_abstract.tasks.places import Place
    from move_base_abstract.tasks.room import Room
    from move_base_abstract.traffic.control import Traffic

    from ..clocks.timing import Clock

OUTLINE, SIGN, HEADS = range(3)
_NODES, _NODE_NAMES = 'nodes', 'node names'  # marker namespaces
_LANE = ColorRGBA(0.35, 0.45, 0.55, 0.6)
_FREE, _FULL = ColorRGBA(0.35, 0.35, 0.35, 0.9), ColorRGBA(0.75, 0.2, 0.05, 0.9)
_OUTLINE_Z, _SIGN_Z = 0.03, 0.2  # m
_MOST_NAMES = 4  # number of waiting robots that a sign names
_CIRCLE = 24  # corners of the outline of a place


@dataclass(frozen=True)
class AreaLook:
    """What does not change: the marker namespace, the frame, corners [(x, y)] [m], and the length of an arrow [m].

    ``is_lane`` says that the corners are those of a line and not of an outline; its sign is in its middle. With
    ``one_way`` such a line has one arrow, along it, and otherwise one in each direction.
    """

    name: str
    frame_id: str
    corners: Tuple[Tuple[float, float], ...]
    size: float
    is_lane: bool = False
    one_way: bool = False


@dataclass(frozen=True)
class Use:
    """The use of an area: its title, the robots in it, its capacity (None: no limit), and the robots that wait."""

    title: str
    inside: Tuple[str, ...] = ()
    capacity: Optional[int] = None
    waiting: Tuple[str, ...] = ()
    closed: bool = False
    #: the attributes of a robot's View: an area is never under way
    goal: ClassVar[Any] = None
    is_changing = False


class AreaMarkers:
    """One zone, place or lane, or all nodes, on the board of its process.

    ``use()`` returns its :class:`Use`; it is called with the clock's lock held. ``markers(look, use)``: those that show
    it.
    """

    def __init__(self, board: Any, look: AreaLook, use: Callable[[], Use],
                 markers: Optional[Callable[[AreaLook, Use], List[Any]]] = None) -> None:
        self.look = look
        self._use = use
        self._markers = markers or draw
        self._drawn = None
        self._board = board
        board.add(self)

    def changed(self) -> None:
        """Ask the board to draw the area soon. This returns at once."""
        self._board.change(self)

    def draw(self, view: Any) -> List[Any]:
        """Return the markers that show the :class:`Use` ``view``; [] if it is the one that was drawn last."""
        if view == self._drawn:
            return []
        self._drawn = view
        return self._markers(self.look, view)

    def forget_drawn(self) -> None:
        """Draw the area next time, since a new subscriber has seen nothing yet."""
        self._drawn = None

    def view(self, _now_ns: int) -> Use:
        """Return the area's :class:`Use`."""
        return self._use()


def add(clock: Clock, scenario: Scenario, traffic: Traffic, rooms: Any) -> None:
    """Draw the zones, places and lanes of a ``scenario`` from now on; ``rooms`` is Rooms, or None without places."""
    nets = list({spec.settings.network.source: spec.settings.network for spec in scenario.robots
                 if isinstance(spec.settings.network, LaneMap)}.values())
    edges = [edge for net in nets for edge in net.edges]
    if not scenario.zones and not edges and not (rooms is not None and rooms.places):
        return
    defaults = scenario.defaults
    board = robot_markers.board(clock, defaults.get('marker_topic', robot_markers.TOPIC))
    frame, size = str(defaults.get('global_frame', 'map')), float(defaults.get('marker_size', 1.0))
    told = _Traffic(traffic, board)
    if edges:
        nodes = {name: (pose.x, pose.y) for net in nets for name, pose in net.nodes.items()}
        AreaMarkers(board, AreaLook(_NODES, frame, (), size), partial(Use, _NODES),
                    lambda look, _use: draw_nodes(look, nodes))
    for kind, name, points, capacity, one_way in [
            *(('zone', zone.name, zone.outline.points, zone.capacity, False) for zone in scenario.zones),
            *(('lane', '{} - {}'.format(edge.begin, edge.end), edge.points, edge.capacity, edge.one_way)
              for edge in edges)]:
        look = AreaLook('{} {}'.format(kind, name), frame, points, size, kind == 'lane', one_way)
        told.areas.append(AreaMarkers(board, look, partial(told.use, kind, name, capacity)))
    for net in nets:
        for name, capacity in net.capacities.items():
            points = (net.nodes[name].x, net.nodes[name].y), *net.spots.get(name, ())
            look = AreaLook('node ' + name, frame, points, size)
            told.areas.append(AreaMarkers(board, look, partial(told.use, 'node', name, capacity), draw_spots))
    for place in (rooms.places.values() if rooms is not None else ()):
        room = rooms.of(place.name)
        outline = _circle(place.pose.x, place.pose.y, place.reach)
        area = AreaMarkers(board, AreaLook('place ' + place.name, frame, outline, size),
                           partial(_use_of_place, place, room))
        if room is not None:
            room.follow(area.changed)


class _Traffic:
    """The use of zones and lanes. After a change of any of them all are read: traffic does not say which it was."""

    def __init__(self, traffic: Traffic, board: Any) -> None:
        self.areas: List[AreaMarkers] = []
        self._traffic = traffic
        self._board = board
        self._states: Any = None
        traffic.follow(self._changed)

    def _changed(self) -> None:
        self._states = None
        if self._board.is_watched():
            for area in self.areas:
                area.changed()

    def use(self, kind: str, name: str, capacity: Any) -> Use:
        """Return the Use of an area. A lane on which no robot drives has no state, but an empty Use."""
        if self._states is None:
            self._states = {(state.kind, state.name): state for state in self._traffic.states()}
        state = self._states.get((kind, name))
        if state is None:
            return Use(name, capacity=capacity)
        return Use(name, state.robots, state.capacity, state.waiting, state.closed)


def _use_of_place(place: Place, room: Room) -> Use:
    title = place.name + (' (parking)' if place.parking else '')
    if room is None or (place.parking and not room.workers):  # robots that park do not work
        return Use(title)
    return Use(title, room.workers, room.capacity, room.waiters)


def _circle(x: float, y: float, radius: float) -> Tuple[Tuple[float, float], ...]:
    steps = [2.0 * math.pi * step / _CIRCLE for step in range(_CIRCLE)]
    return tuple((x + radius * math.cos(step), y + radius * math.sin(step)) for step in steps)


def sign_text(use: Use) -> str:
    """Return the text of an area's sign."""
    first = use.title if use.capacity is None else '{} {}/{}'.format(use.title, len(use.inside), use.capacity)
    lines = [first + (' closed' if use.closed else '')]
    if use.waiting:
        names = list(use.waiting[:_MOST_NAMES]) + (['...'] if len(use.waiting) > _MOST_NAMES else [])
        lines.append('waits: ' + ', '.join(names))
    return '\n'.join(lines)


def draw(look: AreaLook, use: Use) -> List[Any]:
    """Return the markers of an area: its outline, and a sign below it. They are red if no more robots may enter."""
    is_full = use.closed or (use.capacity is not None and len(use.inside) >= use.capacity)
    colour = _FULL if is_full else _LANE if look.is_lane else _FREE
    outline = _marker(look, OUTLINE, Marker.LINE_STRIP, colour)
    outline.scale.x = (0.06 if look.is_lane and use.capacity is None else 0.12) * look.size
    outline.points = [Point(x, y, _OUTLINE_Z) for x, y in look.corners]
    if look.is_lane:
        return [outline, _lane_heads(look, colour), _lane_sign(look, use, colour)]
    outline.points.append(outline.points[0])
    sign = _marker(look, SIGN, Marker.TEXT_VIEW_FACING, colour)
    sign.scale.z = 0.6 * look.size
    sign.text = sign_text(use)
    sign.pose.position.x = sum(x for x, _ in look.corners) / len(look.corners)
    sign.pose.position.y = min(y for _, y in look.corners) - 0.8 * look.size
    sign.pose.position.z = _SIGN_Z
    return [outline, sign]


def draw_spots(look: AreaLook, use: Use) -> List[Any]:
    """Return the markers of a node with a capacity: a ring where each robot stands, and a sign above the node.

    The corners of ``look`` are the node's point and its spots; without spots the ring is around the node. A node for
    one robot has a sign only if a robot waits.
    """
    colour = _FULL if use.closed or (use.capacity is not None and len(use.inside) >= use.capacity) else _FREE
    rings = _marker(look, OUTLINE, Marker.LINE_LIST, colour)
    rings.scale.x = 0.06 * look.size
    node, *spots = look.corners
    for spot in spots or [node]:
        ring = _circle(*spot, 0.4 * look.size)
        lines = [(node, spot), *zip(ring, (*ring[1:], ring[0]))]
        rings.points += [Point(*end, _OUTLINE_Z) for line in lines if line[0] != line[1] for end in line]
    sign = _marker(look, SIGN, Marker.TEXT_VIEW_FACING, colour)
    sign.scale.z = 0.5 * look.size
    sign.text = sign_text(replace(use, title='')).strip()
    sign.pose.position = Point(node[0], node[1] + 0.7 * look.size, _SIGN_Z)
    if use.capacity == 1 and not use.waiting:
        sign.action = Marker.DELETE
    return [rings, sign]


def draw_nodes(look: AreaLook, nodes: Mapping[str, Tuple[float, float]]) -> List[Any]:
    """Return the markers of ``nodes`` {name: (x, y)}: a dot for each, and its name below it."""
    size = look.size
    dots = _marker(look, OUTLINE, Marker.SPHERE_LIST, _FREE)
    dots.scale.x = dots.scale.y = dots.scale.z = 0.3 * size
    dots.points = [Point(x, y, _OUTLINE_Z) for x, y in nodes.values()]
    names = []
    for number, (name, (x, y)) in enumerate(nodes.items()):
        sign = _marker(replace(look, name=_NODE_NAMES), number, Marker.TEXT_VIEW_FACING, _FREE)
        sign.scale.z = 0.4 * size
        sign.text = name
        sign.pose.position = Point(x, y - 0.5 * size, _SIGN_Z)
        names.append(sign)
    return [dots, *names]


def _lane_heads(look: AreaLook, colour: Any) -> Any:
    """Return the arrows of a lane: a head near its middle for each direction in which robots may drive."""
    heads = _marker(look, HEADS, Marker.LINE_LIST, colour)
    heads.scale.x = 0.08 * look.size
    (ax, ay), (bx, by) = _longest_piece(look)
    length = math.dist((ax, ay), (bx, by))
    ux, uy = (bx - ax) / length, (by - ay) / length
    reach = min(0.35 * look.size, 0.25 * length)
    for along in (1.0,) if look.one_way else (1.0, -1.0):
        tip_x, tip_y = (0.5 * (one + other) + along * reach * unit for one, other, unit in ((ax, bx, ux), (ay, by, uy)))
        for side in (0.6, -0.6):
            heads.points += [Point(tip_x, tip_y, _OUTLINE_Z),
                             Point(tip_x - reach * (along * ux + side * uy), tip_y - reach * (along * uy - side * ux),
                                   _OUTLINE_Z)]
    return heads


def _longest_piece(look: AreaLook) -> Tuple[Tuple[float, float], Tuple[float, float]]:
    return max(zip(look.corners, look.corners[1:]), key=lambda piece: math.dist(*piece))


def _lane_sign(look: AreaLook, use: Use, colour: Any) -> Any:
    """Return the sign of a lane: the number of robots on it, its capacity, and the robots that wait.

    A lane that is open, has no capacity, and on which no robot waits has no sign.
    """
    if not use.waiting and use.capacity is None and not use.closed:
        sign = Marker(ns=look.name, id=SIGN, action=Marker.DELETE)
        sign.header.frame_id = look.frame_id
        return sign
    (ax, ay), (bx, by) = _longest_piece(look)
    sign = _marker(look, SIGN, Marker.TEXT_VIEW_FACING, colour)
    sign.scale.z = 0.5 * look.size
    sign.text = sign_text(replace(use, title='')).strip()
    is_upright = abs(by - ay) > abs(bx - ax)  # then the sign lies beside the lane, and otherwise below it
    sign.pose.position.x = 0.5 * (ax + bx) - (3.0 * look.size if is_upright else 0.0)
    sign.pose.position.y = 0.5 * (ay + by) - (0.0 if is_upright else look.size)
    sign.pose.position.z = _SIGN_Z
    return sign


def _marker(look: AreaLook, marker_id: int, kind: int, colour: Any) -> Any:
    marker = Marker(ns=look.name, id=marker_id, type=kind, action=Marker.ADD, color=colour)
    marker.header.frame_id = look.frame_id
    marker.pose.orientation.w = 1.0
    return marker
