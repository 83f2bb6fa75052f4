"""One robot: its pose at any instant, and the leg or route that it travels. It decides nothing about goals."""
from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Callable, Deque, List, Optional, Sequence, Tuple, Union

from ..common.errors import TimeError
from ..common.units import LAST_NS, check_reachable, seconds_to_ns
from .geometry import Pose2D
from .leg import Leg, MotionLimits, Tolerances
from .pace import TimedLeg
from .phased_route import PhasedRoute
from .planned_way import PlannedWay
from .route import CornerLaw, Route, route_along

if TYPE_CHECKING:
    from .approach import MotionPhases
    from .original import OriginalLaw
    from .pieces import Motion

    _Motion = Union[Motion, '_Stand']


class Robot:
    """A robot that stands or travels one leg or route at a time in the plane of the global frame.

    New limits and tolerances (:meth:`set_motion`) take effect on the next leg. ``corner_law`` (CornerLaw): what the
    robot does at the corners of a route. ``phases`` (MotionPhases): how it begins and ends its legs, None: as a Leg
    does. ``original`` (OriginalLaw): legs take as long as in the original package, without corners, phases and
    tolerances. ``remembered_legs``: the number of legs, including the present one, whose poses can be asked for; a
    stand elsewhere than at a leg's end counts as one.
    """

    __slots__ = ('index', 'name', 'limits', 'tolerances', '_corner_law', 'phases', '_original', 'leg', '_motion',
                 '_past', '_driven', '_followers', 'reported', '__weakref__')

    def __init__(self, index: int, name: str, pose: Pose2D = Pose2D(), limits: MotionLimits = MotionLimits(0.5),
                 tolerances: Tolerances = Tolerances(), since_ns: int = 0, corner_law: CornerLaw = CornerLaw.KEEP,
                 phases: Optional[MotionPhases] = None, remembered_legs: int = 64,
                 original: Optional[OriginalLaw] = None) -> None:
        self.index = index
        self.name = name
        #: the MotionLimits and the Tolerances of the next leg
        self.limits, self.tolerances = limits, tolerances
        self._corner_law = corner_law
        #: the MotionPhases of its legs, or None
        self.phases = phases
        self._original = original
        #: the :class:`Leg` or :class:`Route` under way, or None while the robot stands
        self.leg: Optional[Motion] = None
        self._motion: _Motion = _Stand(pose, since_ns)
        self._past: Deque[_Motion] = deque([self._motion], maxlen=remembered_legs)
        self._driven = 0.0
        self._followers: List[Callable[[int], object]] = []
        #: the pose that it reports (Reported)
        self.reported = Reported(self)

    def follow(self, follower: Callable[[int], object]) -> None:
        """Call ``follower(now_ns)`` [ns] whenever the robot has begun another leg, or has begun to stand."""
        self._followers.append(follower)

    @property
    def keeps_piece_limits(self) -> bool:
        """Whether its law allows speed limits of pieces of a way: it is neither calibrated nor the original's."""
        return self.phases is None and self._original is None

    def set_motion(self, limits: MotionLimits, tolerances: Tolerances) -> None:
        """Use these MotionLimits and Tolerances from the next leg on."""
        self.limits, self.tolerances = limits, tolerances

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose at ``now_ns`` [ns], which is the present or not too long ago.

        :raises TimeError: if that is further back than the robot remembers.
        """
        motion = self._motion
        if now_ns >= motion.arrive_ns:  # the usual case
            return motion.end
        if now_ns >= motion.depart_ns:
            return motion.pose_at(now_ns)
        for motion in reversed(self._past):
            if now_ns >= motion.depart_ns:
                return motion.pose_at(now_ns)
        raise TimeError('{}: the pose at {} ns is asked for, but nothing before {} ns is remembered'.format(
            self.name, now_ns, self._past[0].depart_ns))

    def velocity_at(self, now_ns: int) -> Tuple[float, float, float]:
        """Return (forward, lateral [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns]."""
        return self._motion.velocity_at(now_ns)

    def distance_at(self, now_ns: int) -> float:
        """Return the distance [m] driven up to ``now_ns`` [ns], which is not before the present leg."""
        return self._driven if self.leg is None else self._driven + self.leg.distance_at(now_ns)

    def depart(self, goal: Pose2D, now_ns: int, corners: Sequence[Tuple[float, float]] = (),
               paced: Optional[Callable[[Motion], Motion]] = None) -> Motion:
        """Start for ``goal`` (Pose2D) from rest, from the robot's pose at ``now_ns`` [ns], along ``corners``.

        ``corners`` is [(x, y), ...] [m] or a :class:`.PlannedWay`, which may have limits and a duration. If there is
        ``paced``, the robot travels ``paced(leg)`` instead of the leg that follows from its law.

        Return the :class:`Leg` that it travels; with corners or phases it is a :class:`Route`.

        :raises ValueError: if the goal is so far away that no number holds the distance or the time, or that the robot
            would arrive after the end of simulated time.
        """
        start = self.pose_at(now_ns)
        way = corners if isinstance(corners, PlannedWay) else None
        leg: Motion
        if self._original is not None:
            leg = self._original.leg(start, goal, self.limits, now_ns)
        elif self.phases is not None:
            leg = PhasedRoute(start, goal, corners, self.limits, self.phases, self.tolerances, now_ns,
                              self._corner_law)
        elif way is not None and way.limits:
            leg = route_along(start, goal, way, self.limits, self.tolerances, now_ns, self._corner_law)
        elif corners:
            leg = Route(start, goal, corners, self.limits, self.tolerances, now_ns, self._corner_law)
        else:
            leg = Leg(start, goal, self.limits, self.tolerances, now_ns)
        if way is not None and way.seconds is not None:
            leg = TimedLeg(leg, seconds_to_ns(way.seconds))
        if leg.arrive_ns > LAST_NS:  # a call less for each goal
            check_reachable(leg.arrive_ns, 'the arrival would be')  # before ``paced`` multiplies the duration
        if paced is not None:
            leg = paced(leg)
            check_reachable(leg.arrive_ns, 'the arrival would be')
        self.set_off(leg, now_ns)
        return leg

    def set_off(self, motion: Motion, now_ns: int) -> None:
        """Travel ``motion``, which begins at ``now_ns`` [ns] at the robot's pose."""
        if self.leg is not None:
            self._driven += self.leg.distance_at(now_ns)
        self._motion = self.leg = motion
        self._past.append(motion)
        if self._followers:
            self._tell_followers(now_ns)

    def stop(self, now_ns: int) -> Pose2D:
        """Stand still from ``now_ns`` [ns] on; return the exact pose at that instant."""
        leg = self.leg
        if leg is None or now_ns < leg.arrive_ns:
            pose = self.pose_at(now_ns)
            self._stand(pose, now_ns, now_ns)
            return pose
        self._driven += leg.distance
        self.leg = None  # it stands at the end of its leg, which answers for it from the arrival on
        if self._followers:
            self._tell_followers(now_ns)
        return leg.end

    def halt(self, now_ns: int) -> None:
        """Stop as :meth:`stop` does, even if the leg is faulty: if it has no pose now, stand at its start.

        The error of the leg is raised afterwards.
        """
        try:
            self.stop(now_ns)
        except Exception:
            if self.leg is not None:
                self._stand(self.leg.start, now_ns)
            raise

    def place(self, pose: Pose2D, now_ns: int) -> None:
        """Stand at ``pose`` from ``now_ns`` [ns] on, without having driven there."""
        self._stand(pose, now_ns, now_ns)

    def reset(self, pose: Pose2D, now_ns: int) -> None:
        """Stand at ``pose`` as if nothing had happened before ``now_ns`` [ns]."""
        self._past.clear()
        self._driven = 0.0
        self._stand(pose, now_ns)

    def restart(self, before_ns: int, now_ns: int) -> None:
        """Stand from ``now_ns`` [ns] on, after a restart of the clock, where the robot was at ``before_ns`` [ns].

        ``before_ns`` is an instant of the clock before its restart.
        """
        pose = self.pose_at(before_ns)
        self._past.clear()
        self._stand(pose, now_ns, before_ns)

    def _stand(self, pose: Pose2D, now_ns: int, driven_ns: Optional[int] = None) -> None:
        """Stand at ``pose`` from ``now_ns`` [ns] on; the distance driven counts up to ``driven_ns`` [ns]."""
        if driven_ns is not None and self.leg is not None:
            self._driven += self.leg.distance_at(driven_ns)
        self._motion, self.leg = _Stand(pose, now_ns), None
        self._past.append(self._motion)
        self._tell_followers(now_ns)

    def _tell_followers(self, now_ns: int) -> None:
        fault = None
        for follower in self._followers:  # call each of them, whatever goes wrong in another one
            try:
                follower(now_ns)
            except Exception as error:
                fault = fault or error
        if fault is not None:
            raise fault


class _Stand:
    """Standing at ``end``, with the interface of a leg that has arrived."""

    __slots__ = ('arrive_ns', 'depart_ns', 'end')

    def __init__(self, end: Pose2D, since_ns: int) -> None:
        self.end = end
        self.depart_ns = self.arrive_ns = since_ns

    def pose_at(self, _now_ns: int) -> Pose2D:
        return self.end

    def velocity_at(self, _now_ns: int) -> Tuple[float, float, float]:
        return 0.0, 0.0, 0.0


class Reported:
    """The pose that ``robot`` (Robot) reports.

    ``shift``: the pose that the robot takes for the origin of its odometry, in the global frame, while the true one is
    the origin of the global frame; None: there is no error. ``is_mute``: whether the robot reports no pose.
    """

    __slots__ = ('is_mute', 'robot', 'shift')

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.shift: Optional[Pose2D] = None
        self.is_mute = False

    def jump(self, now_ns: int, x: float, y: float, yaw: float) -> None:
        """Move the reported pose, at ``now_ns`` [ns], to ``x``, ``y`` [m] and ``yaw`` [rad] beside the true pose.

        As a jump of amcl does, this turns the odometry about the robot, so later motion is reported in a wrong
        direction.
        """
        pose = self.robot.pose_at(now_ns)
        self.shift = Pose2D(pose.x + x, pose.y + y, pose.yaw + yaw).compose(pose.inverse())

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the reported pose at ``now_ns`` [ns] in the global frame.

        :raises TimeError: as Robot.pose_at does.
        """
        pose = self.robot.pose_at(now_ns)
        return pose if self.shift is None else self.shift.compose(pose)
