"""What belongs to the world, as markers: zones, places and lanes with a capacity, with who is there and who waits."""
import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Optional, Tuple

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from move_base_abstract.maps.lane_map import LaneMap

from . import robot_markers

OUTLINE, SIGN = range(2)
_LANE = ColorRGBA(0.35, 0.45, 0.55, 0.6)
_FREE, _FULL = ColorRGBA(0.35, 0.35, 0.35, 0.9), ColorRGBA(0.75, 0.2, 0.05, 0.9)
_OUTLINE_Z, _SIGN_Z = 0.03, 0.2  # m
_MOST_NAMES = 4  # of those who wait
_CIRCLE = 24  # corners of the outline of a place


@dataclass(frozen=True)
class AreaLook:
    """What does not change: the marker namespace, the frame, corners [(x, y)] [m], and the length of an arrow [m].

    ``is_lane``: the corners are those of a line, not of an outline, and the sign is in its middle, while it is in use.
    """

    name: str
    frame_id: str
    corners: Tuple[Tuple[float, float], ...]
    size: float
    is_lane: bool = False


@dataclass(frozen=True)
class Use:
    """How an area is used: what it is called, who is in it, for how many there is room (None: any), and who waits."""

    title: str
    inside: Tuple[str, ...] = ()
    capacity: Optional[int] = None
    waiting: Tuple[str, ...] = ()
    closed: bool = False
    #: as of a robot's View: an area is never under way
    goal = None
    is_changing = False


class AreaMarkers:
    """One zone or place on the board of its process; ``use()`` returns its :class:`Use`, under the clock's lock."""

    def __init__(self, board, look, use):
        self.look = look
        self._use = use
        self._drawn = None
        self._board = board
        board.add(self)

    def changed(self):
        """Have it drawn soon; returns at once."""
        self._board.change(self)

    def draw(self, view):
        """Return the markers that show the :class:`Use` ``view``, none if that is what was drawn last."""
        if view == self._drawn:
            return []
        self._drawn = view
        return draw(self.look, view)

    def forget_drawn(self):
        """Somebody new looks, who has seen nothing yet."""
        self._drawn = None

    def view(self, _now_ns):
        """Return how it is used."""
        return self._use()


def add(clock, scenario, traffic, rooms):
    """Draw the zones, places and lanes of a ``scenario`` from now on; ``rooms``: Rooms, or None without places."""
    edges = _edges(scenario)
    if not scenario.zones and not edges and not (rooms is not None and rooms.places):
        return
    defaults = scenario.defaults
    board = robot_markers.board(clock, defaults.get('marker_topic', robot_markers.TOPIC))
    frame, size = str(defaults.get('global_frame', 'map')), float(defaults.get('marker_size', 1.0))
    told = _Traffic(traffic, board)
    for kind, name, points, capacity in [
            *(('zone', zone.name, zone.outline.points, zone.capacity) for zone in scenario.zones),
            *(('lane', '{} - {}'.format(edge.begin, edge.end), edge.points, edge.capacity) for edge in edges)]:
        look = AreaLook('{} {}'.format(kind, name), frame, points, size, kind == 'lane')
        told.areas.append(AreaMarkers(board, look, partial(told.use, kind, name, capacity)))
    for place in (rooms.places.values() if rooms is not None else ()):
        room = rooms.of(place.name)
        area = AreaMarkers(board, AreaLook('place ' + place.name, frame, _circle(place), size),
                           lambda place=place, room=room: _use_of_place(place, room))
        if room is not None:
            room.follow(area.changed)


def _edges(scenario):
    """Return the lanes of a scenario, those without a capacity, too: [Edge]."""
    nets = {spec.settings.network.source: spec.settings.network for spec in scenario.robots
            if isinstance(spec.settings.network, LaneMap)}
    return [edge for net in nets.values() for edge in net.edges]


