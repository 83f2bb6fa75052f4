"""The backend for Stage: it sends each pose to Stage, and Stage reports where the robot is."""
from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Tuple, Type

import rospy
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry

from move_base_abstract.common.errors import FrameError
from move_base_abstract.engine.series import NOBODY
from move_base_abstract.motion.geometry import Pose2D, normalize_angle
from move_base_abstract.supervision.follow_check import FollowCheck, StampCheck

from ..messages import conversions
from ..messages.packing import InFrame
from ..transforms import tf_hub
from ..transforms.tf_lookup import TfLookup
from . import clock_check, stage_watch

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings

    from ..robot.names import RobotNames

_REMINDER_SECONDS = 10.0
_EXACT = 1e-6  # m and rad; what goes to Stage and comes back is rounded


class StageBackend:
    """Sends ``cmd_pose`` to Stage and hears its ``base_pose_ground_truth`` and ``odom``; publishes ``amcl_pose``,
    ``robot_pose`` and tf ``map -> odom``, so that Stage's own ``odom -> base_link`` ends where Stage shows the robot.

    A command is sent only as an answer to Stage's ground truth, and only if that is another pose. So Stage gets at most
    one command in a step, in the pause before the next step. The reason: stage_ros takes commands in a thread of its
    own, and Stage's world has no lock against it. A command that comes while the world is updated can make Stage crash.
    For the same reason ``cmd_pose`` is not latched.

    Threading: ``place`` and ``heartbeat`` are called by one thread, and Stage's topics by others. The lock guards what
    both use, and is never held while tf is sent.
    """  # noqa: D205

    def __init__(self, names: RobotNames, settings: RobotSettings) -> None:
        values = settings.values
        self._robot = names.robot
        self._global_frame = values['global_frame']
        self._odom_frame = settings.odom_frame
        self._odom_in_map = InFrame(self._global_frame, self._odom_frame)
        self._lock = threading.Lock()
        self.frames = [self._odom_frame] if self._odom_frame != self._global_frame else []
        if not self.frames:
            rospy.logwarn("%s: the global frame is '%s', in which Stage itself publishes the robot's pose: tf shows "
                          "Stage's odometry", names.robot, self._odom_frame)
        self._world = _StageWorld(names.robot, values)
        self._check = FollowCheck()
        self._stamps = StampCheck()
        self._wanted: Optional[Pose2D] = None
        self._truth: Any = (None, None)
        self._odom: Any = (None, None)
        self._tf: Any = None
        self._sent = (-1, None)
        self._cmd_pose = rospy.Publisher(names.topic('cmd_pose'), Pose, queue_size=1)
        self._amcl_pose = _latched(names.topic('amcl_pose'), PoseWithCovarianceStamped)
        self._robot_pose = _latched(names.topic('robot_pose'), PoseStamped)
        self._truth_topic = names.topic('base_pose_ground_truth')
        self._subscribers = (rospy.Subscriber(self._truth_topic, Odometry, self._on_truth, queue_size=10),
                             rospy.Subscriber(names.topic('odom'), Odometry, self._on_odom, queue_size=10))
        stage_watch.add(self._truth_topic)
        clock_check.warn_of_machine_clock('Stage')

    def place(self, pose: Pose2D, _velocity: Tuple[float, float, float], stamp_ns: int) -> None:
        """Publish that the robot is at ``pose``; send it to Stage at Stage's next step."""
        self._robot_pose.publish(conversions.to_pose_stamped(pose, self._global_frame, stamp_ns))
        amcl_pose = PoseWithCovarianceStamped(header=conversions.to_header(self._global_frame, stamp_ns))
        amcl_pose.pose.pose = conversions.to_pose(pose)
        self._amcl_pose.publish(amcl_pose)
        with self._lock:
            self._wanted = pose
        self.heartbeat(pose, stamp_ns)

    def rests(self, _pose: Pose2D, _stamp_ns: int) -> None:
        """Do nothing: Stage publishes odometry all the time."""

    @staticmethod
    def is_odometry_heard() -> int:
        """Return NOBODY (0): listeners get the odometry from Stage."""
        return NOBODY

    def looks(self, _pose: Pose2D, _stamp_ns: int) -> None:
        """Do nothing: Stage publishes its part of tf at each of its steps."""

    def follow(self, _present: Callable[[], Any]) -> None:
        """Do nothing: on the scaled clock a new listener gets what was told last."""

    def heartbeat(self, _pose: Pose2D, stamp_ns: int) -> None:
        """Publish tf again. If Stage uses another clock, do nothing: tf must have the stamps of Stage's own part."""
        if self._stamps.is_alike:
            self._send_tf(stamp_ns)

    def restart(self) -> None:
        """Allow earlier stamps, because time has started anew."""
        with self._lock:
            self._sent = (-1, None)

    def close(self) -> None:
        """Unregister all topics."""
        stage_watch.remove(self._truth_topic)
        self._world.close()
        for topic in (*self._subscribers, self._cmd_pose, self._amcl_pose, self._robot_pose):
            topic.unregister()

    def _command(self, reported: Pose2D) -> None:
        """Send the wanted pose to Stage, if it is not the pose ``reported`` by Stage (both in Stage's world)."""
        world = self._world.pose()
        with self._lock:
            if world is None or self._wanted is None:
                return
            wanted = world.compose(self._wanted)
            self._check.placed(wanted, time.monotonic())
        if wanted.distance_to(reported) > _EXACT or abs(normalize_angle(wanted.yaw - reported.yaw)) > _EXACT:
            self._cmd_pose.publish(conversions.to_pose(wanted))

    def _on_odom(self, message: Any) -> None:
        stamp = message.header.stamp
        with self._lock:
            if self._odom[0] is not None and stamp < self._odom[0]:  # Stage has started anew
                self._sent = (-1, None)
            self._odom = (stamp, conversions.from_pose(message.pose.pose))
            gap = self._stamps.reported(stamp.to_nsec(), rospy.Time.now().to_nsec(), time.monotonic())
        if gap is not None:
            clock_check.warn_of_other_clock('Stage', self._robot, gap)
        self._locate()

    def _on_truth(self, message: Any) -> None:
        reported = conversions.from_pose(message.pose.pose)
        stage_watch.heard(self._truth_topic)
        self._command(reported)
        with self._lock:
            self._truth = (message.header.stamp, reported)
            gap = self._check.reported(reported, time.monotonic())
        clock_check.warn_if_shared('Stage')
        if gap is not None:
            self._complain(gap)
        self._locate()

    def _complain(self, gap: float) -> None:
        deaf = '; no node subscribes to cmd_pose: this stage_ros has no such topic, or uses another name for the robot'
        rospy.logwarn('%s: Stage does not follow: the robot is %.2f m from where it was placed%s', self._robot, gap,
                      '' if self._cmd_pose.get_num_connections() else deaf)

    def _locate(self) -> None:
        """Compute map -> odom, so that Stage's odometry and its ground truth of one instant agree, and publish it."""
        world: Any = self._world.pose()
        with self._lock:
            (odom_stamp, odom), (truth_stamp, truth) = self._odom, self._truth
            if world is None or odom_stamp is None or odom_stamp != truth_stamp:
                return
            self._tf = world.inverse().compose(truth).compose(odom.inverse())
        self._send_tf(odom_stamp.to_nsec())

    def _send_tf(self, stamp_ns: int) -> None:
        """Publish map -> odom at ``stamp_ns``, or 1 ns after the last stamp if that is later."""
        with self._lock:
            last_ns, last = self._sent
            if self._tf is None or not self.frames:
                return
            if stamp_ns <= last_ns and self._tf == last:
                return
            stamp_ns = max(stamp_ns, last_ns + 1)
            self._sent = (stamp_ns, self._tf)
            transform = self._odom_in_map.transform(self._tf, stamp_ns)
        tf_hub.send(self._odom_frame, stamp_ns, lambda _stamp_ns: [transform])


