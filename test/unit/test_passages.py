"""When a robot comes into an area and leaves it: the first nanosecond of which it is so, whatever its law."""
import math

import pytest

from move_base_abstract.engine.instants import first_ns
from move_base_abstract.motion.approach import MotionPhases
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances
from move_base_abstract.motion.pace import Pace, PacedLeg, TimedLeg
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.route import CornerLaw, Route
from move_base_abstract.traffic.outline import rectangle
from move_base_abstract.traffic.zones import Passage, passages

S = 1_000_000_000
AREA = rectangle(4.0, -2.0, 6.0, 2.0)
LIMITS = MotionLimits(2.0)
PHASES = MotionPhases((0.1, 0.2), 0.5, 0.08, 1.2, 1.1, 0.3)
FAR = Pose2D(10.0)
CORNERS = [(5.0, 0.0), (5.0, 5.0)]
REAL = MotionLimits(1.3, 0.7, 0.9)
LEGS = [Leg(Pose2D(0.0, 0.0, 1.0), FAR, REAL, Tolerances(0.1, 0.1), 3),
        Route(Pose2D(0.0, 0.0, 1.0), FAR, CORNERS, REAL, Tolerances(0.1, 0.1), 3, CornerLaw.KEEP),
        Route(Pose2D(0.0, 0.0, 1.0), FAR, CORNERS, REAL, Tolerances(0.1, 0.1), 3, CornerLaw.STOP),
        PhasedRoute(Pose2D(), FAR, CORNERS, REAL, PHASES, Tolerances(0.1, 0.1), 3),
        PacedLeg(Route(Pose2D(), FAR, CORNERS, REAL, depart_ns=3), Pace(5 * S + 7, 1.37)),
        PacedLeg(Route(Pose2D(), FAR, CORNERS, REAL, depart_ns=3), Pace(0, 0.41)),
        TimedLeg(Leg(Pose2D(), FAR, LIMITS, depart_ns=3), 7 * S + 1, 2)]


def test_a_robot_at_an_even_speed_is_at_the_border_when_it_has_driven_as_far():
    assert passages(Leg(Pose2D(), FAR, LIMITS, depart_ns=S), AREA) == [Passage(3 * S, 4 * S)]


@pytest.mark.parametrize('leg', LEGS)
def test_before_the_instant_the_border_is_not_reached_and_at_it_it_is(leg):
    (enter_ns, leave_ns), = passages(leg, AREA)
    assert leg.depart_ns < enter_ns < leave_ns < leg.arrive_ns
    assert leg.distance_at(enter_ns - 1) < 4.0 <= leg.distance_at(enter_ns)
    assert leg.pose_at(enter_ns).x == pytest.approx(4.0, abs=4e-9)
    place = leg.pose_at(leave_ns)
    assert min(abs(place.x - 6.0), abs(place.y - 2.0)) < 4e-9
    middle = leg.pose_at((enter_ns + leave_ns) // 2)
    assert AREA.contains(middle.x, middle.y)


@pytest.mark.parametrize('leg', LEGS)
def test_the_reverse_of_the_law_is_off_by_little(leg):
    for share in (0.0, 0.01, 0.2, 0.5, 0.77, 0.99, 1.0):
        distance = share * leg.distance
        instant_ns = leg.covers_ns(distance)
        assert instant_ns == first_ns(
            leg.depart_ns, leg.arrive_ns, lambda at_ns, far=distance: leg.distance_at(at_ns) >= far)
        if share not in (0.0, 1.0):  # there it may turn, or wait
            assert abs(leg.guess_ns(distance) - instant_ns) < 100


@pytest.mark.parametrize('leg', LEGS)
def test_a_leg_knows_the_way_up_to_where_it_ends(leg):
    lengths = [math.hypot(x - a, y - b) for (a, b), (x, y) in zip(leg.way, leg.way[1:])]
    assert sum(lengths) == pytest.approx(leg.distance, abs=1e-12)
    assert leg.way[-1] == pytest.approx((leg.end.x, leg.end.y)) and leg.way[0] == (leg.start.x, leg.start.y)


def test_who_starts_inside_is_in_from_the_departure_on_and_who_ends_inside_never_leaves():
    inside = Pose2D(5.0)
    assert passages(Leg(inside, FAR, LIMITS, depart_ns=S), AREA) == [Passage(S, 3 * S // 2)]
    assert passages(Leg(Pose2D(), inside, LIMITS, depart_ns=S), AREA) == [Passage(3 * S, None)]
    assert passages(Leg(inside, Pose2D(5.0, 1.0), LIMITS, depart_ns=S), AREA) == [Passage(S, None)]
    assert passages(Leg(inside, inside, LIMITS, depart_ns=S), AREA) == [Passage(S, None)]


def test_who_turns_first_inside_or_at_the_border_is_in_from_the_departure_on():
    limits = MotionLimits(2.0, turn_rate=1.0)
    assert passages(Leg(Pose2D(4.0, 0.0, math.pi), FAR, limits, depart_ns=S), AREA)[0].enter_ns == S
    assert passages(Leg(Pose2D(4.0, 0.0, math.pi), Pose2D(), limits, depart_ns=S), AREA) == []


def test_who_stops_at_the_border_has_not_come_in_and_has_left():
    border = Pose2D(4.0)
    assert passages(Leg(Pose2D(), border, LIMITS, depart_ns=S), AREA) == []
    assert passages(Leg(Pose2D(5.0), border, LIMITS, depart_ns=S), AREA) == [Passage(S, 3 * S // 2)]


def test_a_route_comes_in_as_often_as_it_does():
    way = Route(Pose2D(), Pose2D(0.0, 1.0), [(10.0, 0.0), (10.0, 1.0)], LIMITS, depart_ns=0)
    assert passages(way, AREA) == [Passage(2 * S, 3 * S), Passage(15 * S // 2, 17 * S // 2)]


def test_who_only_waits_and_who_misses_the_area_pass_nothing():
    assert passages(Leg(Pose2D(), Pose2D(), LIMITS), AREA) == []
    assert passages(Leg(Pose2D(0.0, 3.0), Pose2D(10.0, 3.0), LIMITS), AREA) == []


def test_a_route_that_is_driven_again_comes_to_the_same_places_after_the_same_times():
    first = Route(Pose2D(), FAR, CORNERS, REAL, depart_ns=3)
    early = first.covers_ns(4.0)
    again = first.again(first.start, first.end, 8 * S)
    assert again.covers_ns(4.0) == early + 8 * S - 3
    assert again.distance_at(again.covers_ns(6.0) - 1) < 6.0 <= again.distance_at(again.covers_ns(6.0))
    assert first.covers_ns(4.0) == early


def test_the_instant_of_a_distance_that_is_not_covered_before_the_arrival_is_the_arrival():
    leg = Leg(Pose2D(), FAR, LIMITS, depart_ns=S)
    assert (leg.covers_ns(0.0), leg.covers_ns(10.0), leg.covers_ns(11.0)) == (S, 6 * S, 6 * S)
