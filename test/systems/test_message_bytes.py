"""Messages that we pack and read without genpy have the same bytes as with it. Needs no node; the values are seeded."""

import math
import random
import struct
import unittest
from io import BytesIO

import genpy
import numpy as np
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import Point32, PolygonStamped, PoseStamped, PoseWithCovarianceStamped, TransformStamped, Twist
from move_base_msgs.msg import (
    MoveBaseActionFeedback,
    MoveBaseActionGoal,
    MoveBaseActionResult,
    MoveBaseFeedback,
    MoveBaseGoal,
    MoveBaseResult,
)
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.msg import PlaceTaskFeedback, PlaceTaskResult
from move_base_abstract.sensing.laser import LaserSettings, Scan
from move_base_abstract_ros.messages import conversions, packing
from move_base_abstract_ros.messages.unpacking import GoalIn, ResultIn
from move_base_abstract_ros.robot import work_server

S = 1_000_000_000
TEXTS = ('', 'map', 'robot_0/base_link', 'größer als 10 µm', '東京', 'x' * 300)
FLOATS = (0.0, -0.0, 1e-308, 5e-324, 1e9, -1.5, 3.141592653589793)


def genpys(message, seq=None):
    """Return the bytes that genpy makes of a message."""
    if seq is not None:
        message.header.seq = seq
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class Draws:
    """Random values, the same in every run."""

    def __init__(self, seed):
        self._random = random.Random(seed)

    def number(self):
        return self._random.choice(FLOATS + (self._random.uniform(-1e3, 1e3),))

    def pose(self):
        return Pose2D(self.number(), self.number(), self._random.uniform(-4.0, 4.0))

    def stamp_ns(self):
        return self._random.choice((0, 1, S - 1, S, (2 ** 31 - 1) * S, self._random.randrange(2 ** 31 * S)))

    def text(self):
        return self._random.choice(TEXTS)

    def seq(self):
        return self._random.choice((0, 1, 2 ** 32 - 1, self._random.randrange(2 ** 32)))

    def status(self):
        return GoalStatus(GoalID(conversions.to_time(self.stamp_ns()), self.text()), self._random.randrange(10),
                          self.text())


def packed(status):
    return packing.status(status.goal_id.id, status.goal_id.stamp.to_nsec(), status.status, status.text)


