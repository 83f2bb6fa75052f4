"""A robot's laser scans, which are computed if any node hears them, and the pose of the laser in tf."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, List, Optional, Tuple

from sensor_msgs.msg import LaserScan

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.sensing.laser import Laser

from ..lockstep import sender  # bound once: the package would look it up at each use
from ..messages.outlets import Outlet, Packed
from ..messages.packing import InFrame
from ..transforms import tf_hub

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.motion.robot import Robot

    from ..backends import Backend
    from ..maps.robot_map import RobotMap
    from ..messages.outlets import Publish
    from .host import Host
    from .names import RobotNames


class ScanPublisher:
    """Publishes scans at multiples of their period, and the pose of the laser in tf at the same instants.

    Whether any node hears the scans changes nothing in tf, nor in any other topic.
    """

    def __init__(self, names: RobotNames, settings: RobotSettings, host: Host, robot: Robot, backend: Backend,
                 robot_map: RobotMap) -> None:
        values = settings.values
        self._robot = robot
        self._backend = backend
        self._map = robot_map
        self._surroundings = host.surroundings
        self._clock = host.clock
        self._laser = Laser(settings.laser, values['seed'], robot.name)
        self._base_frame = settings.frame(values['robot_base_frame'])
        self._frame = settings.frame(values['scan_frame'])
        self._laser_in_base, self._in_laser = InFrame(self._base_frame, self._frame), InFrame(self._frame)
        self._outlet = Outlet(names.topic(values['scan_topic']), LaserScan, queue_size=10, greet=self._greet)
        tf_hub.follow(self._frame, self._present_mount)
        self._throttle = host.throttle(values['max_pose_rate'])
        self._series = host.clock.simulation.series(robot.index, settings.laser.rate, self._tell, is_output=True,
                                                    is_heard=host.timing.when_heard(self._is_heard))
        self._rates = host.rates
        self._told = host.rates.add('scans', lambda: settings.laser.rate, self._outlet.hearers)
        self.restart(host.clock.simulation.now_ns)

    def restart(self, now_ns: int) -> None:
        """Start to scan at ``now_ns`` [ns]."""
        self._series.start_in_step(now_ns)

    def close(self) -> None:
        """Stop scanning, and unregister the topic."""
        self._series.stop()
        self._rates.remove(self._told)
        tf_hub.forget(self._frame)
        self._outlet.unregister()

    def _is_heard(self) -> int:
        return tf_hub.is_heard(self._outlet.is_heard)

    def _tell(self, due_ns: int, _now_ns: int) -> int:
        if self._throttle.ready():
            with sender(self._robot.index):
                if not self._robot.reported.is_mute:
                    self._backend.looks(self._robot.pose_at(due_ns), due_ns)
                tf_hub.send(self._frame, due_ns, self._mount)
                self._outlet.send(lambda seq: self._pack(seq, due_ns))
        return self._clock.wall_to_ns(self._throttle.remaining())

    def _mount(self, stamp_ns: int) -> List[bytes]:
        laser = self._laser.settings
        return [self._laser_in_base.transform(laser.mount, stamp_ns, laser.height)]

    def _present_mount(self) -> Optional[Tuple[int, Callable[[int], List[bytes]]]]:
        now_ns = self._clock.newcomers_ns()
        return None if now_ns is None else (now_ns, self._mount)

    def _greet(self, peer_publish: Publish) -> None:
        now_ns = self._clock.newcomers_ns()
        if now_ns is not None:
            peer_publish(Packed(lambda seq: self._pack(seq, now_ns)))

    def _pack(self, seq: int, stamp_ns: int) -> bytes:
        occupancy = None if self._map.check is None else self._map.check.occupancy
        scan = self._surroundings.scan(self._robot, self._laser, occupancy, stamp_ns)
        return self._in_laser.laser_scan(seq, scan, self._series.period_ns / NS_PER_S)