class _StageWorld:
    """The pose of the global frame's origin in Stage's world, from parameters, or from tf as soon as tf has it."""

    def __init__(self, robot: str, values: Mapping[str, Any]) -> None:
        self._robot = robot
        self._frame = values['stage_world_frame']
        self._pose = None
        self._since = time.monotonic()
        if self._frame is None:
            self._pose = Pose2D(values['stage_offset_x'], values['stage_offset_y'], values['stage_offset_yaw'])
        else:
            self._lookup: Any = TfLookup(values['global_frame'])
            self._lookup.wait_for(self._frame, 0)

    def pose(self) -> Optional[Pose2D]:
        """Return the Pose2D, or None while it is not known. Never blocks."""
        if self._pose is None:
            try:
                self._pose = self._lookup.lookup(self._frame, 0).inverse()
                self._lookup.close()
            except FrameError as error:
                self._remind(error)
        return self._pose

    def close(self) -> None:
        """Stop listening to tf."""
        if self._pose is None:
            self._lookup.close()

    def _remind(self, error: FrameError) -> None:
        if time.monotonic() - self._since > _REMINDER_SECONDS:
            self._since = time.monotonic()
            rospy.logwarn("%s: stage_world_frame '%s' is not known to tf yet, and Stage gets no poses until then: %s",
                          self._robot, self._frame, error)


def _latched(topic: str, message_type: Type[Any]) -> Any:
    return rospy.Publisher(topic, message_type, queue_size=10, latch=True)
