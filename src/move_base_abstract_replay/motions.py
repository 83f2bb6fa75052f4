"""Find where robots are at any instant, from the events of a log: legs by their closed form, and standing poses.

If the log has the robots' limits of motion (rows ``motion``, see robot_trace), their legs are exact. Each is compared
with the end that the log gives. Of other legs only the way is known, so they are drawn at an even speed. A leg with
corners (``route``), a leg of a calibrated robot (``phases``) and a leg at a pace of its own (``manner``) become even
pieces. They are exact in turns and at corners; while the speed changes, they are exact at their ends.
"""
from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Union

from move_base_abstract.common.units import FARTHEST_M, NS_PER_S
from move_base_abstract.motion.approach import MotionPhases
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances
from move_base_abstract.motion.pace import TimedLeg
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.route import CornerLaw, Route

from .charges import Charges
from .constant_speed import even_pieces
from .recording import is_number
from .world import World

if TYPE_CHECKING:
    from .recording import Recording

#: how a robot gets from one pose to the other. PLACED: it is there; EVEN: at an even speed, forwards; BACKWARDS: at an
#: even speed, backwards; LIMITED + n: by the limits with number n
PLACED, EVEN, BACKWARDS, LIMITED = 0, 1, 2, 3
_CLOSE = 1e-6  # m, and rad; a leg may end this far from the end in the log
#: the kinds of events that say where a robot is; see :mod:`move_base_abstract.runs.trace`
KINDS = ('motion', 'phases', 'departed', 'route', 'manner', 'stands')
#: how many numbers of such an event, from the first on, are coordinates; None: all
_COORDINATES: Dict[str, Optional[int]] = {'motion': 2, 'departed': 2, 'stands': 2, 'route': None}
_COUNTS = {'motion': 8, 'phases': 8, 'departed': 3, 'manner': 6, 'stands': 3}  # how many numbers such an event has
_RAMP_PIECES = 8  # the number of pieces for each change of speed on a leg with corners
_PIECE_TURN = 1.0  # rad; a piece must turn by less than half a turn, so that its direction is clear
_MOST_PIECES = 1000  # for one turn, because any program may write an event
_LEAST, _MOST, _MOST_NS = 1e-9, 1e9, 1e18  # the bounds of numbers in events, so that a leg can be computed from them


class Motion(NamedTuple):
    """A piece of a leg, from ``begin_ns`` to ``end_ns``, or a standing pose from ``begin_ns`` on.

    Poses are (x, y, yaw) [m, m, rad]. ``goal`` of an even piece is where it ended. With limits it is the goal of the
    leg, which may have ended before it.
    """

    begin_ns: int
    end_ns: int
    law: int
    start: tuple
    goal: tuple
    is_last: bool = True  # whether it is the last piece of its leg


@dataclass
class Track:
    """The motions of one robot, as the log says them, in the order of time."""

    name: str
    motions: List[Motion] = field(default_factory=list)
    _pose: Optional[tuple] = None
    _limits: Optional[int] = None
    _phases: Optional[MotionPhases] = None
    _departed: Optional[tuple] = None  # (time, start, goal, limits) of the leg under way
    _corners: tuple = ()  # of the leg under way
    _manner: tuple = ()  # of the leg under way: the numbers of its row `manner`
    _law: CornerLaw = CornerLaw.KEEP  # the law of the latest leg with corners that has ended


