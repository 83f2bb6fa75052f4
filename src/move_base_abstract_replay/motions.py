"""Find where robots are at any instant, from the events of a log: the pieces of their legs, and standing poses.

If the log has the pieces of a leg (rows ``pieces``, see :mod:`move_base_abstract.motion.told`), the leg is exact. Of
other legs only the ends are known, so they are drawn straight, at an even speed.
"""
from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional

from move_base_abstract.common.units import FARTHEST_M, NS_PER_S
from move_base_abstract.motion.geometry import Pose2D, normalize_angle
from move_base_abstract.motion.pieces import Motion, Piece, stand
from move_base_abstract.motion.told import ToldMotion, motion_of_row

from .charges import Charges
from .recording import is_number
from .world import World

if TYPE_CHECKING:
    from .recording import Recording

#: the kinds of events that say where a robot is, and how many numbers such an event has; pieces: any number
_COUNTS = {'motion': 8, 'departed': 3, 'driven': 6, 'pieces': 0, 'stands': 3}
_MOST_PIECES = 2000  # of one leg of a robot that is driven by velocities, from rest to rest
_CLOSE = 1e-6  # m, and rad; a leg may end this far from the end in the log


class Driven(NamedTuple):
    """A leg as far as it was driven, up to ``end_ns``; or standing from an instant on, which ends then."""

    end_ns: int
    motion: Motion


class Track:
    """The motions of one robot, as the log says them, in the order of time."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.driven: List[Driven] = []
        self.pose: Optional[Pose2D] = None
        self.departed_ns: Optional[int] = None  # when its leg under way began
        self.pieces: List[Piece] = []  # of the leg under way, the last one at rest; none: not known
        self.driven_ns: Optional[int] = None  # when it was last driven by another velocity


class Motions:
    """The motions of all robots of a Recording: ``tracks`` {robot: Track}, and what was missing.

    ``world`` (World) says where robots stand at first. ``charges`` (Charges) gets legs and rows in their order.
    """

    def __init__(self, recording: Recording, world: World = World(), charges: Optional[Charges] = None) -> None:
        self.tracks: Dict[str, Track] = {}
        self.even = 0  # the number of legs without pieces in the log
        self.startless = 0  # the number of these whose start is not known
        self._charges = charges or Charges(World(), 0)
        for name, start in world.starts.items():
            self._place(self._track(name), recording.begin_ns, start.pose)
        for time_ns, name, kind, text in recording:
            values = _values(kind, text) if kind in _COUNTS else None
            if values:
                getattr(self, '_' + kind)(self._track(name), time_ns, values)
            self._charges.take(time_ns, name, kind, text)
        for track in self.tracks.values():
            self._close(track, recording.end_ns, None)
        self._charges.close(recording.end_ns)

    def _track(self, name: str) -> Track:
        return self.tracks.setdefault(name, Track(name))

    def _motion(self, track: Track, time_ns: int, values: List[float]) -> None:
        pose = Pose2D(*values[:3])
        if track.departed_ns is None and track.pose != pose:
            self._place(track, time_ns, pose)

    def _departed(self, track: Track, time_ns: int, _goal: List[float]) -> None:
        self._close(track, time_ns, None)
        track.departed_ns, track.pieces = time_ns, []

    def _driven(self, track: Track, time_ns: int, values: List[float]) -> None:
        if track.departed_ns is None or not track.pieces or len(track.pieces) >= _MOST_PIECES:
            pose = Pose2D(*values[:3])
            if not self._close(track, time_ns, pose) and track.pose != pose:
                self._place(track, time_ns, pose)
            track.departed_ns, track.pieces = time_ns, []
        track.driven_ns = time_ns

    @staticmethod
    def _pieces(track: Track, time_ns: int, told: ToldMotion) -> None:
        """Take the pieces of a departure, or, of a robot that is driven by velocities, how it goes on."""
        goes_on = bool(track.pieces) and track.driven_ns == time_ns
        if told.depart_ns == time_ns and (goes_on or track.departed_ns == time_ns):
            while track.pieces and track.pieces[-1].begin_ns >= time_ns:
                track.pieces.pop()
            track.pieces += [*told.pieces, stand(told.end, told.arrive_ns)]

    def _stands(self, track: Track, time_ns: int, values: List[float]) -> None:
        pose = Pose2D(*values)
        if not self._close(track, time_ns, pose):
            self._place(track, time_ns, pose)
        track.pose = pose

    @staticmethod
    def _place(track: Track, time_ns: int, pose: Pose2D) -> None:
        track.pose = pose
        track.driven.append(Driven(time_ns, ToldMotion([stand(pose, time_ns)])))

    def _close(self, track: Track, time_ns: int, pose: Optional[Pose2D]) -> bool:
        """End the leg under way at ``pose``, None: not known; return whether it is drawn, and ends there."""
        if track.departed_ns is None:
            return False
        motion: Optional[ToldMotion] = ToldMotion(track.pieces) if track.pieces else None
        if motion is None:
            self.even += 1
            self.startless += track.pose is None
            motion = _even(track.pose, pose, track.departed_ns, time_ns) if track.pose and pose else None
        track.departed_ns = None
        if motion is None:
            return False  # under way at the end of the log, for example, and it is not known how far
        track.driven.append(Driven(time_ns, motion))
        track.pose = motion.pose_at(time_ns)
        self._charges.drive(track.name, motion, time_ns)
        return pose is None or _is_close(track.pose, pose)


def _even(start: Pose2D, end: Pose2D, begin_ns: int, end_ns: int) -> ToldMotion:
    """Return the motion straight from ``start`` to ``end`` at an even speed, or the even turn, between two instants."""
    rest, way, seconds = stand(end, end_ns), start.distance_to(end), (end_ns - begin_ns) / NS_PER_S
    if end_ns <= begin_ns:
        return ToldMotion([rest])
    if not way:
        turn = stand(start, begin_ns)._replace(w=normalize_angle(end.yaw - start.yaw) / seconds)
        return ToldMotion([turn, rest])
    ahead = stand(Pose2D(start.x, start.y, start.bearing_to(end)), begin_ns)
    return ToldMotion([ahead._replace(v=way / seconds), rest])


def _is_close(one: Pose2D, other: Pose2D) -> bool:
    return max(abs(one.x - other.x), abs(one.y - other.y), abs(normalize_angle(one.yaw - other.yaw))) <= _CLOSE


def _values(kind: str, text: str) -> Any:
    """Return the values of an event, or None if they are not what the kind has: any program may write such a row."""
    values: List[Any] = json.loads(text)
    if kind == 'pieces':
        return motion_of_row(values)
    good = len(values) == _COUNTS[kind] and all(map(is_number, values)) and max(map(abs, values[:2])) <= FARTHEST_M
    return [float(value) for value in values] if good else None