class _Traffic:
    """How zones and lanes are used. All of them are looked at once when any has changed: traffic says no more."""

    def __init__(self, traffic, board):
        self.areas = []  # AreaMarkers
        self._traffic = traffic
        self._board = board
        self._states = None
        traffic.follow(self._changed)

    def _changed(self):
        self._states = None
        if self._board.is_watched():
            for area in self.areas:
                area.changed()

    def use(self, kind, name, capacity):
        """Return the Use of an area; of a lane on which nobody drives there is no state."""
        if self._states is None:
            self._states = {(state.kind, state.name): state for state in self._traffic.states()}
        state = self._states.get((kind, name))
        if state is None:
            return Use(name, capacity=capacity)
        return Use(name, state.robots, state.capacity, state.waiting, state.closed)


def _use_of_place(place, room):
    return Use(place.name) if room is None else Use(place.name, room.workers, room.capacity, room.waiters)


def _circle(place):
    steps = [2.0 * math.pi * step / _CIRCLE for step in range(_CIRCLE)]
    return tuple((place.pose.x + place.reach * math.cos(step), place.pose.y + place.reach * math.sin(step))
                 for step in steps)


def sign_text(use):
    """Return what the sign of an area says."""
    first = use.title if use.capacity is None else '{} {}/{}'.format(use.title, len(use.inside), use.capacity)
    lines = [first + (' closed' if use.closed else '')]
    if use.waiting:
        names = list(use.waiting[:_MOST_NAMES]) + (['...'] if len(use.waiting) > _MOST_NAMES else [])
        lines.append('waits: ' + ', '.join(names))
    return '\n'.join(lines)


def draw(look, use):
    """Return the markers of an area: its outline, and a sign below it; red where nobody more is let in."""
    is_full = use.closed or (use.capacity is not None and len(use.inside) >= use.capacity)
    colour = _FULL if is_full else _LANE if look.is_lane else _FREE
    outline = _marker(look, OUTLINE, Marker.LINE_STRIP, colour)
    outline.scale.x = (0.06 if look.is_lane and use.capacity is None else 0.12) * look.size
    outline.points = [Point(x, y, _OUTLINE_Z) for x, y in look.corners]
    if look.is_lane:
        return [outline, _lane_sign(look, use, colour)]
    outline.points.append(outline.points[0])
    sign = _marker(look, SIGN, Marker.TEXT_VIEW_FACING, colour)
    sign.scale.z = 0.6 * look.size
    sign.text = sign_text(use)
    sign.pose.position.x = sum(x for x, _ in look.corners) / len(look.corners)
    sign.pose.position.y = min(y for _, y in look.corners) - 0.8 * look.size
    sign.pose.position.z = _SIGN_Z
    return [outline, sign]


def _lane_sign(look, use, colour):
    """Return the sign of a lane: how many are on it, and who waits; none while nobody does."""
    if not use.waiting:
        sign = Marker(ns=look.name, id=SIGN, action=Marker.DELETE)
        sign.header.frame_id = look.frame_id
        return sign
    (ax, ay), (bx, by) = max(zip(look.corners, look.corners[1:]), key=lambda piece: math.dist(*piece))
    sign = _marker(look, SIGN, Marker.TEXT_VIEW_FACING, colour)
    sign.scale.z = 0.5 * look.size
    sign.text = sign_text(replace(use, title='')).strip()
    is_upright = abs(by - ay) > abs(bx - ax)  # the sign lies beside it, or below it
    sign.pose.position.x = 0.5 * (ax + bx) - (3.0 * look.size if is_upright else 0.0)
    sign.pose.position.y = 0.5 * (ay + by) - (0.0 if is_upright else look.size)
    sign.pose.position.z = _SIGN_Z
    return sign


def _marker(look, marker_id, kind, colour):
    marker = Marker(ns=look.name, id=marker_id, type=kind, action=Marker.ADD, color=colour)
    marker.header.frame_id = look.frame_id
    marker.pose.orientation.w = 1.0
    return marker
