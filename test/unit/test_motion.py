"""The motion law: durations, poses at any instant, tolerances, and the corners where closed forms go wrong."""

import math
import sys

import pytest
from hypothesis import example, given, strategies as st

from move_base_abstract.common.units import NS_PER_S, seconds_to_ns
from move_base_abstract.motion.geometry import Pose2D, normalize_angle
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances, speed_profile
from move_base_abstract.motion.route import Route
from profiles import covered, elapsed_at, speed

S = NS_PER_S
NO_TOLERANCE = Tolerances()
SHARES = st.floats(0.0, 1.0)
SPEEDS = st.floats(0.01, 20.0)
ACCELERATIONS = st.floats(0.01, 50.0)
ANY_ACCELERATION = ACCELERATIONS | st.just(math.inf)
TRIPS = st.tuples(st.floats(0.0, 1e4), SPEEDS, ANY_ACCELERATION)  # distance, top speed, acceleration
COORDINATES = st.floats(-1e3, 1e3)
POSES = st.builds(Pose2D, COORDINATES, COORDINATES, st.floats(-4.0, 4.0))
LIMITS = st.builds(MotionLimits, SPEEDS, ANY_ACCELERATION, st.floats(0.05, 10.0) | st.just(math.inf))
DEPARTURES = st.integers(0, 10 ** 18)


# ---- limits and tolerances

@pytest.mark.parametrize('name, unit', [('max_speed', 'm/s'), ('acceleration', 'm/s^2'), ('turn_rate', 'rad/s')])
@pytest.mark.parametrize('value', [0.0, -1.0, -math.inf, math.nan])
def test_a_limit_that_is_not_above_zero_is_refused_by_name(name, unit, value):
    with pytest.raises(ValueError) as error:
        MotionLimits(**dict({'max_speed': 1.0}, **{name: value}))
    assert str(error.value) == '{} must be > 0 {}, got {!r}'.format(name, unit, value)


def test_the_speed_alone_must_be_finite():
    with pytest.raises(ValueError, match='max_speed must be finite, got inf'):
        MotionLimits(math.inf)
    assert MotionLimits(1.0) == MotionLimits(1.0, math.inf, math.inf)


@pytest.mark.parametrize('name, unit', [('xy', 'm'), ('yaw', 'rad')])
@pytest.mark.parametrize('value', [-1e-9, math.nan])
def test_a_tolerance_below_zero_is_refused_by_name(name, unit, value):
    with pytest.raises(ValueError) as error:
        Tolerances(**{name: value})
    assert str(error.value) == '{} tolerance must be >= 0 {}, got {!r}'.format(name, unit, value)


# ---- the speed profile

@pytest.mark.parametrize('distance, max_speed, acceleration, seconds, peak', [
    (20.0, 2.0, math.inf, 10.0, 2.0),
    (20.0, 2.0, 1.0, 12.0, 2.0),
    (4.0, 2.0, 1.0, 4.0, 2.0),
    (1.0, 2.0, 1.0, 2.0, 1.0),
    (1.0, 2.0, 0.1, 2 * math.sqrt(10.0), math.sqrt(0.1)),
    (0.0, 2.0, 1.0, 0.0, 0.0),
    (0.0, 2.0, math.inf, 0.0, 2.0)])
def test_durations_and_peak_speeds_of_long_exactly_full_and_short_trips(distance, max_speed, acceleration, seconds,
                                                                         peak):
    profile = speed_profile(distance, max_speed, acceleration)
    assert (profile.seconds, max(phase.speed for phase in profile.phases)) == pytest.approx((seconds, peak))


def test_a_trip_accelerates_cruises_and_decelerates():
    profile = speed_profile(20.0, 2.0, 1.0)
    times = [-1.0, 0.0, 1.0, 2.0, 6.0, 10.0, 11.0, 12.0, 13.0]
    assert [covered(profile, t) for t in times] == [0.0, 0.0, 0.5, 2.0, 10.0, 18.0, 19.5, 20.0, 20.0]
    assert [speed(profile, t) for t in times] == [0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 1.0, 0.0, 0.0]


@given(TRIPS, SHARES)
def test_a_trip_is_symmetric_in_time(trip, share):
    profile = speed_profile(*trip)
    t = share * profile.seconds
    assert covered(profile, t) + covered(profile, profile.seconds - t) == pytest.approx(profile.distance, abs=1e-9)


