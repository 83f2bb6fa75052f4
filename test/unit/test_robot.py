"""One robot: its pose at any instant of the present and of some of the past, and the way it has driven."""

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.common.errors import TimeError
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits, Tolerances
from move_base_abstract.motion.robot import Robot

S = NS_PER_S
COORDINATES = st.floats(-100.0, 100.0)
POSES = st.builds(Pose2D, COORDINATES, COORDINATES, st.floats(-3.0, 3.0))


def make_robot(**changes):
    return Robot(0, 'robot_0', **dict({'limits': MotionLimits(2.0)}, **changes))


def test_a_new_robot_stands_at_its_start():
    robot = make_robot(pose=Pose2D(1.0, 2.0, 3.0), since_ns=5 * S)
    assert robot.leg is None
    assert [robot.pose_at(t) for t in (5 * S, 9 * S)] == [Pose2D(1.0, 2.0, 3.0)] * 2
    assert (robot.velocity_at(9 * S), robot.distance_at(9 * S)) == ((0.0, 0.0, 0.0), 0.0)


def test_a_robot_without_limits_of_its_own_drives_half_a_metre_a_second():
    assert Robot(0, 'a').depart(Pose2D(10.0, 0.0), 0).duration_ns == 20 * S


def test_a_robot_stops_at_its_exact_pose_of_the_instant():
    robot = make_robot()
    leg = robot.depart(Pose2D(20.0, 0.0), S)
    assert (robot.leg, leg.arrive_ns) == (leg, 11 * S)
    assert (robot.pose_at(4 * S), robot.velocity_at(4 * S)) == (Pose2D(6.0, 0.0), (2.0, 0.0, 0.0))
    assert robot.stop(4 * S) == Pose2D(6.0, 0.0)
    assert (robot.leg, robot.pose_at(9 * S), robot.velocity_at(9 * S)) == (None, Pose2D(6.0, 0.0), (0.0, 0.0, 0.0))


def test_departing_on_the_way_starts_from_the_pose_of_the_instant_from_rest():
    robot = make_robot(limits=MotionLimits(2.0, 1.0))
    robot.depart(Pose2D(20.0, 0.0), 0)
    leg = robot.depart(Pose2D(10.0, 0.0), 6 * S)
    assert (leg.start, leg.depart_ns, leg.arrive_ns) == (Pose2D(10.0, 0.0), 6 * S, 6 * S)
    leg = robot.depart(Pose2D(10.0, 1.0), 7 * S)
    assert (leg.arrive_ns, robot.velocity_at(7 * S)) == (9 * S, (0.0, 0.0, 0.0))


def test_the_driven_distance_adds_up_over_legs_and_stops_and_leaves_out_teleports():
    robot = make_robot()
    robot.depart(Pose2D(20.0, 0.0), 0)
    driven = [robot.distance_at(2 * S)]
    robot.stop(3 * S)
    driven += [robot.distance_at(3 * S), robot.distance_at(5 * S)]
    robot.depart(Pose2D(6.0, 8.0), 5 * S)
    robot.place(Pose2D(-50.0, 0.0), 6 * S)
    driven.append(robot.distance_at(6 * S))
    robot.depart(Pose2D(-50.0, 10.0), 7 * S)
    driven += [robot.distance_at(8 * S), robot.distance_at(99 * S)]
    robot.stop(99 * S)
    assert [*driven, robot.distance_at(100 * S)] == [4.0, 6.0, 6.0, 8.0, 10.0, 18.0, 18.0]


def test_new_limits_and_tolerances_take_effect_on_the_next_leg():
    robot = make_robot()
    leg = robot.depart(Pose2D(10.0, 0.0), 0)
    robot.set_motion(MotionLimits(1.0), Tolerances(xy=2.0))
    assert (leg.arrive_ns, robot.pose_at(4 * S)) == (5 * S, Pose2D(8.0, 0.0))
    robot.stop(5 * S)
    leg = robot.depart(Pose2D(20.0, 0.0), 5 * S)
    assert (leg.arrive_ns, leg.end) == (13 * S, Pose2D(18.0, 0.0))


# ---- the past

def test_the_past_is_remembered_across_legs_stops_and_teleports():
    robot = make_robot()
    robot.depart(Pose2D(20.0, 0.0), S)
    robot.stop(3 * S)
    robot.place(Pose2D(7.0, 7.0), 5 * S)
    robot.depart(Pose2D(7.0, 9.0), 6 * S)
    expected = [(0, 0.0, 0.0), (2, 2.0, 0.0), (3, 4.0, 0.0), (4, 4.0, 0.0), (5, 7.0, 7.0), (7, 7.0, 9.0)]
    assert [(t, robot.pose_at(t * S).x, robot.pose_at(t * S).y) for t, _, _ in expected] == expected


def test_of_several_doings_of_one_instant_the_last_counts():
    robot = make_robot()
    for x in (1.0, 2.0, 3.0):
        robot.place(Pose2D(x, 0.0), 5 * S)
    assert robot.pose_at(5 * S) == Pose2D(3.0, 0.0)
    assert robot.pose_at(5 * S - 1) == Pose2D()


def test_before_its_first_instant_a_robot_has_no_pose():
    with pytest.raises(TimeError) as error:
        make_robot(since_ns=5 * S).pose_at(5 * S - 1)
    assert str(error.value) == ('robot_0: the pose at 4999999999 ns is asked for, but nothing before 5000000000 ns '
                                'is remembered')


def test_what_lies_too_many_doings_back_is_forgotten_and_said_so():
    robot = make_robot()
    for k in range(1, 65):
        robot.place(Pose2D(float(k), 0.0), k * S)
    assert robot.pose_at(S) == Pose2D(1.0, 0.0)
    with pytest.raises(TimeError, match='nothing before 1000000000 ns is remembered'):
        robot.pose_at(0)


def test_a_reset_robot_has_driven_nowhere_and_has_no_past():
    robot = make_robot()
    robot.depart(Pose2D(20.0, 0.0), 0)
    robot.reset(Pose2D(1.0, 2.0), 3 * S)
    assert (robot.leg, robot.pose_at(9 * S), robot.distance_at(9 * S)) == (None, Pose2D(1.0, 2.0), 0.0)
    with pytest.raises(TimeError, match='nothing before 3000000000 ns is remembered'):
        robot.pose_at(3 * S - 1)


@given(st.lists(st.tuples(st.sampled_from(['depart', 'stop']), POSES, st.integers(0, 20 * S)), max_size=20),
       st.sampled_from([MotionLimits(2.0), MotionLimits(1.0, 0.3, 0.7)]))
def test_no_doing_but_a_teleport_moves_a_robot_at_once(doings, limits):
    robot = make_robot(limits=limits)
    now_ns = 0
    for doing, goal, step_ns in doings:
        now_ns += step_ns
        before, driven = robot.pose_at(now_ns), robot.distance_at(now_ns)
        robot.depart(goal, now_ns) if doing == 'depart' else robot.stop(now_ns)
        after = robot.pose_at(now_ns)
        if robot.leg is None or robot.leg.duration_ns:
            assert after.distance_to(before) <= 1e-9
        assert robot.distance_at(now_ns) >= driven
