"""The topics of one robot besides its actions: its pose, its current goal, and that its wheels stop."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Tuple

import rospy
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import RecoveryStatus

from move_base_abstract.goals.events import Aimed, Departed, Lapse, Recovery, Stands, WheelsStopped

from ..lockstep import sender  # bound once: the package would look it up at each use
from ..messages import conversions
from ..messages.outlets import Outlet
from ..messages.packing import ZERO_TWIST, InFrame
from ..transforms import tf_hub

if TYPE_CHECKING:
    from move_base_abstract.config.rates import Rate
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.engine.series import Series
    from move_base_abstract.engine.stream import Stream
    from move_base_abstract.motion.robot import Robot

    from ..backends import Backend
    from ..maps.costmap_topics import CostmapTopics
    from .host import Host
    from .names import RobotNames

_DEAF_SECONDS = 0.1  # wall; the pause of the odometry of a robot that stands, if no node hears it


class PosePublisher:
    """Publishes the poses of ``robot`` (Robot) by its ``backend`` (Backend): at events, and at ``pose_update_freq``."""

    def __init__(self, settings: RobotSettings, host: Host, robot: Robot, backend: Any) -> None:
        self._clock = host.clock
        self._robot = robot
        self._backend = backend
        backend.follow(self._present)
        self._pose_throttle = host.throttle(settings.values['max_pose_rate'])
        self._updates = host.clock.simulation.series(
            robot.index, settings.values['pose_update_freq'], self._update, is_output=True,
            is_heard=host.timing.when_heard(self._is_heard))
        self._rates = host.rates
        self._told: List[Rate] = []

    def place(self, now_ns: int, is_event: bool = True) -> None:
        """Publish the robot's pose at ``now_ns`` [ns]. ``is_event``: it departs, stops, or localization lapses."""
        if not self._robot.reported.is_mute:
            with sender(self._robot.index):  # tf is one topic of all robots of the process
                self._show(now_ns, is_event)

    def _show(self, now_ns: int, _is_event: bool) -> None:
        self._backend.place(*self._moves(now_ns), now_ns)

    def _moves(self, now_ns: int) -> Tuple[Any, Any]:
        """Return the pose and the velocity at ``now_ns`` [ns], as the backend takes them."""
        return self._robot.pose_at(now_ns), self._robot.velocity_at(now_ns)

    def _present(self) -> Optional[Tuple[Any, Any, int]]:
        now_ns = self._clock.newcomers_ns()
        return None if now_ns is None or self._robot.reported.is_mute else (*self._moves(now_ns), now_ns)

    def restart(self) -> None:
        """Allow stamps that are earlier than those before, because time has started anew."""
        self._backend.restart()

    def close(self) -> None:
        """Publish nothing any more."""
        for told in self._told:
            self._rates.remove(told)
        if self._updates is not None:
            self._updates.stop()
        self._backend.close()

    def _is_heard(self) -> int:
        return tf_hub.is_heard(self._backend.is_heard)

    def _update(self, due_ns: int, _now_ns: int) -> int:
        if self._pose_throttle.ready():
            self.place(due_ns, is_event=False)
        return self._clock.wall_to_ns(self._pose_throttle.remaining())


