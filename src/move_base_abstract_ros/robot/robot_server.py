"""What all robots of a process have in ROS, whether they travel to goals or are driven by velocities."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence

import rospy
from std_msgs.msg import Int32

from move_base_abstract.fleet.robot_rows import write
from move_base_abstract.goals.activity import activity, emptied
from move_base_abstract.goals.events import EMPTY, ChargePassed, Warned, motion_of, robot_stream
from move_base_abstract.goals.outcome import NODE_KILLED, ROBOT_REMOVED, ROBOT_RESET

from .. import lockstep
from ..clocks.throttle import WallThrottle
from ..markers import robot_markers
from ..transforms import tf_watch
from .condition_server import ConditionServer
from .work_server import ACTION as WORK, WorkServer

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.faults.condition import Condition
    from move_base_abstract.goals.navigator import Navigator
    from move_base_abstract.motion.frames import RobotFrames
    from move_base_abstract.motion.robot import Robot
    from move_base_abstract.tasks.place_tasks import PlaceTaskRunner
    from move_base_abstract.tasks.room import Rooms
    from move_base_abstract.traffic.control import Traffic
    from move_base_abstract.traffic.traveller import Traveller

    from ..backends import Backend
    from ..clocks.timing import Clock
    from ..maps.robot_map import RobotMap
    from ..transforms.tf_lookup import TfLookup
    from .host import Host
    from .names import RobotNames
    from .scan_publisher import ScanPublisher

_REPEATED_WARNINGS_RATE = 0.2  # Hz, wall


class RobotServer:
    """One robot of a process's :class:`Host`. A kind of robots has a class of its own, which sets it up."""

    navigator: Navigator
    condition: Condition
    _map: RobotMap
    _frames: RobotFrames
    _lookup: TfLookup
    _publisher: Any

    def __init__(self, names: RobotNames, settings: RobotSettings, host: Host, robot_index: int = 0,
                 traffic: Optional[Traffic] = None, rooms: Optional[Rooms] = None) -> None:
        """``traffic``: the Traffic in which the robot takes part; None if it is alone.

        ``rooms``: the Rooms in which it does tasks at places; None if it does no tasks.
        """
        clock = host.clock
        self._traffic = traffic
        self._traveller: Optional[Traveller] = None
        self._priority: Optional[PriorityTopic] = None
        self._work: Optional[WorkServer] = None
        self._names = names
        self._settings = settings
        self._clock = clock
        self._host = host
        self._last_warning: Optional[str] = None
        self._warning_throttle = WallThrottle(_REPEATED_WARNINGS_RATE)
        self._stream = robot_stream()
        write(self._stream, 'trace', host.events.record(robot_index), settings.values['log_motion'])
        self._stream.subscribe('shown', {Warned: lambda event: self.warn(event.text),
                                         ChargePassed: self._charge_passed})
        with lockstep.sender(robot_index):
            with clock.lock:
                clock.now_ns()
                self._build(robot_index)
            self._set_up()
            if rooms is not None:
                self._work = self._make_work(rooms, robot_index)
        clock.follow_restarts(self._restart)
        host.robot_count += 1  # last, so that a robot whose settings are refused does not count

    def _build(self, robot_index: int) -> None:
        """Make the robot and what publishes of it. The caller holds the lock."""
        raise NotImplementedError

    def _set_up(self) -> None:
        """Make the topics and services that tell it what to do. The caller holds no lock."""
        raise NotImplementedError

    def _topics(self) -> Sequence[Any]:
        """Return what has topics and services, in the order in which they are closed; None: nothing."""
        raise NotImplementedError

    def _forget_goals(self, is_removed: bool) -> None:
        """Forget the goals, which have ended, because the robot is removed or reset. The caller holds the lock."""

    def _put_at_start(self, now_ns: int) -> None:
        self.navigator.robot.reset(self._settings.start, now_ns)

    def _begin(self, robot: Robot, backend: Backend, robot_index: int) -> None:
        """Begin to show and to simulate ``robot``, whose parts and publisher are there. The caller holds the lock."""
        settings, values = self._settings, self._settings.values
        self._frames_told = backend.frames
        self._host.surroundings.add(robot, values['global_frame'], settings.costmaps.global_footprint)
        self._scans = self._make_scans(robot, backend)
        self._host.timing.claim_frames(self._names.robot, self._frames_told)
        self._condition_server = ConditionServer(self._names, settings, self._host, robot_index, self.condition,
                                                 self._stream)
        self._markers = robot_markers.add(self._clock, settings, self.navigator, self._stream, self._state,
                                          self.condition.battery is not None or settings.drive is not None)
        if self._traffic is not None:
            self._traveller = self._traffic.join(self.navigator, settings.network, self._stream,
                                                 values['priority'])
        self.condition.begin(self._clock.simulation.now_ns)

    def _make_scans(self, robot: Robot, backend: Backend) -> Optional[ScanPublisher]:
        if not self._settings.laser.rate:
            return None
        from .scan_publisher import ScanPublisher  # imported here, because only robots with a laser need numpy
        return ScanPublisher(self._names, self._settings, self._host, robot, backend, self._map)

    def _make_work(self, rooms: Rooms, robot_index: int) -> WorkServer:
        names, values = self._names, self._settings.values
        return WorkServer(names.topic(WORK), names.robot, robot_index, self._host, rooms, {
            'seed': values['seed'], 'frame': values['global_frame'],
            'feedback_freq': self._host.timing.task_feedback_frequency,
            'min_answer_delay': values['min_answer_delay']}, self._stream, self.navigator.robot,
            lambda: self.condition.is_out_of_order)

    def shut_down(self) -> None:
        """End all that the robot works on, as a killed node does."""
        if self._work is not None:
            self._work.shut_down(NODE_KILLED)
        with self._clock.lock:
            self.navigator.close(NODE_KILLED, self._clock.now_ns())

    def close(self) -> None:
        """Remove the robot from the world: end its goal, and unregister its topics and services."""
        if self._work is not None:
            self._work.close(ROBOT_REMOVED)
        for part in self._topics():
            if part is not None:
                part.close()
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self.condition.close()
            self.navigator.close(ROBOT_REMOVED, now_ns)
            if self._traveller is not None:
                self._traveller.leave(now_ns)
            self._clock.simulation.queue.guard(self.navigator.robot.index, None)
            self._forget_goals(True)
            self._publisher.close()
            self._host.surroundings.remove(self.navigator.robot)
            if self._scans is not None:
                self._scans.close()
            tf_watch.release(self._frames_told)
            self._markers.close()
            self._clock.leave_restarts(self._restart)
        self._host.robot_count -= 1

    def reset(self) -> None:
        """Set everything but the time as at the start: the start pose, the first limits, no goals."""
        if self._work is not None:
            self._work.shut_down(ROBOT_RESET)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self.navigator.reset(ROBOT_RESET, now_ns)
            self._forget_goals(False)
            self.condition.reset(now_ns)
            self._put_at_start(now_ns)
            self._stream.tell(motion_of(self.navigator.robot, now_ns))
            self.navigator.travel.tell_stands(now_ns)

    def _restart(self, before_ns: int, now_ns: int) -> None:
        self._publisher.restart()
        if self._scans is not None:
            self._scans.restart(now_ns)
        self.condition.restart(now_ns - before_ns)
        self.navigator.restart(before_ns, now_ns)

    def _state(self) -> str:
        return activity(self.navigator, self.condition, self._tasks)

    @property
    def _tasks(self) -> Optional[PlaceTaskRunner]:
        return None if self._work is None else self._work.tasks

    def _charge_passed(self, event: ChargePassed) -> None:
        if event.what == EMPTY:
            self.warn(emptied(self.navigator, self._tasks, event.time_ns))

    def warn(self, text: str) -> None:
        """Log a warning; the same text at most once in 5 s of wall time."""
        if text != self._last_warning or self._warning_throttle.ready():
            self._last_warning = text
            rospy.logwarn('%s: %s', self._names.robot, text)

    def _prefetch_frame(self, frame_id: str, stamp_ns: int) -> None:
        """Wait until a foreign frame is known in tf, or for a while. This blocks only the topic that asks for it."""
        if self._frames.is_foreign(frame_id) and not frame_id.startswith('/'):
            self._lookup.wait_for(frame_id, stamp_ns)


class PriorityTopic:
    """Sets the priority of ``traveller`` (Traveller), which is the robot with ``names`` in the traffic."""

    def __init__(self, names: RobotNames, clock: Clock, traveller: Traveller) -> None:
        self._clock = clock
        self._traveller = traveller
        self._subscriber = rospy.Subscriber(names.own('priority'), Int32, self._on_priority, queue_size=10,
                                            tcp_nodelay=True)

    def close(self) -> None:
        """Unregister the topic."""
        self._subscriber.unregister()

    def _on_priority(self, message: Any) -> None:
        with self._clock.lock:
            self._traveller.set_priority(message.data, self._clock.now_ns())
