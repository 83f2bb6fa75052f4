"""The built-in simulator: the robot is where the core says, and tf and a few topics tell so."""
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry

from move_base_abstract.geometry import Pose2D

from .. import conversions, tf_hub
from ..lazy_latch import LazyLatch


class BuiltinBackend:
    """tf ``map -> odom -> base_link``, ``amcl_pose``, ``odom``, ``base_pose_ground_truth`` and ``robot_pose``.

    Odometry is perfect and starts at the map's origin: ``odom`` coincides with ``map``, or is the global frame itself.
    The topics are latched, so that who comes late learns where the robot stands.
    """

    def __init__(self, names, settings):
        self._global_frame = settings.values['global_frame']
        self._odom_frame = settings.odom_frame
        self._base_frame = settings.frame(settings.values['robot_base_frame'])
        self.frames = [frame for frame in (self._odom_frame, self._base_frame) if frame != self._global_frame]
        self._tf_stamp_ns = -1
        self._tf_pose = None
        self._amcl_pose = LazyLatch(names.topic('amcl_pose'), PoseWithCovarianceStamped)
        self._odom = LazyLatch(names.topic('odom'), Odometry)
        self._ground_truth = LazyLatch(names.topic('base_pose_ground_truth'), Odometry)
        self._robot_pose = LazyLatch(names.topic('robot_pose'), PoseStamped)

    def place(self, pose, velocity, stamp_ns):
        """Publish that the robot is at ``pose`` with ``velocity``."""
        self.heartbeat(pose, stamp_ns)
        self._robot_pose.offer(lambda: conversions.to_pose_stamped(pose, self._global_frame, stamp_ns))
        self._amcl_pose.offer(lambda: self._with_covariance(pose, stamp_ns))
        self._odom.offer(lambda: self._odometry(pose, velocity, self._odom_frame, stamp_ns))
        self._ground_truth.offer(lambda: self._odometry(pose, velocity, self._global_frame, stamp_ns))

    def heartbeat(self, pose, stamp_ns):
        """Publish tf only. tf takes one pose per instant, so a jump is dated 1 ns after what was said before."""
        if stamp_ns <= self._tf_stamp_ns:
            if pose == self._tf_pose:
                return
            stamp_ns = self._tf_stamp_ns + 1
        self._tf_stamp_ns, self._tf_pose = stamp_ns, pose
        tf_hub.send(self._base_frame, lambda: self._transforms(pose, stamp_ns))

    def restart(self):
        """Time has started anew."""
        self._tf_stamp_ns = -1

    def close(self):
        """Leave the graph."""
        tf_hub.forget(self._base_frame)
        for publisher in (self._amcl_pose, self._odom, self._ground_truth, self._robot_pose):
            publisher.unregister()

    def _transforms(self, pose, stamp_ns):
        base = conversions.to_transform(pose, self._odom_frame, self._base_frame, stamp_ns)
        if self._odom_frame == self._global_frame:  # without a map; tf allows no frame to be its own parent
            return [base]
        return [conversions.to_transform(Pose2D(), self._global_frame, self._odom_frame, stamp_ns), base]

    def _with_covariance(self, pose, stamp_ns):
        message = PoseWithCovarianceStamped(header=conversions.to_header(self._global_frame, stamp_ns))
        message.pose.pose = conversions.to_pose(pose)
        return message

    def _odometry(self, pose, velocity, frame_id, stamp_ns):
        odometry = Odometry(header=conversions.to_header(frame_id, stamp_ns), child_frame_id=self._base_frame)
        odometry.pose.pose = conversions.to_pose(pose)
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = velocity
        return odometry