@given(TRIPS, st.lists(SHARES, min_size=2, max_size=20))
def test_distance_never_shrinks_nor_grows_faster_than_the_top_speed(trip, shares):
    distance, max_speed, _ = trip
    profile = speed_profile(*trip)
    times = [share * profile.seconds for share in sorted(shares)]
    ways = [covered(profile, t) for t in times]
    slack = 1e-9 * (1.0 + distance)
    for (t0, s0), (t1, s1) in zip(zip(times, ways), zip(times[1:], ways[1:])):
        assert -slack <= s1 - s0 <= max_speed * (t1 - t0) + slack
    assert all(-slack <= s <= distance for s in ways)
    assert all(-1e-9 <= speed(profile, t) <= max_speed + 1e-9 for t in times)


@given(st.tuples(st.floats(0.01, 1e3), SPEEDS, ACCELERATIONS), SHARES, st.floats(1e-4, 1e-2))
def test_the_speed_is_the_slope_of_the_distance(trip, share, step):
    profile = speed_profile(*trip)
    t = share * profile.seconds
    driven = covered(profile, t + step) - covered(profile, t)
    assert abs(driven - speed(profile, t) * step) <= 0.5 * trip[2] * step * step + 1e-9


@given(TRIPS, SHARES)
@example((5e-324, 2.0, math.inf), 0.0)
@example((5e-324, 1.0, 1.0), 0.0)
def test_when_a_distance_is_covered_is_the_reverse_of_how_much_is(trip, share):
    profile = speed_profile(*trip)
    wanted = share * profile.distance
    slack = 1e-9 * profile.distance + sys.float_info.min  # smaller numbers have fewer digits
    assert abs(covered(profile, elapsed_at(profile, wanted)) - wanted) <= slack


# ---- legs: fixed examples

def test_a_leg_turns_drives_and_turns_again():
    leg = Leg(Pose2D(), Pose2D(0.0, 4.0, math.pi), MotionLimits(2.0, turn_rate=math.pi / 2), NO_TOLERANCE, 10 * S)
    right = math.pi / 2
    expected = [
        (0.0, (0, 0, 0.0), (0, 0)), (10.0, (0, 0, 0.0), (0, right)), (10.5, (0, 0, right / 2), (0, right)),
        (11.0, (0, 0, right), (2, 0)), (12.0, (0, 2, right), (2, 0)), (13.0, (0, 4, right), (0, right)),
        (13.5, (0, 4, 1.5 * right), (0, right)), (14.0, (0, 4, math.pi), (0, 0)), (99.0, (0, 4, math.pi), (0, 0))]
    for seconds, pose, velocity in expected:
        at = leg.pose_at(seconds_to_ns(seconds))
        assert (at.x, at.y, at.yaw) == pytest.approx(pose, abs=1e-9), seconds
        assert leg.velocity_at(seconds_to_ns(seconds))[::2] == pytest.approx(velocity), seconds
    assert (leg.depart_ns, leg.arrive_ns, leg.duration_ns) == (10 * S, 14 * S, 4 * S)


def test_a_turn_to_the_right_has_a_negative_velocity_before_the_drive_and_after_it():
    leg = Leg(Pose2D(), Pose2D(0.0, -4.0, math.pi), MotionLimits(2.0, turn_rate=math.pi / 2))
    right = -math.pi / 2
    for seconds, pose, velocity in ((0.5, (0, 0, right / 2), (0, right)), (2.0, (0, -2, right), (2, 0)),
                                    (3.5, (0, -4, 1.5 * right), (0, right)), (4.0, (0, -4, math.pi), (0, 0))):
        at = leg.pose_at(seconds_to_ns(seconds))
        assert (at.x, at.y, at.yaw) == pytest.approx(pose, abs=1e-9), seconds
        assert leg.velocity_at(seconds_to_ns(seconds))[::2] == pytest.approx(velocity), seconds


