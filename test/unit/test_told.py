"""Motions as the log and the time master are told of them: the same poses to the last bit, and what is no motion."""
import json
import struct

import pytest

from move_base_abstract.motion.approach import MotionPhases
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits
from move_base_abstract.motion.pace import Pace, PacedLeg
from move_base_abstract.motion.pieces import Piece
from move_base_abstract.motion.robot import Robot
from move_base_abstract.motion.told import ToldMotion, motion_of_row, packed, told, told_of

PHASES = MotionPhases((0.5, 0.1), 2.0, 0.1, 1.0, 2.0, 0.1)
REST = [9, 4.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
PIECE = [5, 0.0, 0.0, 0.0, 1.0, 0.0, 1e9, 0.0, 0.0, 0.0]


@pytest.mark.parametrize('limits', [MotionLimits(0.5), MotionLimits(0.5, 0.3, 1.0), MotionLimits(2.0, 0.1)])
@pytest.mark.parametrize('phases', [None, PHASES])
@pytest.mark.parametrize('corners', [[], [(1.0, 1.0)]])
@pytest.mark.parametrize('paced', [None, lambda leg: PacedLeg(leg, Pace(10**8, 1.3))])
def test_a_motion_that_was_told_is_the_motion(limits, phases, corners, paced):
    leg = Robot(0, 'r', limits=limits, phases=phases).depart(Pose2D(3, 4, 1.0), 5, corners, paced)
    again = motion_of_row(json.loads(json.dumps(told(leg))))
    assert (again.depart_ns, again.arrive_ns, again.start, again.end) == (5, leg.arrive_ns, leg.pose_at(5), leg.end)
    assert again.distance == pytest.approx(leg.distance)
    for now_ns in range(5, leg.arrive_ns + 10**9, 123_456_789):
        assert (again.pose_at(now_ns), again.velocity_at(now_ns)) == (leg.pose_at(now_ns), leg.velocity_at(now_ns))


def test_a_robot_that_stands_is_told_as_a_piece_at_rest_and_bytes_are_little_endian():
    robot = Robot(0, 'r', Pose2D(1.0, 2.0, 0.0))
    assert told_of(robot, 7) == (Piece(7, 1.0, 2.0, 0.0, 1.0, 0.0),)
    leg = robot.depart(Pose2D(3.0, 2.0), 10**9)
    assert told_of(robot, 10**9) == told(leg) and told_of(robot, leg.arrive_ns) == told(leg)[-1:]
    assert list(struct.iter_unpack('<q9d', packed(told(leg)))) == list(told(leg))
    assert isinstance(ToldMotion(told(leg)[-1:]).pieces, tuple) and not ToldMotion(told(leg)[-1:]).pieces


@pytest.mark.parametrize('values', [
    [], [REST[:9]], [[*REST, 0.0]], [None], [REST, REST], [[9.0, *REST[1:]]], [[-1, *REST[1:]]], [[*REST[:9], -0.5]],
    [[5, *REST[1:7], 0.1, 0.0, -1.0], REST],
    [[9, 1e9 + 1.0, *REST[2:]]], [[9, 'x', *REST[2:]]], [[9, True, *REST[2:]]], [[2**62, *REST[1:]]], [PIECE],
    [[9, float('nan'), *REST[2:]]], [[9, 10**400, *REST[2:]]], [[5, 9e8, *PIECE[2:]], [2 * 10**9, *REST[1:]]]])
def test_a_row_of_others_is_no_motion(values):
    assert motion_of_row([REST]).end == Pose2D(4.0, 0.0)
    assert motion_of_row(values) is None
