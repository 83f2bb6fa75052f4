"""Routes: a leg is the one without corners; what holds at any instant; both corner laws; where tolerances end them."""
import math

import pytest
from hypothesis import example, given, strategies as st

from move_base_abstract.common.units import NS_PER_S, seconds_to_ns
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances, speed_profile
from move_base_abstract.motion.planned_way import PieceLimit, PlannedWay
from move_base_abstract.motion.route import CornerLaw, Route, route_along, segments_along
from profiles import covered, speed

S = NS_PER_S
LAWS = tuple(CornerLaw)
COORDINATES = st.floats(-1e3, 1e3)
POSES = st.builds(Pose2D, COORDINATES, COORDINATES, st.floats(-4.0, 4.0))
CORNERS = st.lists(st.tuples(COORDINATES, COORDINATES), max_size=5)
LIMITS = st.builds(MotionLimits, st.floats(0.05, 20.0), st.floats(0.05, 50.0) | st.just(math.inf),
                   st.floats(0.05, 10.0) | st.just(math.inf))
TOLERANCES = st.builds(Tolerances, st.sampled_from((0.0, 0.3, 50.0)), st.sampled_from((0.0, 0.1)))
DEPARTURES = st.integers(0, 10 ** 18)
SHARES = st.floats(0.0, 1.0)
AROUND = ((4.0, 0.0), (4.0, 3.0))  # from (0, 0): 4 m east, 3 m north, and on
GOAL = Pose2D(6.0, 3.0, math.pi)


def instant(route, share):
    """Return the instant [ns] at a share of the trip."""
    return route.depart_ns + int(share * route.duration_ns)


# ---- without corners

@given(POSES, POSES, LIMITS, TOLERANCES, DEPARTURES, st.sampled_from(LAWS), SHARES)
@example(Pose2D(), Pose2D(2.2e-309, 0.0), MotionLimits(1.0), Tolerances(), 0, CornerLaw.KEEP, 0.5)
@example(Pose2D(), Pose2D(1e-12, 0.0), MotionLimits(5.0), Tolerances(), 7, CornerLaw.STOP, 0.0)
@example(Pose2D(), Pose2D(1e-12, 0.0, 1.0), MotionLimits(5.0, turn_rate=1.0), Tolerances(), 7, CornerLaw.KEEP, 0.0)
@example(Pose2D(), Pose2D(0.0, 1e-12), MotionLimits(5.0, turn_rate=1.0), Tolerances(), 7, CornerLaw.KEEP, 1.0)
def test_a_route_without_corners_is_a_leg_to_the_last_digit(start, goal, limits, tolerances, depart_ns, law, share):
    leg = Leg(start, goal, limits, tolerances, depart_ns)
    route = Route(start, goal, (), limits, tolerances, depart_ns, law)
    assert (route.arrive_ns, route.distance, route.end) == (leg.arrive_ns, leg.distance, leg.end)
    for now_ns in (depart_ns - 1, depart_ns, instant(leg, share), leg.arrive_ns, leg.arrive_ns + 1):
        assert route.pose_at(now_ns) == leg.pose_at(now_ns)
        assert route.velocity_at(now_ns) == leg.velocity_at(now_ns)
        assert route.distance_at(now_ns) == leg.distance_at(now_ns)


def test_corners_on_the_straight_line_change_nothing_where_the_robot_keeps_its_speed():
    limits = MotionLimits(2.0, 1.0, 0.5)
    leg = Leg(Pose2D(), Pose2D(32.0, 0.0, 1.0), limits, depart_ns=7)
    route = Route(Pose2D(), Pose2D(32.0, 0.0, 1.0), [(8.0, 0.0), (8.0, 0.0), (16.0, 0.0)], limits, depart_ns=7)
    assert route.arrive_ns == leg.arrive_ns
    for tenth in range(11):
        assert route.pose_at(instant(leg, 0.1 * tenth)) == leg.pose_at(instant(leg, 0.1 * tenth))


# ---- at any instant

@given(POSES, POSES, CORNERS, LIMITS, TOLERANCES, st.sampled_from(LAWS), SHARES, st.floats(1e-6, 1e-2))
def test_no_jump_and_no_speed_above_the_limit(start, goal, corners, limits, tolerances, law, share, step):
    route = Route(start, goal, corners, limits, tolerances, 5 * S, law)
    now_ns = instant(route, share)
    later_ns = now_ns + max(1, int(step * S))
    seconds = (later_ns - now_ns) / S
    one, other = route.pose_at(now_ns), route.pose_at(later_ns)
    assert one.distance_to(other) <= limits.max_speed * seconds * (1.0 + 1e-6) + 1e-6
    forward, _, turning = route.velocity_at(now_ns)
    assert 0.0 <= forward <= limits.max_speed and not (forward and turning)
    assert -1e-9 <= route.distance_at(later_ns) - route.distance_at(now_ns) <= limits.max_speed * seconds + 1e-6


