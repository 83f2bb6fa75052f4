"""Poses, angles and quaternions: values, limits and the faults that move_base finds in a goal's orientation."""

import copy
import dataclasses
import math
import pickle

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.motion.geometry import (
    Pose2D,
    normalize_angle,
    quaternion_fault,
    quaternion_of_yaw,
    share_along,
    yaw_of_quaternion,
)

NAN_FAULT = 'Quaternion has nans or infs... discarding as a navigation goal'
SHORT_FAULT = 'Quaternion has length close to zero... discarding as navigation goal'
TILTED_FAULT = 'Quaternion is invalid... for navigation the z-axis of the quaternion must be close to vertical.'

ANGLES = st.floats(-1e3, 1e3)
COORDINATES = st.floats(-1e4, 1e4)
POSES = st.builds(Pose2D, COORDINATES, COORDINATES, ANGLES)


def tilted(angle):
    """Return the quaternion of a rotation about x by ``angle`` [rad]."""
    return math.sin(angle / 2), 0.0, 0.0, math.cos(angle / 2)


# ---- angles

@pytest.mark.parametrize('angle, equal', [
    (0.0, 0.0), (math.pi, math.pi), (-math.pi, math.pi), (2 * math.pi, 0.0), (3 * math.pi, math.pi),
    (-0.5, -0.5), (math.pi + 0.5, 0.5 - math.pi), (-math.pi - 0.5, math.pi - 0.5)])
def test_an_angle_is_wrapped_into_minus_pi_excluded_to_pi_included(angle, equal):
    assert normalize_angle(angle) == pytest.approx(equal, abs=1e-12)


@given(ANGLES)
def test_a_wrapped_angle_is_in_range_points_the_same_way_and_stays_as_it_is(angle):
    wrapped = normalize_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)
    assert normalize_angle(wrapped) == wrapped


# ---- poses

@pytest.mark.parametrize('name', ['x', 'y', 'yaw'])
@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
def test_a_pose_refuses_values_that_are_not_finite_and_names_them(name, value):
    with pytest.raises(ValueError) as error:
        Pose2D(**{name: value})
    assert str(error.value) == 'pose: {} must be finite, got {!r}'.format(name, value)


def test_a_pose_cannot_be_changed_and_its_yaw_is_wrapped():
    pose = Pose2D(1.0, 2.0, 2 * math.pi + 0.5)
    assert pose.yaw == pytest.approx(0.5)
    with pytest.raises(dataclasses.FrozenInstanceError):
        pose.x = 3.0


def test_distance_and_bearing_of_a_three_four_five_triangle():
    start, goal = Pose2D(1.0, 1.0, 2.0), Pose2D(4.0, 5.0, -1.0)
    assert (start.distance_to(goal), start.bearing_to(goal)) == (5.0, math.atan2(4.0, 3.0))


def test_a_local_pose_is_turned_and_moved_into_the_frame_of_the_other():
    composed = Pose2D(5.0, 5.0, math.pi / 2).compose(Pose2D(2.0, 1.0, math.pi))
    assert (composed.x, composed.y, composed.yaw) == pytest.approx((4.0, 7.0, -math.pi / 2))


@given(POSES, POSES, POSES)
def test_composing_is_associative_keeps_distances_and_the_origin_changes_nothing(a, b, c):
    left, right = a.compose(b).compose(c), a.compose(b.compose(c))
    assert left.distance_to(right) < 1e-6
    assert normalize_angle(left.yaw - right.yaw) == pytest.approx(0.0, abs=1e-9)
    assert a.compose(b).distance_to(a.compose(c)) == pytest.approx(b.distance_to(c), abs=1e-6)
    assert Pose2D().compose(b) == b


@given(POSES)
def test_a_pose_and_its_inverse_undo_one_another(pose):
    for nowhere in (pose.compose(pose.inverse()), pose.inverse().compose(pose)):
        assert nowhere.distance_to(Pose2D()) < 1e-9
        assert nowhere.yaw == pytest.approx(0.0, abs=1e-9)


# ---- quaternions

@given(ANGLES, st.floats(1e-2, 1e3))
def test_the_yaw_of_a_quaternion_of_any_length_is_read_back(yaw, length):
    quaternion = tuple(length * part for part in quaternion_of_yaw(yaw))
    assert normalize_angle(yaw_of_quaternion(quaternion) - yaw) == pytest.approx(0.0, abs=1e-9)
    assert quaternion_fault(quaternion) is None


def test_the_yaw_of_a_slightly_tilted_quaternion_is_its_turn_about_z():
    half = 0.02 / 2
    turn = quaternion_of_yaw(1.0)
    tilt = (math.sin(half), 0.0, 0.0, math.cos(half))
    product = (turn[3] * tilt[0] + turn[2] * tilt[1], turn[3] * tilt[1] + turn[2] * tilt[0],
               turn[2] * tilt[3], turn[3] * tilt[3])
    assert yaw_of_quaternion(product) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize('quaternion, fault', [
    ((0.0, 0.0, 0.0, 1.0), None),
    ((0.0, 0.0, 0.0, -1.0), None),
    ((0.0, 0.0, 3.0, 4.0), None),
    ((0.0, 0.0, 0.0, 0.0), SHORT_FAULT),
    ((0.0, 0.0, 0.0, 0.99e-3), SHORT_FAULT),
    ((0.0, 0.0, 0.0, 1.01e-3), None),
    ((1.0, 0.0, 0.0, 0.0), TILTED_FAULT),
    ((0.0, 1.0, 0.0, 1.0), TILTED_FAULT),
    (tilted(0.9 * math.acos(1.0 - 1e-3)), None),
    (tilted(1.1 * math.acos(1.0 - 1e-3)), TILTED_FAULT)])
def test_a_quaternion_must_be_long_enough_and_turn_about_z_only(quaternion, fault):
    assert quaternion_fault(quaternion) == fault


@pytest.mark.parametrize('place', range(4))
@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
def test_a_quaternion_with_a_part_that_is_not_finite_is_told_from_other_faults(place, value):
    quaternion = [0.0, 0.0, 0.0, 0.0]
    quaternion[place] = value
    assert quaternion_fault(tuple(quaternion)) == NAN_FAULT


@pytest.mark.parametrize('begin, end, place, share', [
    ((0, 0), (4, 0), (1, 5), 0.25), ((0, 0), (4, 0), (-1, 0), 0.0), ((0, 0), (4, 0), (9, 1), 1.0),
    ((2, 2), (2, 2), (7, 7), 0.0), ((1, 1), (3, 3), (3, 1), 0.5)])
def test_where_a_straight_piece_is_nearest(begin, end, place, share):
    assert share_along(begin, end, *place) == pytest.approx(share)


def test_poses_can_be_copied_and_sent_to_other_processes():
    pose = Pose2D(1.0, -2.0, 3.0)
    assert pickle.loads(pickle.dumps(pose)) == copy.deepcopy(pose) == copy.copy(pose) == pose


@pytest.mark.parametrize('name', ['x', 'y'])
def test_a_pose_lies_within_1e9_m(name):
    assert getattr(Pose2D(**{name: -1e9}), name) == -1e9
    for value in (1.000001e9, -1e308):
        with pytest.raises(ValueError, match=r'pose: {} must be within \+-1e9 m, got {!r}'.format(name, value).replace(
                'e+', r'e\+')):
            Pose2D(**{name: value})
    assert Pose2D(yaw=1e308).yaw == normalize_angle(1e308)