class Motions:
    """The tracks of all robots of a log: ``tracks`` {name: Track}, ``limits`` all different ones, and what was missing.

    ``limits`` are (max_speed [m/s], acceleration [m/s^2], turn_rate [rad/s], xy tolerance [m], yaw tolerance [rad]); an
    acceleration or turn rate of 0 is no limit. ``world`` (World) says where robots stand at first, and their limits if
    the log does not. ``charges`` (Charges) gets legs and rows in their order.
    """

    def __init__(self, recording: Recording, world: World = World(), charges: Optional[Charges] = None) -> None:
        self.tracks: Any = {}
        self.limits: List[Any] = []
        self.even = 0  # the number of legs without limits in the log
        self.astray = 0  # the number of legs that end elsewhere than their limits say
        self.startless = 0  # the number of legs whose start is not known
        self._numbers: Dict[Any, Any] = {}
        self._charges = charges or Charges(World(), 0)
        for name, start in world.starts.items():
            track = self.tracks[name] = Track(name)
            self._set_limits(track, start.limits)
            self._place(track, recording.begin_ns, start.pose)
        handlers = {kind: getattr(self, '_' + kind) for kind in KINDS}
        for time_ns, name, kind, values in recording:
            handler: Any = handlers.get(kind)
            numbers = _numbers(values) if handler else None
            if numbers is not None and _is_whole(kind, numbers):
                track = self.tracks.get(name)
                if track is None:
                    track = self.tracks[name] = Track(name)
                handler(track, time_ns, numbers)
            self._charges.take(time_ns, name, kind, values)
        for track in self.tracks.values():
            self._close(track, recording.end_ns, None)
        self._charges.close(recording.end_ns)

    def _motion(self, track: Track, time_ns: int, numbers: Sequence[float]) -> None:
        if not (numbers[3] > 0.0 and min(numbers[4:]) >= 0.0):
            return
        self._set_limits(track, numbers[3:])
        if track._departed is None and track._pose != numbers[:3]:
            self._place(track, time_ns, numbers[:3])

    def _set_limits(self, track: Track, limits: Sequence[float]) -> None:
        track._limits = self._numbers.setdefault(limits, len(self._numbers))
        if track._limits == len(self.limits):
            self.limits.append(limits)

    @staticmethod
    def _phases(track: Track, _time_ns: int, numbers: Any) -> None:
        if all(0.0 <= number <= _MOST for number in numbers) and all(number >= _LEAST for number in numbers[2:7]):
            track._phases = MotionPhases(numbers[:2], *numbers[2:])

    def _departed(self, track: Track, time_ns: int, goal: Tuple[float, float, float]) -> None:
        self._close(track, time_ns, None)
        track._departed, track._corners, track._manner = (time_ns, track._pose, goal, track._limits), (), ()
        if track._pose is None:
            self.startless += 1

    @staticmethod
    def _route(track: Track, time_ns: int, numbers: Sequence[float]) -> None:
        if track._departed is not None and track._departed[0] == time_ns:
            track._corners = tuple(zip(numbers[::2], numbers[1::2]))

    @staticmethod
    def _manner(track: Track, time_ns: int, numbers: Any) -> None:
        if track._departed is not None and track._departed[0] == time_ns and (
                all(0.0 <= number <= _MOST_NS for number in numbers) and numbers[3] >= _LEAST):
            track._manner = numbers

    def _stands(self, track: Track, time_ns: int, pose: Tuple[float, float, float]) -> None:
        if not self._close(track, time_ns, pose):
            self._place(track, time_ns, pose)
        track._pose = pose

    def _place(self, track: Track, time_ns: int, pose: Any) -> None:
        track._pose = pose
        track.motions.append(Motion(time_ns, time_ns, PLACED, pose, pose))

    def _close(self, track: Track, time_ns: int, pose: Optional[Tuple[float, float, float]]) -> bool:
        """End the leg under way; return whether the robot's pose is known then.

        ``pose``: where it ends, or None if that is not known.
        """
        if track._departed is None:
            return False
        begin_ns, start, goal, limits = track._departed
        track._departed = None
        if start is None:
            return False
        if (track._corners or track._manner or track._phases) and limits is not None:
            return self._close_way(track, time_ns, pose, (begin_ns, start, goal, self.limits[limits]))
        law = EVEN
        if limits is not None:
            leg = make_leg(start, goal, self.limits[limits], begin_ns)
            end = leg.pose_at(time_ns)
            if pose is None or (time_ns <= leg.arrive_ns and _is_close(end, pose)):
                law = LIMITED + limits
                pose = (end.x, end.y, end.yaw)
                self._charges.drive(track.name, leg, time_ns)
            else:
                self.astray += 1
        else:
            self.even += 1
            if track._corners and pose is not None:
                return self._draw_evenly(track, time_ns, pose, (begin_ns, start, goal))
        if pose is None:
            return False  # it is under way at the end of the log, and it is not known how far
        if law == EVEN:
            self._charges.drive_evenly(track.name, time_ns, math.dist(start[:2], pose[:2]))
        track.motions.append(Motion(begin_ns, time_ns, law, start, goal if law >= LIMITED else pose))
        track._pose = pose
        return True

    def _draw_evenly(self, track: Track, time_ns: int, pose: Any,
                     trip: Tuple[int, Tuple[float, float, float], Tuple[float, float, float]]) -> bool:
        begin_ns, start, goal = trip
        pieces = even_pieces(begin_ns, time_ns, [start, *track._corners, goal], pose)
        self._charges.drive_evenly(track.name, time_ns, sum(math.dist(one[:2], other[:2]) for *_, one, other in pieces))
        for one_ns, other_ns, one, other in pieces:
            track.motions.append(Motion(one_ns, other_ns, EVEN, one, other, other_ns == time_ns))
        track._pose = pose
        return True

    def _close_way(self, track: Track, time_ns: int, pose: Optional[Tuple[float, float, float]],
                   trip: Tuple[int, Tuple[float, float, float], Tuple[float, float, float], Tuple[float, ...]]) -> bool:
        """End a leg with corners, phases or a manner, as _close() does. Its end shows which law it followed at corners.

        ``trip``: (time of departure [ns], start, goal, limits).
        """
        begin_ns, start, goal, _ = trip
        for law in (track._law, *CornerLaw):
            way = _make_way(track, trip, law)
            if pose is None or (time_ns <= way.arrive_ns and _is_close(way.pose_at(time_ns), pose)):
                break
        else:
            self.astray += 1
            return self._draw_evenly(track, time_ns, pose, (begin_ns, start, goal))
        track._law = law
        self._charges.drive(track.name, way, time_ns)
        track.motions.extend(_pieces_of(way, time_ns))
        end = way.pose_at(time_ns)
        track._pose = (end.x, end.y, end.yaw)
        return True