@given(POSES, POSES, CORNERS, LIMITS, st.sampled_from(LAWS))
def test_it_begins_at_the_start_and_ends_at_the_goal_by_the_whole_length(start, goal, corners, limits, law):
    route = Route(start, goal, corners, limits, law=law)
    points = [(start.x, start.y), *corners, (goal.x, goal.y)]
    length = sum(math.dist(one, other) for one, other in zip(points, points[1:]))
    assert route.pose_at(-1) == start and route.pose_at(route.arrive_ns) == goal
    assert route.distance_at(route.arrive_ns) == pytest.approx(length, rel=1e-12, abs=1e-12)
    if route.duration_ns:
        last = route.pose_at(route.arrive_ns - 1)
        assert last.distance_to(goal) <= 1e-6 + 2e-9 * limits.max_speed


@pytest.mark.parametrize('law', LAWS)
def test_velocity_is_what_poses_and_distances_change_by(law):
    route = Route(Pose2D(0.0, 0.0, 1.0), GOAL, AROUND, MotionLimits(1.5, 0.5, 0.7), law=law)
    pieces = 20000
    driven = turned = 0.0
    step_ns = route.duration_ns / pieces
    for number in range(pieces):  # the midpoint rule
        forward, _, turning = route.velocity_at(int((number + 0.5) * step_ns))
        driven += forward * step_ns / S
        turned += abs(turning) * step_ns / S
    assert driven == pytest.approx(9.0, abs=1e-3)
    corners = math.pi if law is CornerLaw.STOP else 0.0
    assert turned == pytest.approx(1.0 + corners + math.pi, abs=2e-3)


# ---- the two laws

def test_to_keep_is_one_speed_profile_over_the_whole_length():
    limits = MotionLimits(2.0, 0.5, 1.0)
    route = Route(Pose2D(), GOAL, AROUND, limits)
    drive_ns = seconds_to_ns(speed_profile(9.0, 2.0, 0.5).seconds)
    assert route.arrive_ns == drive_ns + seconds_to_ns(math.pi)
    profile = speed_profile(9.0, 2.0, 0.5)
    for tenth in range(1, 10):
        now_ns = drive_ns * tenth // 10
        assert route.velocity_at(now_ns) == pytest.approx((speed(profile, now_ns / S), 0.0, 0.0), abs=1e-12)
        way = covered(profile, now_ns / S)
        expected = (way, 0.0) if way < 4.0 else (4.0, way - 4.0) if way < 7.0 else (way - 3.0, 3.0)
        assert (route.pose_at(now_ns).x, route.pose_at(now_ns).y) == pytest.approx(expected, abs=1e-12)


def test_to_stop_is_one_leg_after_the_other():
    limits = MotionLimits(2.0, 0.5, 1.0)
    route = Route(Pose2D(0.0, 0.0, 2.0), GOAL, AROUND, limits, depart_ns=3, law=CornerLaw.STOP)
    north = math.pi / 2.0
    leg = Leg(Pose2D(0.0, 0.0, 2.0), Pose2D(4.0, 0.0, 0.0), limits, depart_ns=3)
    for goal in (Pose2D(4.0, 3.0, north), GOAL):
        for share in (0.0, 0.2, 0.5, 0.9):
            now_ns = instant(leg, share)
            pose, expected = route.pose_at(now_ns), leg.pose_at(now_ns)
            assert (pose.x, pose.y, pose.yaw) == pytest.approx((expected.x, expected.y, expected.yaw), abs=1e-9)
            assert route.velocity_at(now_ns) == pytest.approx(leg.velocity_at(now_ns), abs=1e-9)
        leg = Leg(leg.end, goal, limits, depart_ns=leg.arrive_ns)
    assert route.arrive_ns == leg.arrive_ns


# ---- tolerances

@pytest.mark.parametrize('tolerance, distance, end', [
    (0.5, 8.5, (5.5, 3.0)),
    (2.0, 7.0, (4.0, 3.0)),
    (math.hypot(2.0, 1.0), 6.0, (4.0, 2.0)),
    (4.0, 6.0 - math.sqrt(7.0), (6.0 - math.sqrt(7.0), 0.0)),
    (100.0, 0.0, (0.0, 0.0))])
