"""One robot: where it is at any instant, and the leg or route it travels. It decides nothing about goals."""
from collections import deque

from ..common.errors import TimeError
from ..common.units import check_reachable, seconds_to_ns
from .geometry import Pose2D
from .leg import Leg, MotionLimits, Tolerances
from .pace import TimedLeg
from .phased_route import PhasedRoute
from .planned_way import PlannedWay
from .route import CornerLaw, Route, route_along
from .telling import Telling


class Robot:
    """A robot that stands or travels one leg or route at a time in the plane of the global frame.

    Other limits and tolerances (:meth:`set_motion`) take effect on the next one. ``corner_law`` (CornerLaw): what the
    robot does at the corners of a route; ``phases`` (MotionPhases): how it begins and ends, None: as of a Leg;
    ``original`` (OriginalLaw): legs take as long as in the package of that name, without corners, phases, tolerances;
    ``remembered_legs``: of how many legs and stands, the present one included, poses can be asked for.
    """

    def __init__(self, index, name, pose=Pose2D(), limits=MotionLimits(0.5), tolerances=Tolerances(), since_ns=0,
                 corner_law=CornerLaw.KEEP, phases=None, remembered_legs=64, original=None):
        self.index = index
        self.name = name
        self._limits = limits
        self._tolerances = tolerances
        self._corner_law = corner_law
        self._phases = phases
        self._original = original
        #: the :class:`Leg` or :class:`Route` under way, or None while the robot stands
        self.leg = None
        self._motion = _Stand(pose, since_ns)
        self._past = deque([self._motion], maxlen=remembered_legs)
        self._driven = 0.0
        self._followers = []
        #: what it tells of where it is (Telling)
        self.telling = Telling(self)

    def follow(self, follower):
        """Call ``follower(now_ns)`` whenever the robot begins another leg or another stand, as it has begun."""
        self._followers.append(follower)

    @property
    def limits(self):
        """The MotionLimits of the next leg."""
        return self._limits

    @property
    def phases(self):
        """The MotionPhases of its legs, or None."""
        return self._phases

    @property
    def keeps_piece_limits(self):
        """Whether pieces of a way may have speeds of their own: its law of motion is not a recorded or a copied one."""
        return self._phases is None and self._original is None

    @property
    def tolerances(self):
        """The Tolerances of the next leg."""
        return self._tolerances

    def set_motion(self, limits, tolerances):
        """Travel with these MotionLimits and Tolerances from the next leg on."""
        self._limits = limits
        self._tolerances = tolerances

    def pose_at(self, now_ns):
        """Return the pose at ``now_ns`` [ns], the present or some of the past.

        :raises TimeError: if that lies further back than the robot remembers.
        """
        motion = self._motion
        if now_ns >= motion.depart_ns:  # as nearly always
            return motion.pose if self.leg is None else motion.pose_at(now_ns)
        for motion in reversed(self._past):
            if now_ns >= motion.depart_ns:
                return motion.pose_at(now_ns)
        raise TimeError('{}: the pose at {} ns is asked for, but nothing before {} ns is remembered'.format(
            self.name, now_ns, self._past[0].depart_ns))

    def velocity_at(self, now_ns):
        """Return (forward [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns]."""
        return self._motion.velocity_at(now_ns)

    def distance_at(self, now_ns):
        """Return the distance [m] driven since the beginning, at ``now_ns`` [ns], not before the present leg."""
        return self._driven + self._motion.distance_at(now_ns)

    def depart(self, goal, now_ns, corners=(), paced=None):
        """Start for ``goal`` from where the robot is at ``now_ns`` [ns], from rest, by ``corners`` [(x, y), m].

        ``corners`` may be a :class:`.PlannedWay`, which says more.

        Return the :class:`Leg`, or where there are corners or phases the :class:`Route`; ``paced(leg)`` makes of it
        the one to travel.

        :raises ValueError: if the goal is so far away that no number holds the distance or the time, or that the robot
            would arrive after the end of simulated time.
        """
        start = self.pose_at(now_ns)
        way = corners if isinstance(corners, PlannedWay) else None
        if self._original is not None:
            leg = self._original.leg(start, goal, self._limits, now_ns)
        elif self._phases is not None:
            leg = PhasedRoute(start, goal, corners, self._limits, self._phases, self._tolerances, now_ns,
                              self._corner_law)
        elif way is not None and way.limits:
            leg = route_along(start, goal, way, self._limits, self._tolerances, now_ns, self._corner_law)
        elif corners:
            leg = Route(start, goal, corners, self._limits, self._tolerances, now_ns, self._corner_law)
        else:
            leg = Leg(start, goal, self._limits, self._tolerances, now_ns)
        if way is not None and way.seconds is not None:
            leg = TimedLeg(leg, seconds_to_ns(way.seconds))
        check_reachable(leg.arrive_ns, 'the arrival would be')  # before its time is multiplied
        if paced is not None:
            leg = paced(leg)
            check_reachable(leg.arrive_ns, 'the arrival would be')
        self._begin(leg, leg, now_ns)
        return leg

    def stop(self, now_ns):
        """Stand still from ``now_ns`` [ns] on; return the pose of that instant, exactly."""
        pose = self.pose_at(now_ns)
        self._begin(_Stand(pose, now_ns), None, now_ns)
        return pose

    def halt(self, now_ns):
        """As :meth:`stop`, whatever is wrong with the leg: where that cannot be said, at its start."""
        try:
            self.stop(now_ns)
        except Exception:
            if self.leg is not None:
                self._begin(_Stand(self.leg.start, now_ns), None)
            raise

    def place(self, pose, now_ns):
        """Be at ``pose`` from ``now_ns`` [ns] on, without having driven there."""
        self._begin(_Stand(pose, now_ns), None, now_ns)

    def reset(self, pose, now_ns):
        """Be at ``pose`` as if nothing had happened before ``now_ns`` [ns]."""
        self._past.clear()
        self._driven = 0.0
        self._begin(_Stand(pose, now_ns), None)

    def restart(self, before_ns, now_ns):
        """Stand where the robot was at ``before_ns`` [ns] of a clock that has started anew, since ``now_ns`` [ns]."""
        pose = self.pose_at(before_ns)
        self._past.clear()
        self._begin(_Stand(pose, now_ns), None, before_ns)

    def _begin(self, motion, leg, driven_ns=None):
        """Go on with ``motion``, which is the ``leg`` or a stand; what has been driven counts up to ``driven_ns``."""
        if driven_ns is not None and self.leg is not None:
            self._driven += self.leg.distance_at(driven_ns)
        self._motion, self.leg = motion, leg
        self._past.append(motion)
        if self._followers:
            self._tell_followers(motion)

    def _tell_followers(self, motion):
        fault = None
        for follower in self._followers:  # each is told, whatever goes wrong with another
            try:
                follower(motion.depart_ns)
            except Exception as error:
                fault = fault or error
        if fault is not None:
            raise fault


class _Stand:
    """Standing at one ``pose``; answers as a leg does."""

    __slots__ = ('depart_ns', 'pose')

    def __init__(self, pose, since_ns):
        self.pose = pose
        self.depart_ns = since_ns

    def pose_at(self, _now_ns):
        return self.pose

    def velocity_at(self, _now_ns):
        return 0.0, 0.0

    def distance_at(self, _now_ns):
        return 0.0