def test_turns_take_the_short_way_round():
    leg = Leg(Pose2D(0, 0, 3.0), Pose2D(-1.0, -1e-12, -3.0), MotionLimits(1.0, turn_rate=1.0))
    assert leg.pose_at(S // 10).yaw == pytest.approx(3.1)
    assert leg.duration_ns / NS_PER_S == pytest.approx(1.0 + 2 * (math.pi - 3.0))
    assert leg.velocity_at(leg.arrive_ns - 1) == (0.0, 0.0, 1.0)


@pytest.mark.parametrize('distance, limits, duration_ns', [
    (20.0, MotionLimits(2.0), 10_000_000_000),
    (100.0, MotionLimits(2.0), 50_000_000_000),
    (1.0, MotionLimits(0.3), 3_333_333_333),
    (2.0, MotionLimits(0.3), 6_666_666_667),
    (1.0, MotionLimits(2.0, 0.1), 6_324_555_320),
    (20.0, MotionLimits(2.0, 0.5), 14_000_000_000),
    (0.0, MotionLimits(2.0, 0.5, 1.0), 0)])
def test_durations_are_right_to_the_nanosecond(distance, limits, duration_ns):
    assert Leg(Pose2D(), Pose2D(distance, 0.0, 0.0), limits, NO_TOLERANCE, 7).arrive_ns == 7 + duration_ns


@pytest.mark.parametrize('limits', [MotionLimits(2.0), MotionLimits(2.0, 1.0, 1.0)])
@pytest.mark.parametrize('goal', [Pose2D(3.0, 4.0, 1.0), Pose2D(1.0, 1.0, 0.5), Pose2D(1.0, 1.0, 1.5)])
def test_before_its_departure_a_leg_is_at_its_start(goal, limits):
    start = Pose2D(1.0, 1.0, 0.5)
    leg = Leg(start, goal, limits, NO_TOLERANCE, 5 * S)
    assert [leg.pose_at(t) for t in (0, 5 * S - 1)] == [start, start]
    assert [leg.distance_at(t) for t in (0, 5 * S)] == [0.0, 0.0]
    assert leg.velocity_at(5 * S - 1) == (0.0, 0.0, 0.0)


def test_turning_in_place_drives_nowhere():
    leg = Leg(Pose2D(1.0, 2.0, 0.0), Pose2D(1.0, 2.0, -1.0), MotionLimits(2.0, turn_rate=0.5))
    assert (leg.duration_ns, leg.distance, leg.end) == (2 * S, 0.0, Pose2D(1.0, 2.0, -1.0))
    assert leg.pose_at(S) == Pose2D(1.0, 2.0, -0.5)


def test_a_goal_at_the_robots_own_place_is_reached_at_once():
    start = Pose2D(1.0, 2.0, 3.0)
    leg = Leg(start, start, MotionLimits(0.1, 0.1, 0.1), NO_TOLERANCE, 5)
    assert (leg.arrive_ns, leg.pose_at(5), leg.velocity_at(5)) == (5, start, (0.0, 0.0, 0.0))


def test_the_smallest_distance_there_is_can_be_travelled():
    leg = Leg(Pose2D(), Pose2D(5e-324, 0.0, 0.0), MotionLimits(1.0, 0.1))
    assert (leg.duration_ns, leg.end.x) == (0, 5e-324)


# ---- tolerances

def test_the_robot_stops_where_it_first_is_within_its_tolerances():
    leg = Leg(Pose2D(), Pose2D(6.0, 8.0, 2.0), MotionLimits(2.0, turn_rate=1.0), Tolerances(2.5, 0.1))
    course = math.atan2(8.0, 6.0)
    assert (leg.end.x, leg.end.y, leg.end.yaw) == pytest.approx((4.5, 6.0, 1.9))
    assert leg.distance == pytest.approx(7.5)
    assert leg.duration_ns / NS_PER_S == pytest.approx(course + 7.5 / 2.0 + (1.9 - course))


def test_a_robot_within_its_tolerances_stays_where_it_is():
    start = Pose2D(1.0, 1.0, 0.2)
    leg = Leg(start, Pose2D(1.05, 1.0, 0.24), MotionLimits(2.0, 1.0, 1.0), Tolerances(0.1, 0.05), 3)
    assert (leg.arrive_ns, leg.pose_at(3)) == (3, start)


@given(POSES, POSES, LIMITS, st.floats(0.0, 10.0), st.floats(0.0, 4.0))
def test_the_end_is_within_the_tolerances_and_not_closer_than_needed(start, goal, limits, xy, yaw):
    end = Leg(start, goal, limits, Tolerances(xy, yaw)).end
    assert end.distance_to(goal) == pytest.approx(min(xy, start.distance_to(goal)), abs=1e-9)
    assert abs(normalize_angle(goal.yaw - end.yaw)) <= yaw + 1e-9


# ---- legs: properties

@given(POSES, POSES, LIMITS, DEPARTURES)
def test_without_tolerances_the_end_is_exactly_the_goal(start, goal, limits, depart_ns):
    leg = Leg(start, goal, limits, NO_TOLERANCE, depart_ns)
    assert leg.pose_at(leg.arrive_ns) == leg.end == goal
    assert leg.velocity_at(leg.arrive_ns) == (0.0, 0.0, 0.0)
    assert leg.distance_at(leg.arrive_ns) == pytest.approx(start.distance_to(goal))


@given(POSES, POSES, LIMITS, DEPARTURES)
def test_a_leg_lasts_as_long_as_its_three_phases(start, goal, limits, depart_ns):
    leg = Leg(start, goal, limits, NO_TOLERANCE, depart_ns)
    turns = 0.0
    if not math.isinf(limits.turn_rate):
        course = start.bearing_to(goal) if start.distance_to(goal) > 0.0 else start.yaw
        turns = (abs(normalize_angle(course - start.yaw)) + abs(normalize_angle(goal.yaw - course))) / limits.turn_rate
    drive = speed_profile(start.distance_to(goal), limits.max_speed, limits.acceleration).seconds
    assert leg.duration_ns == pytest.approx((turns + drive) * 1e9, abs=2, rel=1e-12)


@given(POSES, POSES, LIMITS, DEPARTURES)
def test_the_departure_does_not_change_the_leg(start, goal, limits, depart_ns):
    early, late = (Leg(start, goal, limits, NO_TOLERANCE, t) for t in (0, depart_ns))
    for share in (0.0, 0.1, 0.5, 0.7, 1.0):
        t = int(share * early.duration_ns)
        assert early.pose_at(t) == late.pose_at(depart_ns + t)


@given(POSES, POSES, LIMITS, st.lists(SHARES, min_size=1, max_size=10), st.integers(1, 10 ** 8))
def test_poses_are_continuous_and_no_faster_than_the_limits(start, goal, limits, shares, step_ns):
    leg = Leg(start, goal, limits, NO_TOLERANCE)
    for share in shares:
        t = int(share * leg.duration_ns)
        before, after = leg.pose_at(t), leg.pose_at(t + step_ns)
        seconds = (step_ns + 2) / 1e9
        assert before.distance_to(after) <= limits.max_speed * seconds + 1e-9
        if not math.isinf(limits.turn_rate):
            assert abs(normalize_angle(after.yaw - before.yaw)) <= limits.turn_rate * seconds + 1e-9


@given(POSES, POSES, LIMITS, SHARES)
def test_the_pose_is_on_the_straight_line_as_far_along_as_was_driven(start, goal, limits, share):
    leg = Leg(start, goal, limits, NO_TOLERANCE)
    t = int(share * leg.duration_ns)
    pose, driven = leg.pose_at(t), leg.distance_at(t)
    assert start.distance_to(pose) == pytest.approx(driven, abs=1e-9)
    assert pose.distance_to(goal) == pytest.approx(leg.distance - driven, abs=1e-9)


# ---- units

@given(st.integers(-10 ** 15, 10 ** 15))
def test_whole_milliseconds_become_nanoseconds_without_a_remainder(milliseconds):
    assert seconds_to_ns(milliseconds / 1000.0) == pytest.approx(milliseconds * 1_000_000, abs=64, rel=2 ** -52)
    assert seconds_to_ns(float(milliseconds)) == milliseconds * S


@pytest.mark.parametrize('seconds, time_ns', [(0.0, 0), (0.1, 100_000_000), (1e9 + 0.25, 1_000_000_000_250_000_000),
                                              (-0.25, -250_000_000), (0.9999999999, S), (4e-10, 0), (6e-10, 1)])
def test_seconds_are_rounded_to_the_nearest_nanosecond(seconds, time_ns):
    assert seconds_to_ns(seconds) == time_ns


@pytest.mark.parametrize('seconds', [math.nan, math.inf, -math.inf])
def test_seconds_that_are_not_finite_are_refused(seconds):
    with pytest.raises(ValueError, match='seconds must be finite, got {!r}'.format(seconds)):
        seconds_to_ns(seconds)


def test_a_robot_at_the_edge_of_its_tolerance_has_arrived_whatever_the_last_digit_says():
    """It does not turn to where it would drive 1e-16 m: sent to the same goal again it has nothing left to do."""
    limits, tolerances = MotionLimits(1.0, 0.6, 1.0), Tolerances(0.097683, 0.19)
    for number in range(200):
        goal = Pose2D(9.0 * math.cos(number), 0.1 * number - 3.0, math.fmod(number, 3.0))
        first = Leg(Pose2D(), goal, limits, tolerances)
        again = Leg(first.end, goal, limits, tolerances, first.arrive_ns)
        route = Route(first.end, goal, (), limits, tolerances, first.arrive_ns)
        assert (again.duration_ns, again.distance, route.duration_ns, route.distance) == (0, 0.0, 0, 0.0)