class RobotPublisher(PosePublisher):
    """Publishes a robot's poses, costmaps, ``current_goal``, ``cmd_vel`` and ``recovery_status``."""

    def __init__(self, names: RobotNames, settings: RobotSettings, host: Host, robot: Robot,
                 backend: Backend, costmaps: CostmapTopics, stream: Stream) -> None:
        self._costmaps = costmaps
        super().__init__(settings, host, robot, backend)
        self._global_frame = settings.values['global_frame']
        self._in_global_frame = InFrame(self._global_frame)
        self._current_goal = Outlet(names.own('current_goal'), PoseStamped, queue_size=0)
        self._cmd_vel = Outlet(names.topic('cmd_vel'), Twist, queue_size=10)
        self._recovery = rospy.Publisher(names.action('recovery_status'), RecoveryStatus, queue_size=1)
        self._updates_beat = settings.values['pose_update_freq'] >= settings.values['tf_heartbeat_freq']
        self._beats = settings.values['tf_heartbeat_freq'] > 0.0
        self._heartbeat = host.tf_heartbeat(settings.values['tf_heartbeat_freq'], settings.values['max_pose_rate'])
        self._heartbeat.add(self._beat, self._is_heard)
        self._tell_rates(settings.values['pose_update_freq'], settings.values['tf_heartbeat_freq'])
        self._rest = self._series_at_rest(settings, host)
        stream.subscribe('shown', {Departed: self._departed, Stands: lambda event: self._stand(event.time_ns),
                                   Aimed: self._aimed, WheelsStopped: self._wheels_stopped, Recovery: self._recovers,
                                   Lapse: self._lapsed})
        self._stand(self._clock.simulation.now_ns)

    def _series_at_rest(self, settings: RobotSettings, host: Host) -> Optional[Series]:
        """Return the Series that publishes the odometry of a robot that stands, or None."""
        frequency = settings.values['odom_rate_at_rest']
        if frequency is None:
            frequency = host.timing.frequency_at_rest(settings.values['pose_update_freq'])
        if frequency:
            self._told.append(host.rates.add('odometry at rest', lambda: frequency, self._odometry_hearers))
        return host.clock.simulation.series(self._robot.index, frequency, self._still_stands, is_output=True,
                                            is_heard=host.timing.when_heard(self._is_odometry_heard))

    def _tell_rates(self, pose_frequency: float, tf_frequency: float) -> None:
        # While the robot drives, its poses go to tf, too.
        self._told += [self._rates.add('poses', lambda: pose_frequency, self._pose_hearers),
                       self._rates.add('tf', lambda: max(pose_frequency, tf_frequency), tf_hub.hearers)]

    def _departed(self, event: Departed) -> None:
        if self._rest is not None:
            self._rest.stop()
        self.place(event.time_ns)
        if self._updates is not None:
            self._updates.start(event.time_ns)
        else:
            self._clock.hearers.falls_silent(self._robot, self._backend, 'pose_update_freq')
            if not self._beats:
                self._clock.hearers.falls_silent(self._robot, tf_hub, 'tf_heartbeat_freq')

    def _stand(self, now_ns: int) -> None:
        if self._updates is not None:
            self._updates.stop()
        self.place(now_ns)
        if self._rest is not None:
            self._rest.start(now_ns + self._rest.period_ns)

    def _show(self, now_ns: int, is_event: bool) -> None:
        super()._show(now_ns, is_event)
        self._costmaps.moved(self._robot.reported.pose_at(now_ns), now_ns, is_event)

    def _lapsed(self, event: Any) -> None:
        self._backend.shift = self._robot.reported.shift
        self.place(event.time_ns)

    def _aimed(self, event: Aimed) -> None:
        self._current_goal.send(lambda seq: self._in_global_frame.goal(seq, event.goal, event.height, event.quaternion,
                                                                       event.time_ns))

    def _wheels_stopped(self, _event: WheelsStopped) -> None:
        self._cmd_vel.send(_stand_still)

    def _recovers(self, event: Recovery) -> None:
        self._recovery.publish(RecoveryStatus(
            pose_stamped=conversions.to_pose_stamped(event.pose, self._global_frame, event.time_ns),
            current_recovery_number=event.index, total_number_of_recoveries=len(event.behaviors),
            recovery_behavior_name=event.behaviors[event.index].name))

    def close(self) -> None:
        """Publish nothing any more."""
        self._heartbeat.remove(self._beat)
        if self._rest is not None:
            self._rest.stop()
        super().close()
        self._costmaps.close()
        for publisher in (self._current_goal, self._cmd_vel, self._recovery):
            publisher.unregister()

    def _pose_hearers(self) -> List[Tuple[str, str]]:
        # Not every backend has this method. It is called only in lockstep, where the backend is a builtin one.
        return self._backend.hearers() + self._costmaps.hearers()

    def _odometry_hearers(self) -> List[Tuple[str, str]]:
        return self._backend.odometry_hearers()  # as above

    def _is_odometry_heard(self) -> int:
        return self._backend.is_odometry_heard()

    def _is_heard(self) -> int:
        return tf_hub.is_heard(self._backend.is_heard, self._costmaps.is_heard)

    def _still_stands(self, due_ns: int, _now_ns: int) -> int:
        if not self._robot.reported.is_mute and self._pose_throttle.ready():
            with sender(self._robot.index):
                self._backend.rests(self._robot.pose_at(due_ns), due_ns)
        pause = self._pose_throttle.remaining()
        return self._clock.wall_to_ns(pause if self._backend.is_odometry_heard() else max(pause, _DEAF_SECONDS))

    def _beat(self, now_ns: int) -> None:
        """Publish the latest pose in tf, so that a look-up of the present need not wait for the next pose."""
        reported = self._robot.reported
        if not (self._updates_beat and self._robot.leg is not None) and not reported.is_mute:
            with sender(self._robot.index):
                self._backend.heartbeat(self._robot.pose_at(now_ns), now_ns)
                self._costmaps.moved(reported.pose_at(now_ns), now_ns, is_event=False)


def _stand_still(_seq: int) -> bytes:
    return ZERO_TWIST