class MessageBytesTest(unittest.TestCase):
    def each(self, count=200):
        for seed in range(count):
            with self.subTest(seed=seed):
                yield Draws(seed)

    def test_1_poses_odometry_and_transforms(self):
        for draws in self.each():
            frame, child, pose = draws.text(), draws.text(), draws.pose()
            stamp_ns, seq = draws.stamp_ns(), draws.seq()
            velocity = draws.number(), draws.number(), draws.number()
            made = packing.InFrame(frame, child)
            turned = conversions.to_pose_stamped(pose, frame, stamp_ns)
            turned.pose.position.z, turned.pose.orientation.x = 0.75, 0.01
            quaternion = conversions.quaternion_tuple(turned.pose.orientation)
            self.assertEqual(made.goal(seq, pose, 0.75, quaternion, stamp_ns), genpys(turned, seq))
            self.assertEqual(made.pose_stamped(seq, pose, stamp_ns),
                             genpys(conversions.to_pose_stamped(pose, frame, stamp_ns), seq))
            amcl_pose = PoseWithCovarianceStamped(header=conversions.to_header(frame, stamp_ns))
            amcl_pose.pose.pose = conversions.to_pose(pose)
            self.assertEqual(made.pose_with_covariance(seq, pose, stamp_ns), genpys(amcl_pose, seq))
            odometry = Odometry(header=conversions.to_header(frame, stamp_ns), child_frame_id=child)
            odometry.pose.pose = conversions.to_pose(pose)
            twist = odometry.twist.twist
            twist.linear.x, twist.linear.y, twist.angular.z = velocity
            self.assertEqual(made.odometry(seq, pose, velocity, stamp_ns), genpys(odometry, seq))
            transform = TransformStamped(header=conversions.to_header(frame, stamp_ns), child_frame_id=child)
            transform.transform.translation.x, transform.transform.translation.y = pose.x, pose.y
            transform.transform.rotation = conversions.to_pose(pose).orientation
            for count in range(3):
                self.assertEqual(packing.transforms([made.transform(pose, stamp_ns)] * count),
                                 genpys(TFMessage([transform] * count)))

    def test_1_scans(self):
        for number in range(20):
            settings = LaserSettings(5.0, 1 + number, -1.0, 2.0, 0.1, 30.0)
            ranges = np.array([math.inf, -math.inf, 0.1, 7.5, 1e-3] * 4, np.float32)[:1 + number]
            made = packing.InFrame(TEXTS[number % 6]).laser_scan(number, Scan(
                number * 123456789, Pose2D(), settings, ranges), 0.2)
            message = LaserScan(header=conversions.to_header(TEXTS[number % 6], number * 123456789),
                                angle_min=-1.0, angle_max=2.0, angle_increment=settings.angle_increment, scan_time=0.2,
                                range_min=0.1, range_max=30.0, ranges=list(ranges))
            self.assertEqual(made, genpys(message, number))

    def test_2_polygons_and_twists(self):
        self.assertEqual(packing.ZERO_TWIST, genpys(Twist()))
        for draws in self.each():
            points = [(draws.seq() / 1e7, -draws.seq() / 3.0) for _ in range(draws.seq() % 5)]
            polygon = PolygonStamped(header=conversions.to_header('map', draws.stamp_ns()))
            polygon.polygon.points = [Point32(x, y, 0.0) for x, y in points]
            seq = draws.seq()
            self.assertEqual(packing.InFrame('map').polygon(seq, points, polygon.header.stamp.to_nsec()),
                             genpys(polygon, seq))

    def test_3_what_an_action_says(self):
        for draws in self.each():
            said, seq, stamp_ns, pose = draws.status(), draws.seq(), draws.stamp_ns(), draws.pose()
            header = conversions.to_header('', stamp_ns)
            self.assertEqual(packing.header(seq, stamp_ns) + packed(said),
                             genpys(MoveBaseActionResult(header, said, MoveBaseResult()), seq))
            place = conversions.to_pose_stamped(pose, 'map', stamp_ns)
            self.assertEqual(
                packing.header(seq, stamp_ns) + packed(said) + packing.InFrame('map').pose_stamped(0, pose, stamp_ns),
                genpys(MoveBaseActionFeedback(header, said, MoveBaseFeedback(place)), seq))
            several = [draws.status() for _ in range(seq % 4)]
            self.assertEqual(packing.statuses(seq, [packed(one) for one in several], stamp_ns),
                             genpys(GoalStatusArray(header, several), seq))

    def test_4_tasks(self):
        for draws in self.each():
            waited_ns, worked_ns = draws.stamp_ns(), draws.stamp_ns()
            waited, worked = (genpy.Duration(ns // S, ns % S) for ns in (waited_ns, worked_ns))
            self.assertEqual(work_server.pack_result(waited_ns, worked_ns), genpys(PlaceTaskResult(waited, worked)))
            for waits in (False, True):
                self.assertEqual(work_server.pack_feedback(waits, worked_ns, 0.3),
                                 genpys(PlaceTaskFeedback(waits, worked, 0.3)))

    def test_5_goals_out_and_in(self):
        for draws in self.each():
            goal = self._goal(draws)
            stamp_ns, target = goal.goal_id.stamp.to_nsec(), goal.goal.target_pose
            place = packing.InFrame(target.header.frame_id).target(target.pose.position.x, target.pose.position.y, 0.5)
            self.assertEqual(packing.action_goal(7, goal.goal_id.id, stamp_ns, place), genpys(goal, 7))
            target.header.stamp = conversions.to_time(draws.stamp_ns())
            target.pose.position.z = target.pose.orientation.x = draws.number()
            read = GoalIn().deserialize(genpys(goal, 7))
            self.assertEqual((read.name, read.stamp_ns, read.target),
                             (goal.goal_id.id, stamp_ns, conversions.from_target(target)))

    def _goal(self, draws):
        stamp = conversions.to_time(draws.stamp_ns())
        place = conversions.to_pose_stamped(Pose2D(draws.number(), draws.number(), 0.5), draws.text(), 0)
        return MoveBaseActionGoal(Header(stamp=stamp), GoalID(stamp, draws.text()), MoveBaseGoal(PoseStamped(
            place.header, place.pose)))

    def test_6_results_in(self):
        for draws in self.each():
            said = draws.status()
            read = ResultIn().deserialize(genpys(MoveBaseActionResult(Header(frame_id=draws.text()), said, None)))
            self.assertEqual((read.name, read.state, read.said), (said.goal_id.id, said.status, said.text))

    def test_7_what_is_cut_off_or_no_text_is_read_as_genpy_reads_it(self):
        goal = genpys(self._goal(Draws(3)))
        for length in range(len(goal)):
            with self.assertRaises(genpy.DeserializationError):
                GoalIn().deserialize(goal[:length])
        result = genpys(MoveBaseActionResult(Header(), GoalStatus(GoalID(id='a goal'), 3, 'reached'), None))
        for length in range(len(result)):
            cut = result[:length]
            try:
                expected = MoveBaseActionResult().deserialize(cut).status
            except genpy.DeserializationError:
                with self.assertRaises(genpy.DeserializationError):
                    ResultIn().deserialize(cut)
            else:  # genpy accepts a text that ends too early
                self.assertEqual(ResultIn().deserialize(cut).said, expected.text)
        for kind, whole in ((GoalIn, goal), (ResultIn, result)):
            with self.assertRaises(genpy.DeserializationError):
                kind().deserialize(whole[:12] + struct.pack('<I', 2 ** 32 - 1) + whole[16:])
        bad = genpys(MoveBaseActionGoal(goal_id=GoalID(id='ab'))).replace(b'ab', b'a\xff')
        self.assertEqual(GoalIn().deserialize(bad).name, MoveBaseActionGoal().deserialize(bad).goal_id.id)

    def test_8_they_stand_for_their_types(self):
        for kind in (GoalIn, ResultIn):
            self.assertEqual((kind._type, kind._md5sum), (kind.__base__._type, kind.__base__._md5sum))
