"""Move a robot to a pose at once: topics ``initialpose``, ``set_pose``, ``cmd_pose``; service ``set_robot_pose``.

With the parameter ``compatible_with`` also ``robot_pose``: the original package believes it, whichever node sends it.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

import rospy
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from std_msgs.msg import Header

from move_base_abstract.common.errors import FrameError
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.original import is_rasberry
from move_base_abstract.srv import SetPose, SetPoseResponse

from ..backends import STAGE
from ..messages import conversions

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.motion.frames import RobotFrames
    from move_base_abstract.motion.robot import Robot

    from ..clocks.timing import Clock
    from .names import RobotNames


class Teleport:
    """Listens for poses, to which ``put(pose, now_ns)`` moves ``robot`` (Robot).

    A pose that cannot be used moves nothing, and is reported.
    """

    def __init__(self, names: RobotNames, settings: RobotSettings, clock: Clock, robot: Robot,
                 put: Callable[[Pose2D, int], object], frames: RobotFrames,
                 prefetch: Callable[[str, int], object]) -> None:
        self._names = names
        self._clock = clock
        self._robot = robot
        self._put = put
        self._frames = frames
        self._prefetch = prefetch
        self._subscribers = [rospy.Subscriber(names.topic('set_pose'), Pose, lambda message: self._on_pose(
            'set_pose', Header(), message), queue_size=1)]
        if settings.values['initialpose_moves']:
            self._subscribers.insert(0, rospy.Subscriber(
                names.topic('initialpose'), PoseWithCovarianceStamped, lambda message: self._on_pose(
                    'initialpose', message.header, message.pose.pose), queue_size=1))
        if settings.values['backend'] not in STAGE:  # with Stage, the topic belongs to Stage
            values = settings.values
            self._world = Pose2D(values['stage_offset_x'], values['stage_offset_y'], values['stage_offset_yaw'])
            self._subscribers.append(rospy.Subscriber(names.topic('cmd_pose'), Pose, lambda message: self._on_pose(
                'cmd_pose', Header(), message, self._world.inverse()), queue_size=1))
        if settings.original is not None:
            self._subscribers.append(rospy.Subscriber(
                names.topic('robot_pose'), Pose if is_rasberry(settings.original) else PoseStamped,
                self._on_robot_pose, queue_size=1))
        self._service = rospy.Service(names.topic('set_robot_pose'), SetPose, self._serve)

    def close(self) -> None:
        """Unregister the topics and the service."""
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._service.shutdown('the robot is removed')

    def _on_robot_pose(self, message: Any) -> None:
        """Believe a pose from another node, if the robot stands. A robot that drives goes on as it was.

        In the original, too, such a robot soon publishes its own pose again.
        """
        if message._connection_header['callerid'] != rospy.get_name() and self._robot.leg is None:
            self._on_pose('robot_pose', getattr(message, 'header', Header()), getattr(message, 'pose', message))

    def _on_pose(self, topic: str, header: Any, pose: Any, origin: Pose2D = Pose2D()) -> None:
        text = self.place(header, pose, origin)
        if text:
            rospy.logwarn('%s: %s is refused, the robot stays where it is: %s', self._names.robot, topic, text)

    def _serve(self, request: Any) -> Any:
        text = self.place(request.pose.header, request.pose.pose)
        return SetPoseResponse(success=not text, message=text or 'The robot is there.')

    def place(self, header: Any, message: Any, origin: Pose2D = Pose2D()) -> str:
        """Move the robot to a pose; return '' or the reason why it cannot be used.

        ``message`` (Pose) is seen from ``origin`` (Pose2D), which lies in the frame of ``header``.
        """
        frame_id = header.frame_id.lstrip('/') or self._frames.global_frame
        self._prefetch(frame_id, 0)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            try:
                pose = self._frames.locate(frame_id, 0, now_ns).compose(origin).compose(
                    conversions.from_pose(message))
            except (FrameError, ValueError) as error:
                return str(error)
            self._put(pose, now_ns)
        return ''