def _make_way(track: Track, trip: Tuple[int, Tuple[float, float, float], Tuple[float, float, float], Tuple[float, ...]],
              law: CornerLaw) -> Union[TimedLeg, PhasedRoute, Route]:
    """Return the leg of a Track as the simulator makes it; ``trip``: (time [ns], start, goal, limits)."""
    begin_ns, begin, end, given = trip
    limits, tolerances = _of_limits(given)
    rest_ns, travel_ns, *tail = track._manner or (0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    start, goal, corners = Pose2D(*begin), Pose2D(*end), track._corners
    way: Route
    if track._phases is not None:
        way = PhasedRoute(start, goal, corners, limits, track._phases, tolerances, begin_ns, law,
                          (tail[0], tail[1]), (tail[2], tail[3]))
    else:
        way = Route(start, goal, corners, limits, tolerances, begin_ns, law)
    return TimedLeg(way, int(travel_ns), int(rest_ns)) if track._manner else way


def _pieces_of(way: Any, end_ns: int) -> Iterator[Motion]:
    """Yield the Motions of a leg (Route, PhasedRoute or TimedLeg) up to ``end_ns`` [ns]."""
    instants = _instants_ns(way, end_ns)
    for one_ns, other_ns in zip(instants, instants[1:]):
        begin, end = way.pose_at(one_ns), way.pose_at(other_ns)
        is_last, forward = other_ns == end_ns, way.velocity_at((one_ns + other_ns) // 2)[0]
        place = (end.x, end.y) if forward else (begin.x, begin.y)  # exactly where it stands or turns
        yaw = end.yaw if is_last else way.pose_at(other_ns - 1).yaw  # the yaw before it jumps to another course
        yield Motion(one_ns, other_ns, BACKWARDS if forward < 0.0 else EVEN, (begin.x, begin.y, begin.yaw),
                     (*place, yaw), is_last)


def _instants_ns(way: Union[TimedLeg, Route], end_ns: int) -> List[int]:
    """Return the instants [ns] at which a leg's pieces begin and end, up to ``end_ns``."""
    even = [instant for instant in way.even_instants_ns(_RAMP_PIECES) if instant < end_ns] + [end_ns]
    instants = even[:1]
    for one_ns, other_ns in zip(even, even[1:]):
        turn = abs(way.velocity_at((one_ns + other_ns) // 2)[1]) * (other_ns - one_ns) / NS_PER_S
        count = min(_MOST_PIECES, other_ns - one_ns, max(1, math.ceil(turn / _PIECE_TURN)))
        instants += [one_ns + number * (other_ns - one_ns) // count for number in range(1, count + 1)]
    return instants


def make_leg(start: Tuple[float, float, float], goal: Tuple[float, float, float], limits: Sequence[float],
             depart_ns: int) -> Leg:
    """Return the simulator's Leg between two poses (x, y, yaw), with ``limits`` as in :class:`Motions`."""
    most, tolerances = _of_limits(limits)
    return Leg(Pose2D(*start), Pose2D(*goal), most, tolerances, depart_ns)


def _of_limits(limits: Sequence[float]) -> Any:
    speed, acceleration, turn_rate, xy, yaw = limits
    return MotionLimits(speed, acceleration or math.inf, turn_rate or math.inf), Tolerances(xy, yaw)


def _is_whole(kind: str, numbers: Sequence[float]) -> bool:
    """Return whether an event of one of KINDS has the right number of numbers, and no place farther than places are."""
    count = len(numbers)
    if not (count >= 2 and count % 2 == 0 if kind == 'route' else count == _COUNTS[kind]):
        return False
    return all(abs(number) <= FARTHEST_M for number in numbers[:_COORDINATES.get(kind, 0)])


def _is_close(end: Pose2D, pose: Tuple[float, float, float]) -> bool:
    turned = math.remainder(end.yaw - pose[2], 2.0 * math.pi)
    return max(abs(end.x - pose[0]), abs(end.y - pose[1]), abs(turned)) <= _CLOSE


def _numbers(text: str) -> Optional[Tuple[float, ...]]:
    """Return a JSON array as a tuple of finite floats, or None if it is not one: any program may write such a row."""
    values = json.loads(text)
    return tuple(map(float, values)) if all(map(is_number, values)) else None