def test_it_ends_where_it_first_is_within_the_tolerance(tolerance, distance, end):
    route = Route(Pose2D(), GOAL, AROUND, MotionLimits(1.0), Tolerances(tolerance))
    assert route.distance == pytest.approx(distance, abs=1e-9)
    assert (route.end.x, route.end.y, route.end.yaw) == pytest.approx((*end, math.pi), abs=1e-9)
    assert route.end.distance_to(GOAL) <= tolerance * (1.0 + 1e-12)


def test_it_ends_where_a_way_that_leads_past_the_goal_first_comes_near():
    route = Route(Pose2D(), Pose2D(3.0, 0.4), [(10.0, 0.0), (10.0, 0.4)], MotionLimits(1.0), Tolerances(0.5))
    assert (route.end.x, route.end.y) == pytest.approx((2.7, 0.0))


def test_it_turns_to_the_heading_as_far_as_the_tolerance_asks():
    route = Route(Pose2D(), GOAL, AROUND, MotionLimits(1.0, turn_rate=1.0), Tolerances(0.0, 0.25))
    assert route.end.yaw == pytest.approx(math.pi - 0.25)
    assert route.arrive_ns == 9 * S + seconds_to_ns(math.pi - 0.25)


# ---- what is ahead

def test_corners_ahead_are_those_that_are_not_reached():
    route = Route(Pose2D(), GOAL, AROUND, MotionLimits(1.0))
    assert [route.corners_ahead(seconds * S) for seconds in (0, 3, 4, 5, 7, 8, 99)] == [
        AROUND, AROUND, AROUND[1:], AROUND[1:], (), (), ()]
    assert Leg(Pose2D(), GOAL, MotionLimits(1.0)).corners_ahead(0) == ()


# ---- the same way again

@given(POSES, POSES, CORNERS, LIMITS, TOLERANCES, st.sampled_from(LAWS), SHARES, DEPARTURES)
def test_a_route_by_a_way_that_was_driven_before_is_as_if_it_were_the_first(
        start, goal, corners, limits, tolerances, law, share, depart_ns):
    way = PlannedWay(corners, [PieceLimit(1.0 + number % 2) for number in range(len(corners) + 1)])
    route_along(start, goal, way, limits, tolerances, 5, law)
    again = route_along(Pose2D(start.x, start.y, start.yaw), goal, way, limits, tolerances, depart_ns, law)
    first = Route(start, goal, way, limits, tolerances, depart_ns, law)
    assert (again.start, again.end, again.distance, again.way, again.depart_ns, again.arrive_ns, again.corners) == (
        first.start, first.end, first.distance, first.way, first.depart_ns, first.arrive_ns, first.corners)
    assert again.pieces == first.pieces
    now_ns = instant(first, share)
    assert (again.pose_at(now_ns), again.velocity_at(now_ns), again.distance_at(now_ns)) == (
        first.pose_at(now_ns), first.velocity_at(now_ns), first.distance_at(now_ns))


def test_robots_of_other_limits_share_no_route():
    way = PlannedWay([(4.0, 0.0)], [PieceLimit()] * 2)
    arrivals = [route_along(Pose2D(), GOAL, way, MotionLimits(speed, turn_rate=rate), Tolerances(), 0, law).arrive_ns
                for speed in (1.0, 2.0) for rate in (math.inf, 1.0) for law in LAWS]
    assert len(set(arrivals)) == 6  # without turns both laws are one


def test_a_goal_at_minus_zero_ends_there_also_if_another_went_to_zero():
    way = PlannedWay([(4.0, 3.0)], [PieceLimit()] * 2)
    for zero in (0.0, -0.0):
        goal = Pose2D(0.0, zero)
        route = route_along(Pose2D(4.0, 0.0), goal, way, MotionLimits(1.0), Tolerances(), 0, CornerLaw.KEEP)
        assert math.copysign(1.0, route.end.y) == math.copysign(1.0, zero)


@given(CORNERS.filter(lambda places: all(one != other for one, other in zip(places, places[1:]))), LIMITS,
       st.sampled_from(LAWS))
def test_pieces_that_are_known_are_those_that_would_be_found(places, limits, law):
    points = [(-2000.0, 0.0), *places, (2000.0, 0.0)]
    limit = PieceLimit(0.7, 0.5)
    ends = Pose2D(*points[0]), Pose2D(*points[-1], 1.0)
    known = PlannedWay(places, [limit] * (len(points) - 1), known=(
        points[0], points[-1], segments_along(points, limit)))
    route, found = (Route(*ends, way, limits, law=law) for way in (known, PlannedWay(places, known.limits)))
    assert (route.way, route.distance, route.arrive_ns) == (found.way, found.distance, found.arrive_ns)
    assert route.pose_at(instant(route, 0.4)) == found.pose_at(instant(found, 0.4))
