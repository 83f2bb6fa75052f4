"""A robot that slows down the nearer it comes, and routes in such phases: any instant in closed form, as integrated."""
import math

import pytest

from move_base_abstract.motion.approach import MotionPhases, approach_profile
from move_base_abstract.motion.geometry import Pose2D, normalize_angle
from move_base_abstract.motion.leg import MotionLimits, Tolerances
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.route import CornerLaw, Route
from profiles import covered, elapsed_at, speed

S = 1_000_000_000
PHASES = MotionPhases((0.1, 0.2), 0.5, 0.08, 1.2, 1.1, 0.3, bow_length=1.7)
LIMITS = MotionLimits(1.0, 0.7)
TOLERANCES = Tolerances(0.1, 0.2)
APPROACHES = [(10.0, 1.0, 0.5, 0.5, 0.1), (1.0, 1.0, 0.5, 0.5, 0.1), (0.02, 1.0, 0.5, 0.5, 0.1),
              (5.0, 0.04, 0.5, 0.5, 0.1), (2.0, 1.5, math.inf, 1.2, 0.2), (0.1, 1.5, math.inf, 1.2, 0.2)]


@pytest.mark.parametrize('numbers', APPROACHES)
def test_the_speed_is_what_a_robot_may_and_adds_up_to_the_distance(numbers):
    profile, (_, max_speed, _, gain, offset) = approach_profile(*numbers), numbers
    step, driven = profile.seconds / 20000, 0.0
    brakes = max(phase.speed for phase in profile.phases) > gain * offset
    for number in range(20000):
        now = speed(profile, (number + 0.5) * step)
        left = profile.distance - covered(profile, (number + 0.5) * step)
        assert 0.0 <= now <= max_speed + 1e-12
        assert not brakes or now <= gain * (left + offset) + 1e-9
        driven += now * step
    assert driven == pytest.approx(profile.distance, rel=1e-4)
    assert covered(profile, profile.seconds) == profile.distance


@pytest.mark.parametrize('numbers', APPROACHES)
def test_when_a_distance_is_covered_is_the_reverse_of_what_is_covered_when(numbers):
    profile = approach_profile(*numbers)
    for share in (0.0, 0.001, 0.1, 0.3, 0.6, 0.9, 0.999, 1.0):
        way = share * profile.distance
        assert covered(profile, elapsed_at(profile, way)) == pytest.approx(way, abs=1e-9)


def test_the_end_of_a_trip_that_does_not_brake_is_never_reached_sooner():
    # by rounding what is covered just before the end seems to lie behind it
    profile = approach_profile(24.353057952320476, 0.03253362142524134, 0.5, 0.5, 1.0)
    assert not any(phase.rate for phase in profile.phases)
    assert elapsed_at(profile, 24.353057952320473) == pytest.approx(profile.seconds)


def test_a_long_trip_takes_what_its_phases_say():
    # 1 m/s after 2 s and 1 m; braking begins 1.9 m before the end, which is ln(20) / 0.5 s away
    profile = approach_profile(10.0, 1.0, 0.5, 0.5, 0.1)
    assert profile.seconds == pytest.approx(2.0 + (10.0 - 1.0 - 1.9) + 2.0 * math.log(20.0))
    assert speed(profile, profile.seconds - 1e-9) == pytest.approx(0.05)


def test_no_distance_takes_no_time():
    assert approach_profile(0.0, 1.0, 0.5, 0.5, 0.1).seconds == 0.0
    assert covered(approach_profile(1e-300, 1.0, 0.5, 0.5, 0.1), 1.0) == 1e-300


# ---- routes

CASES = [((), CornerLaw.KEEP), ([(4.0, 0.0), (4.0, 5.0)], CornerLaw.KEEP), ([(4.0, 0.0), (4.0, 5.0)], CornerLaw.STOP)]


@pytest.mark.parametrize(('corners', 'law'), CASES)
def test_a_phased_route_goes_the_way_of_a_route_and_ends_where_it_does(corners, law):
    start, goal = Pose2D(0.0, 0.0, 2.0), Pose2D(9.0, 6.0, -1.0)
    phased = PhasedRoute(start, goal, corners, LIMITS, PHASES, TOLERANCES, 3 * S, law)
    route = Route(start, goal, corners, LIMITS, TOLERANCES, 3 * S, law)
    assert (phased.start, phased.end, phased.distance) == (route.start, route.end, route.distance)
    before = start
    for share in range(1001):
        now_ns = phased.depart_ns + phased.duration_ns * share // 1000
        pose = phased.pose_at(now_ns)
        assert pose.distance_to(before) <= LIMITS.max_speed * phased.duration_ns / 1e12 + 1e-9
        before = pose
    assert phased.pose_at(phased.arrive_ns - 1).distance_to(phased.end) < 1e-6
    assert abs(normalize_angle(phased.pose_at(phased.arrive_ns - 1).yaw - phased.end.yaw)) < 1e-6
    assert phased.velocity_at(phased.depart_ns + 1)[0] == 0.0


def test_the_time_of_a_route_is_that_of_its_turns_and_its_drive():
    route = PhasedRoute(Pose2D(0.0, 0.0, 1.0), Pose2D(10.0, 0.0, 0.7), (), LIMITS, PHASES, TOLERANCES)
    share = 1.7 ** 2 / (1.7 ** 2 + 10.0 ** 2)
    seconds = (1.0 * (0.1 + 0.2) + PHASES.drive(9.9, LIMITS).seconds
               + approach_profile(0.7 + share - 0.2, 1.2, math.inf, 1.1, 0.3).seconds)
    assert route.duration_ns == pytest.approx(seconds * S, abs=2)
    assert route.start_turn == pytest.approx(-1.0)


def test_on_a_short_way_a_last_turn_to_the_side_of_the_first_one_is_shorter():
    def seconds(side):
        return PhasedRoute(Pose2D(0.0, 0.0, -1.4), Pose2D(1.5, 0.0, side * 1.5), (), LIMITS, PHASES).duration_ns / S
    assert seconds(1) < seconds(-1) - 0.5


def test_a_goal_at_the_robots_place_is_a_turn():
    route = PhasedRoute(Pose2D(), Pose2D(0.0, 0.0, 1.0), (), LIMITS, PHASES)
    assert route.duration_ns / S == pytest.approx(PHASES.end_turn(1.0, 0.0, 0.0, 0.0).seconds, abs=1e-8)
    assert (route.start_turn, route.distance, route.end) == (0.0, 0.0, Pose2D(0.0, 0.0, 1.0))
