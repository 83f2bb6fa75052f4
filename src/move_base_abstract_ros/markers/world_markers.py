"""What belongs to the world, as markers: zones and places, with who is there and who waits."""
import math
from dataclasses import dataclass
from typing import Optional, Tuple

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from . import robot_markers

OUTLINE, SIGN = range(2)
_FREE, _FULL = ColorRGBA(0.35, 0.35, 0.35, 0.9), ColorRGBA(0.75, 0.2, 0.05, 0.9)
_OUTLINE_Z, _SIGN_Z = 0.03, 0.2  # m
_MOST_NAMES = 4  # of those who wait
_CIRCLE = 24  # corners of the outline of a place


@dataclass(frozen=True)
class AreaLook:
    """What does not change: the marker namespace, the frame, corners [(x, y)] [m], and the length of an arrow [m]."""

    name: str
    frame_id: str
    corners: Tuple[Tuple[float, float], ...]
    size: float


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
        self._board = board
        board.add(self)

    def changed(self):
        """Have it drawn soon; returns at once."""
        self._board.change(self)

    def draw(self, view):
        """Return the markers that show the :class:`Use` ``view``."""
        return draw(self.look, view)

    def forget_drawn(self):
        """Somebody new looks: nothing is left out anyway."""

    def view(self, _now_ns):
        """Return how it is used."""
        return self._use()


def add(clock, scenario, traffic, rooms):
    """Draw the zones and places of a ``scenario`` from now on; ``rooms``: Rooms, or None where there are no places."""
    if not scenario.zones and not (rooms is not None and rooms.places):
        return
    defaults = scenario.defaults
    board = robot_markers.board(clock, defaults.get('marker_topic', robot_markers.TOPIC))
    frame, size = str(defaults.get('global_frame', 'map')), float(defaults.get('marker_size', 1.0))
    zones = [AreaMarkers(board, AreaLook('zone ' + zone.name, frame, zone.outline.points, size),
                         lambda name=zone.name: _use_of_zone(traffic, name)) for zone in scenario.zones]
    traffic.follow(_Changes(zones))
    for place in (rooms.places.values() if rooms is not None else ()):
        room = rooms.of(place.name)
        area = AreaMarkers(board, AreaLook('place ' + place.name, frame, _circle(place), size),
                           lambda place=place, room=room: _use_of_place(place, room))
        if room is not None:
            room.follow(area.changed)


class _Changes:
    """Has all zones drawn that have changed: the traffic says only that some have."""

    def __init__(self, zones):
        self._zones = zones

    def __call__(self):
        for zone in self._zones:
            zone.changed()


def _use_of_zone(traffic, name):
    state = next(state for state in traffic.states() if (state.kind, state.name) == ('zone', name))
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
    colour = _FULL if is_full else _FREE
    outline = _marker(look, OUTLINE, Marker.LINE_STRIP, colour)
    outline.scale.x = 0.12 * look.size
    outline.points = [Point(x, y, _OUTLINE_Z) for x, y in (*look.corners, look.corners[0])]
    sign = _marker(look, SIGN, Marker.TEXT_VIEW_FACING, colour)
    sign.scale.z = 0.6 * look.size
    sign.text = sign_text(use)
    sign.pose.position.x = sum(x for x, _ in look.corners) / len(look.corners)
    sign.pose.position.y = min(y for _, y in look.corners) - 0.8 * look.size
    sign.pose.position.z = _SIGN_Z
    return [outline, sign]


def _marker(look, marker_id, kind, colour):
    marker = Marker(ns=look.name, id=marker_id, type=kind, action=Marker.ADD, color=colour)
    marker.header.frame_id = look.frame_id
    marker.pose.orientation.w = 1.0
    return marker
