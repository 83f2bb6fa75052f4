"""Putting a robot somewhere: ``initialpose`` and ``set_pose`` (topics), ``set_robot_pose`` (service)."""
import rospy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped

from move_base_abstract.errors import FrameError
from move_base_abstract.srv import SetPose, SetPoseResponse

from . import conversions


class Teleport:
    """Listens for poses and hands them to ``navigator``; what cannot be used moves nothing and is told."""

    def __init__(self, names, clock, navigator, frames, prefetch):
        self._names = names
        self._clock = clock
        self._navigator = navigator
        self._frames = frames
        self._prefetch = prefetch
        self._subscribers = (
            rospy.Subscriber(names.topic('initialpose'), PoseWithCovarianceStamped, lambda message: self._on_pose(
                'initialpose', message.header, message.pose.pose), queue_size=1),
            rospy.Subscriber(names.topic('set_pose'), PoseStamped, lambda message: self._on_pose(
                'set_pose', message.header, message.pose), queue_size=1))
        self._service = rospy.Service(names.topic('set_robot_pose'), SetPose, self._serve)

    def close(self):
        """Listen no more."""
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._service.shutdown('the robot is removed')

    def _on_pose(self, topic, header, pose):
        text = self._place(header, pose)
        if text:
            rospy.logwarn('%s: %s is refused, the robot stays where it is: %s', self._names.robot, topic, text)

    def _serve(self, request):
        text = self._place(request.pose.header, request.pose.pose)
        return SetPoseResponse(success=not text, message=text or 'The robot is there.')

    def _place(self, header, message):
        """Put the robot there; return why not, or ''."""
        frame_id = header.frame_id.lstrip('/') or self._frames.global_frame
        self._prefetch(frame_id, 0)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            try:
                pose = self._frames.locate(frame_id, 0, now_ns).compose(conversions.from_pose(message))
            except (FrameError, ValueError) as error:
                return str(error)
            self._navigator.place(pose, now_ns)
        return ''
