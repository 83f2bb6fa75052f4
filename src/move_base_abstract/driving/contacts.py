"""Which driven robots of one process touch a wall or one another, and when: then they stall.

Each new motion of a robot is looked at up to LOOK_NS ahead, and again after that time while it lasts.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Tuple

from ..common.ros_names import natural_order
from ..motion.pieces import Piece, pose_of, stand
from .contact import FREE, NEARER, REACH, Course, Limit, Shape, disc, first_touch, gap_of, limit_of
from .driver import WALL

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..maps.occupancy import OccupancyMap
    from ..motion.pieces import Motion
    from .driver import Driver
    from .walls import Walls

LOOK_NS = 500_000_000
AT_ONCE_NS = 1_000_000  # what is touched within this time by a robot that stands at it is touched at once
_NS_PER_S = 1e9
_Spans = List[Tuple[Piece, int]]


class Contacts:
    """The driven robots of one process; those with different global frames are in different worlds."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self._bodies: Dict[int, Body] = {}  # in the order of their names

    def join(self, driver: Driver, frame: str, shape: Shape) -> None:
        """Add the robot of ``driver`` (Driver), which stands: a body of ``shape`` (Shape) in the global ``frame``."""
        robot = driver.robot
        body = driver.body = self._bodies[robot.index] = Body(self, driver, frame, shape)
        self._bodies = dict(sorted(self._bodies.items(), key=lambda one: natural_order(one[1].robot.name)))
        body.moved(self.simulation.now_ns)
        robot.follow(body.moved)

    def leave(self, body: Body) -> None:
        """Note that the robot is removed."""
        self._forget(body)
        del self._bodies[body.robot.index]
        self.retry(body, self.simulation.now_ns)

    def holds(self, body: Body) -> bool:
        """Return whether the robot is still there."""
        return self._bodies.get(body.robot.index) is body

    def others(self, body: Body, now_ns: int) -> List[Body]:
        """Return the other robots of the same world whose clock shows ``now_ns`` [ns], too, by name."""
        return [other for other in self._bodies.values()
                if other is not body and other.frame == body.frame and other.since_ns <= now_ns]

    def look(self, body: Body, now_ns: int) -> None:
        """Find what the robot will touch first in the next LOOK_NS, from ``now_ns`` [ns] on."""
        self._forget(body)
        until_ns = now_ns + LOOK_NS
        spans, motion = body.spans(body.motion, now_ns, until_ns), body.motion
        if motion is not None:
            touch_ns = body.touches_wall(spans, now_ns)
            if touch_ns is not None:
                body.ahead[None] = self._schedule(
                    touch_ns - 1, now_ns, body, lambda at_ns: body.driver.stall(at_ns, WALL))
            elif motion.arrive_ns > until_ns:
                body.ahead[None] = self._schedule(until_ns, now_ns, body, lambda at_ns: self.look(body, at_ns))
        for other in self.others(body, now_ns):
            if body.may_meet(other, now_ns):
                touch_ns = _meeting_ns(body, spans, other, other.spans(other.motion, now_ns, until_ns), now_ns)
                if touch_ns is not None:
                    one, two = (body, other) if body.robot.index < other.robot.index else (other, body)
                    one.ahead[two.robot.index] = two.ahead[one.robot.index] = self._schedule(
                        touch_ns - 1, now_ns, one, _Meeting(one, two))

    def retry(self, body: Body, now_ns: int) -> None:
        """Have the robots that stand because they touch this one try again."""
        for other in self._bodies.values():
            if other.stands_at is body:
                self._schedule(now_ns, now_ns, other, other.driver.retry)

    def _schedule(self, due_ns: int, now_ns: int, body: Body, act: Callable[[int], object]) -> Any:
        """Schedule what a motion brings, which says itself whether time goes on for it."""
        return self.simulation.queue.schedule(max(due_ns, now_ns), body.robot.index,
                                              lambda due_ns, _now_ns: act(due_ns), keeps_going=lambda: False)

    def _forget(self, body: Body) -> None:
        """Cancel what the robot was to touch."""
        for other, event in body.ahead.items():
            event.cancel()
            if other is not None:
                self._bodies[other].ahead.pop(body.robot.index, None)
        body.ahead.clear()


