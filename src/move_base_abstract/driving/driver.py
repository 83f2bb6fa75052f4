"""One robot that is driven by velocities: it takes commands, and sets its robot off on the arcs that follow.

Threading contract: that of :mod:`.navigator`.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional

from ..engine.alarm import Alarm
from ..goals.events import Driven, Drives, Stalled, Stands
from .drive_motion import HORIZON_NS, REST, DriveMotion, Step, Twist, steps_towards

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from ..maps.occupancy import OccupancyMap
    from ..motion.geometry import Pose2D
    from .settings import DriveSettings

_MOST = 1e6  # m/s, rad/s
#: what stalls a robot, besides another robot, whose name it then is
WALL, FARTHEST = 'wall', 'farthest position'


class Driver:
    """Drives the robot of ``navigator`` (Navigator) by velocities; ``stream`` (Stream) gets its events.

    Of several commands at one instant, that of the watchdog included, the last one counts, as if the others had not
    come. The watchdog comes first, as all that is due at an instant comes before what is told then. While the robot is
    held, has failed or has an empty battery it stands, and commands are lost. ``is_stalled``: whether it touches a wall
    or another robot, and stands until a command leads away.
    """

    def __init__(self, settings: DriveSettings, navigator: Navigator, simulation: Simulation, stream: Stream) -> None:
        self.settings = settings
        self.robot = navigator.robot
        self.is_stalled = False
        self._is_removed = False
        #: what keeps the robot from driving through walls and other robots (a Body of :mod:`.contacts`), or None
        self.body: Any = None
        self._navigator = navigator
        self._tell, self._hearers = stream.tell, stream.hearers
        self._wanted = REST
        self._motion: Optional[DriveMotion] = None
        self._steps: List[Step] = [(-HORIZON_NS, REST)]  # the last change of the twist before the motion, and its own
        self._watchdog = Alarm(simulation.queue, self.robot.index)
        self._end = Alarm(simulation.queue, self.robot.index, self._ends_at_rest)
        navigator.travel.drop_command = self._forget

    def command(self, forward: float, lateral: float, turning: float, now_ns: int) -> None:
        """Drive with these speeds [m/s] and this turn rate [rad/s] from ``now_ns`` [ns] on, within the limits.

        A robot that is not holonomic leaves ``lateral`` out, as in Stage and in diff_drive_controller.

        :raises ValueError: if a number is not finite or beyond 1e6; the command before it goes on.
        """
        twist = Twist(forward, lateral, turning)
        if not all(abs(one) <= _MOST for one in twist):  # NaN, too
            raise ValueError(f'a velocity must be finite and within +-1e6 m/s and rad/s, got {forward!r} m/s ahead, '
                             f'{lateral!r} m/s sideways, {turning!r} rad/s')
        if self._navigator.must_stand or self._is_removed:
            return
        if not self.settings.holonomic:
            twist = twist._replace(lateral=0.0)
        twist = Twist(*(min(max(one, limits.low), limits.high) + 0.0  # no -0.0
                        for one, limits in zip(twist, self.settings.limits)))
        if twist == REST or not self.settings.timeout_ns:
            self._watchdog.cancel()
        else:
            self._watchdog.set(now_ns + self.settings.timeout_ns, lambda due_ns: self._want(REST, due_ns))
        self._want(twist, now_ns)

    def teleport(self, pose: Pose2D, now_ns: int) -> None:
        """Put the robot at ``pose`` (global frame); it drives on from there as it did."""
        before, self._motion, self.is_stalled = self._before(now_ns), None, False
        self.robot.place(pose, now_ns)
        self._stands(now_ns)
        self._steps = [before]
        self._go(now_ns)

    def stall(self, now_ns: int, by: str) -> None:
        """Stand from ``now_ns`` [ns] on, until a command leads away; ``by``: WALL, or the robot that is touched."""
        was_stalled, self.is_stalled = self.is_stalled, True
        self._halt(now_ns)
        if not was_stalled:
            self._tell(Stalled(now_ns, self.robot.name, by))

    def retry(self, now_ns: int) -> None:
        """Drive on by the last command, if that no longer leads into what stalled the robot."""
        if self.is_stalled:
            self._go(now_ns)

    def use_map(self, occupancy: Optional[OccupancyMap], now_ns: int) -> None:
        """Let the occupied cells of ``occupancy`` (OccupancyMap) stop the robot from now on, None: robots alone do."""
        if self.body is not None:
            self.body.use_map(occupancy, now_ns)

    def close(self) -> None:
        """Note that the robot, whose navigator is closed, is removed. A command that comes late is lost."""
        self._is_removed = True
        if self.body is not None:
            self.body.leave()

    def _want(self, twist: Twist, now_ns: int) -> None:
        """Come to ``twist`` from ``now_ns`` [ns] on."""
        if twist != self._wanted or self.is_stalled:
            self._wanted = twist
            self._go(now_ns)

    def _go(self, now_ns: int) -> None:
        """Begin the motion that leads to the wanted twist; of a motion that has begun at this instant nothing stays."""
        before = self._before(now_ns)
        steps = steps_towards(self._wanted, before, self.settings, now_ns)
        changes = [before, *steps] if steps[0][1] != before[1] else [before, *steps[1:]]
        if all(twist == REST for _, twist in steps):
            self._steps = changes
            self._halt(now_ns)
            return
        end_ns, last = steps[-1]
        if not last == self._wanted == REST:  # it ends just after the driver has set the robot off again
            end_ns += 1 + (HORIZON_NS if last == self._wanted else self.settings.period_ns)
        try:
            motion = DriveMotion(self.robot.pose_at(now_ns), steps, end_ns)
        except ValueError:
            self.stall(now_ns, FARTHEST)
            return
        if self.is_stalled and self.body is not None and self.body.is_blocked(motion, now_ns):
            return
        self.is_stalled = False
        self._steps = changes
        self._begin(motion, now_ns)

    def _begin(self, motion: DriveMotion, now_ns: int) -> None:
        if self._motion is None:
            self._navigator.begin_drive()
        self._motion = motion
        self._end.set(motion.arrive_ns if self._ends_at_rest() else motion.arrive_ns - 1, self._reach_end)
        self.robot.set_off(motion, now_ns)
        pose, name = motion.start, self.robot.name
        self._tell(Driven(now_ns, name, pose.x, pose.y, pose.yaw, *self._wanted))
        if Drives in self._hearers:
            self._tell(Drives(now_ns, name, motion))

    def _reach_end(self, due_ns: int) -> None:
        """Stand, if the motion has come to rest; otherwise drive on."""
        if self._ends_at_rest():
            self._halt(due_ns)
        else:
            self._go(due_ns)

    def _ends_at_rest(self) -> bool:
        """Return whether a run goes on until the present motion ends: a robot without a watchdog drives on for ever."""
        return self._steps[-1][1] == self._wanted == REST

    def _before(self, now_ns: int) -> Step:
        """Return the last change of the twist before ``now_ns`` [ns]; one at that very instant is undone."""
        return next((step for step in reversed(self._steps) if step[0] < now_ns), self._steps[0])

    def _halt(self, now_ns: int) -> None:
        """Stand from ``now_ns`` [ns] on, and tell it, if the robot drives."""
        self._end.cancel()
        if self._motion is not None:
            self._motion = None
            self.robot.stop(now_ns)
            self._stands(now_ns)
        if self.is_stalled:
            self._steps = [(now_ns, REST)]

    def _stands(self, now_ns: int) -> None:
        pose = self.robot.pose_at(now_ns)
        self._tell(Stands(now_ns, self.robot.name, 'stands', pose.x, pose.y, pose.yaw))

    def _forget(self, now_ns: int) -> None:
        """Note that something else stops the robot: it has no command any more."""
        self._watchdog.cancel()
        self._end.cancel()
        self._motion, self._wanted, self._steps, self.is_stalled = None, REST, [(now_ns, REST)], False
