"""One robot that is driven by velocities, as Stage or a driver has it: ``cmd_vel``, odometry, tf, scans, teleports."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn, Sequence, Tuple

import rospy
from geometry_msgs.msg import Twist, TwistStamped
from std_srvs.srv import Empty, EmptyResponse

from move_base_abstract.common.errors import FrameError
from move_base_abstract.driving.odometry import Odometry, drawn_shares
from move_base_abstract.fleet.robot_parts import make_planner, make_robot_parts
from move_base_abstract.fleet.robot_rows import tell_start
from move_base_abstract.goals.client import NoClient
from move_base_abstract.goals.events import Stands
from move_base_abstract.motion.frames import RobotFrames

from ..backends.driven import DrivenBackend
from ..maps.robot_map import RobotMap
from ..transforms import tf_hub
from ..transforms.tf_lookup import TfLookup
from .robot_publisher import PosePublisher
from .robot_server import PriorityTopic, RobotServer
from .teleport import Teleport

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.driving.driver import Driver
    from move_base_abstract.motion.robot import Robot

    from .host import Host

#: the last part of the private names of such a robot in a fleet
NODE = 'velocity_robot'


class VelocityServer(RobotServer):
    """One robot of a process's :class:`Host` that is driven by velocities. It has no goals."""

    driver: Driver
    _odometry: Odometry
    _commands: rospy.Subscriber
    _service: rospy.Service

    def _set_up(self) -> None:
        names, settings, clock = self._names, self._settings, self._clock
        self._teleport = Teleport(names, settings, clock, self.navigator.robot, self.driver.teleport, self._frames,
                                  self._prefetch_frame)
        self._condition_server.serve()
        if self._traveller is not None:
            self._priority = PriorityTopic(names, clock, self._traveller)
        self._map.follow_changes(self._use_map)
        if self._map.check is not None:
            self._use_map()
        stamped = settings.values['use_stamped_vel']
        self._commands = rospy.Subscriber(
            names.topic('cmd_vel'), TwistStamped if stamped else Twist,
            (lambda message: self._on_command(message.twist)) if stamped else self._on_command, queue_size=10,
            tcp_nodelay=True)
        self._service = rospy.Service(names.topic('reset_positions'), Empty, self._on_reset)

    def _build(self, robot_index: int) -> None:
        names, settings, values, host = self._names, self._settings, self._settings.values, self._host
        self._map = RobotMap(names, settings, self._clock)
        parts = make_robot_parts(settings, names.robot, robot_index, self._clock.simulation, self._stream,
                                 NoClient(names.robot), _no_lookup, make_planner(settings, self._map.check),
                                 host.zones, contacts=host.contacts)
        robot, self.navigator, self.condition = parts.robot, parts.navigator, parts.condition
        assert parts.driver is not None  # its settings are those of a robot that is driven by velocities
        self.driver = parts.driver
        self._odometry = odometry = Odometry(
            robot, settings.odom_origin, self._clock.simulation.now_ns,
            drawn_shares(parts.driver.settings.odom_error, values['seed'], robot.name))
        self._lookup = TfLookup(values['global_frame'], values['frame_timeout'], self._clock)
        self._frames = RobotFrames(robot, values['global_frame'], values['global_frame'],
                                   settings.frame(values['robot_base_frame']), self._lookup.lookup)
        host.timing.tell_motion(robot, robot_index, odometry)
        tell_start(self._stream, robot, None, self._clock.look_ns())
        backend = DrivenBackend(names, settings, robot, odometry)
        self._publisher = DrivePublisher(settings, host, robot, backend)
        self._stream.subscribe('shown', {Stands: lambda event: self._publisher.stands(event.time_ns)})
        self._begin(robot, backend, robot_index)

    def close(self) -> None:
        """Remove the robot from the world, and unregister its topics and services."""
        self._commands.unregister()
        self._service.shutdown('the robot is removed')
        super().close()

    def _topics(self) -> Sequence[Any]:
        return self._map, self._teleport, self._condition_server, self._priority

    def _forget_goals(self, is_removed: bool) -> None:
        if is_removed:
            self.driver.close()

    def _restart(self, before_ns: int, now_ns: int) -> None:
        self._odometry.forget()
        super()._restart(before_ns, now_ns)
        self._publisher.start(now_ns)

    def _put_at_start(self, now_ns: int) -> None:
        super()._put_at_start(now_ns)
        self._odometry.reset(now_ns)

    def _on_reset(self, _request: Any) -> Any:
        self.reset()
        return EmptyResponse()

    def _on_command(self, twist: Any) -> None:
        clock = self._clock
        with clock.lock:
            try:
                self.driver.command(twist.linear.x, twist.linear.y, twist.angular.z, clock.now_ns())
            except ValueError as fault:
                self.warn('a command on cmd_vel is refused, and the one before it goes on: {}'.format(fault))

    def _use_map(self) -> None:
        with self._clock.lock:
            self.driver.use_map(self._map.check.occupancy, self._clock.now_ns())


class DrivePublisher(PosePublisher):
    """Publishes what ``backend`` (DrivenBackend) shows of a robot, whether it drives or not."""

    def __init__(self, settings: RobotSettings, host: Host, robot: Robot, backend: DrivenBackend) -> None:
        super().__init__(settings, host, robot, backend)
        rate, simulation = settings.values['pose_update_freq'], host.clock.simulation
        self._told.append(host.rates.add('odometry', lambda: rate, lambda: backend.hearers() + tf_hub.hearers()))
        self.start(simulation.now_ns)
        self.stands(simulation.now_ns)

    def start(self, now_ns: int) -> None:
        """Begin to publish at ``now_ns`` [ns]."""
        if self._updates is not None:
            self._updates.start_in_step(now_ns)

    def stands(self, now_ns: int) -> None:
        """Publish that the robot stands from ``now_ns`` [ns] on, if nothing is published at a rate."""
        if self._updates is None:
            self.place(now_ns)

    def _moves(self, now_ns: int) -> Tuple[Any, Any]:
        moves: Tuple[Any, Any] = self._backend.poses_at(now_ns)  # a pair each
        return moves


def _no_lookup(frame_id: str, _stamp_ns: int) -> NoReturn:
    raise FrameError("frame '{}' is unknown: this robot has no goals".format(frame_id))