class Body:
    """A driven robot: since ``since_ns`` [ns] it has its ``motion`` (Motion), or stands (None).

    ``driver``, ``frame``, ``shape``: see Contacts.join; ``stands_at``: the Body that keeps it from its command, or
    None; ``ahead``: the event of what it will touch, by the index of the other robot, None: a wall.
    """

    def __init__(self, contacts: Contacts, driver: Driver, frame: str, shape: Shape) -> None:
        self.driver, self.robot, self.frame, self.shape = driver, driver.robot, frame, shape
        self.stands_at: Optional[Body] = None
        self.bound = disc(shape.reach)
        self.motion: Optional[Motion] = None
        self.since_ns = 0
        self._fastest = 0.0
        self.ahead: Dict[Optional[int], Any] = {}
        self._contacts = contacts
        self._walls: Optional[Walls] = None

    def use_map(self, occupancy: Optional[OccupancyMap], now_ns: int) -> None:
        """Let the occupied cells of ``occupancy`` stop the robot from ``now_ns`` [ns] on, None: robots alone do."""
        self._walls = None
        if occupancy is not None:
            from .walls import Walls  # imported here, since only robots with a map need numpy
            self._walls = Walls(occupancy, self.shape)
        self._contacts.look(self, now_ns)
        self.driver.retry(now_ns)

    def leave(self) -> None:
        """Note that the robot is removed."""
        self._contacts.leave(self)

    def moved(self, now_ns: int) -> None:
        """Note that the robot has begun another motion, or stands."""
        if self._contacts.holds(self):
            self.since_ns, self.motion, self.stands_at = now_ns, self.robot.leg, None
            pieces = () if self.motion is None else self.motion.pieces
            self._fastest = max((abs(piece.v) for piece in pieces), default=0.0)
            self._contacts.look(self, now_ns)
            self._contacts.retry(self, now_ns)

    def is_blocked(self, motion: Motion, now_ns: int) -> bool:
        """Return whether the robot would touch something at once, if it began ``motion`` at ``now_ns`` [ns]."""
        moves_ns = next((piece.begin_ns for piece in motion.pieces if piece.v or piece.w), now_ns)
        until_ns, at_once_ns = moves_ns + LOOK_NS, moves_ns + AT_ONCE_NS
        spans = self.spans(motion, now_ns, until_ns)
        self.stands_at = next((other for other in self._contacts.others(self, now_ns) if _before(
            at_once_ns, _meeting_ns(self, spans, other, other.spans(other.motion, now_ns, until_ns), now_ns))), None)
        return self.stands_at is not None or _before(at_once_ns, self.touches_wall(spans, now_ns))

    def nears(self, other: Body, now_ns: int) -> bool:
        """Return whether the robot would touch ``other`` at once if that one stood from ``now_ns`` [ns] on."""
        until_ns = now_ns + AT_ONCE_NS
        spans = self.spans(self.motion, now_ns, until_ns)
        return _meeting_ns(self, spans, other, other.spans(None, now_ns, until_ns), now_ns) is not None

    def first_near(self, now_ns: int) -> Optional[Body]:
        """Return, of all that the robot :meth:`nears`, the one whose name comes first, or None."""
        return next((other for other in self._contacts.others(self, now_ns) if self.nears(other, now_ns)), None)

    def may_meet(self, other: Body, now_ns: int) -> bool:
        """Return whether the robot may touch ``other`` in the next LOOK_NS, by the distance of both."""
        ways = self.way_ahead(now_ns) + other.way_ahead(now_ns)
        return ways > 0.0 and self.robot.pose_at(now_ns).distance_to(other.robot.pose_at(now_ns)) <= (
            ways + self.shape.reach + other.shape.reach + 2.0 * REACH)

    def way_ahead(self, now_ns: int) -> float:
        """Return a way [m] that the robot does not exceed in the next LOOK_NS; it is above 0 if the robot moves."""
        if self.motion is None:
            return 0.0
        return REACH + self._fastest * (min(self.motion.arrive_ns - now_ns, LOOK_NS) / _NS_PER_S)

    def touches_wall(self, spans: _Spans, now_ns: int) -> Optional[int]:
        """Return the first instant [ns] from ``now_ns`` on at which the robot touches a wall in ``spans``, or None."""
        return None if self._walls is None else self._walls.first_touch(spans, now_ns)

    def spans(self, motion: Optional[Motion], now_ns: int, until_ns: int) -> _Spans:
        """Return ((a piece, its end [ns]), ...) of ``motion`` from ``now_ns`` to ``until_ns`` [ns]; then it stands."""
        found = [] if motion is None else [(piece, min(end_ns, until_ns)) for piece, end_ns in motion.spans()
                                           if end_ns > now_ns and piece.begin_ns < until_ns]
        if not found or found[-1][1] < until_ns:
            pose = self.robot.pose_at(now_ns) if motion is None else motion.end
            found.append((stand(pose, found[-1][1] if found else now_ns), until_ns))
        return found


class _Meeting:
    """Two robots touch: the one stalls whose motion leads to the other one; if that holds for neither, both do."""

    def __init__(self, one: Body, two: Body) -> None:
        self._pair = (one, two), (two, one)

    def __call__(self, now_ns: int) -> None:
        """Let them stall, in the order of robots."""
        moving = [(body, other) for body, other in self._pair if body.motion is not None]
        stalling = [(body, other) for body, other in moving if body.nears(other, now_ns)] or moving
        stalling = [(body, body.first_near(now_ns) or other) for body, other in stalling]
        for body, other in stalling:
            body.driver.stall(now_ns, other.robot.name)
        for body, other in stalling:  # only now, so that the stall of the one is no reason for the other to try again
            body.stands_at = other


def _before(limit_ns: int, touch_ns: Optional[int]) -> bool:
    return touch_ns is not None and touch_ns < limit_ns


def _meeting_ns(one: Body, ones: _Spans, other: Body, others: _Spans, now_ns: int) -> Optional[int]:
    """Return the first instant [ns] from ``now_ns`` on at which two robots touch that drive these spans, or None."""
    limit: Optional[Limit] = FREE
    start, their_start = pose_of(ones[0][0], now_ns), pose_of(others[0][0], now_ns)
    if start.distance_to(their_start) <= one.shape.reach + other.shape.reach + REACH + NEARER:
        limit = limit_of(gap_of(Course(ones[0][0], one.shape), Course(others[0][0], other.shape), now_ns))
    begin_ns, index, their_index = now_ns, 0, 0
    while limit is not None and index < len(ones) and their_index < len(others):
        (piece, end_ns), (their_piece, their_end_ns) = ones[index], others[their_index]
        until_ns = min(end_ns, their_end_ns)
        near_ns = first_touch(Course(piece, one.bound), Course(their_piece, other.bound), FREE, begin_ns, until_ns)
        touch_ns = None if near_ns is None else first_touch(
            Course(piece, one.shape), Course(their_piece, other.shape), limit, near_ns, until_ns)
        if touch_ns is not None:
            return touch_ns
        begin_ns, index, their_index = until_ns, index + (end_ns == until_ns), their_index + (their_end_ns == until_ns)
    return None
