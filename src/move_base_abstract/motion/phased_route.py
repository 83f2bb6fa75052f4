"""A route in the phases of a real robot: see :class:`.approach.MotionPhases`. Still any instant follows exactly."""
import math

from ..common.units import NS_PER_S
from .geometry import Pose2D
from .leg import Tolerances
from .route import CornerLaw, Route, Turn


class PhasedRoute(Route):
    """A :class:`Route`, with corners or without any, of a robot that begins and ends it by ``phases`` (MotionPhases).

    ``start_turn`` [rad]: by how much it turns at the start.
    """

    __slots__ = ('start_turn', '_phases')

    def __init__(self, start, goal, corners, limits, phases, tolerances=Tolerances(), depart_ns=0, law=CornerLaw.KEEP):
        self._phases = phases
        self.start_turn = 0.0
        super().__init__(start, goal, corners, limits, tolerances, depart_ns, law)

    def _turn_to_drive(self, first, yaw, turn, limits, driven):
        if not self._parts:
            self.start_turn = turn
        seconds = self._phases.start_turn_seconds(turn)
        self._add(Turn(first.x, first.y, yaw, turn, abs(turn) / seconds if seconds else math.inf, driven), seconds)

    def _turn_at_goal(self, begin, turn, whole, _limits, tolerances):
        length = self.distance + tolerances.xy
        profile = self._phases.end_turn(whole, self.start_turn, length, tolerances.yaw)
        self._add(_EasedTurn(begin, turn, profile, self.distance), profile.seconds)

    def _profile(self, length, limits):
        return self._phases.drive(length, limits)


class _EasedTurn:
    """A turn in place by ``turn`` [rad] from the pose ``begin``, which slows down as ``profile`` does, to its end."""

    __slots__ = ('_begin', '_turn', '_profile', '_driven')

    def __init__(self, begin, turn, profile, driven):
        self._begin, self._turn, self._profile, self._driven = begin, turn, profile, driven

    @staticmethod
    def guess(_distance):
        """Return when [s after its begin] a distance is driven: None, it drives nowhere."""

    def even_instants(self, ramp_pieces):
        return self._profile.changes(ramp_pieces)

    def smooth(self):
        return [(self._profile.seconds, 0.0)]

    def _of_profile(self, value):
        """Return the part of the turn [rad, rad/s] that a part of the profile's own angle stands for."""
        return self._turn * value / self._profile.distance if self._profile.distance else 0.0

    def pose_at(self, elapsed_ns):
        turned = self._of_profile(self._profile.covered(elapsed_ns / NS_PER_S))
        return Pose2D(self._begin.x, self._begin.y, self._begin.yaw + turned)

    def velocity_at(self, elapsed_ns):
        return 0.0, self._of_profile(self._profile.speed(elapsed_ns / NS_PER_S))

    def distance_at(self, _elapsed_ns):
        return self._driven
