"""Straight ways inside bounds: what can be reached, what is nearest, and the poses on the way."""

import math

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.maps.planning import StraightLinePlanner, WorldBounds, straight_path
from move_base_abstract.motion.geometry import Pose2D

FIELD = WorldBounds(0.0, 0.0, 10.0, 5.0)
START = Pose2D(1.0, 1.0, 0.5)
COORDINATES = st.floats(-50.0, 50.0)
POSES = st.builds(Pose2D, COORDINATES, COORDINATES, st.floats(-3.0, 3.0))


# ---- bounds

@pytest.mark.parametrize('bounds', [(0, 0, 0, 1), (0, 1, 1, 1), (2, 0, 1, 1), (0, 2, 1, 1), (math.nan, 0, 1, 1),
                                    (0, 0, 1, math.nan)])
def test_bounds_without_an_inside_are_refused_with_what_was_given(bounds):
    with pytest.raises(ValueError) as error:
        WorldBounds(*bounds)
    assert str(error.value) == ('bounds must be [x_min, y_min, x_max, y_max] with x_min < x_max and y_min < y_max, '
                                'got {!r}'.format(list(bounds)))


@pytest.mark.parametrize('x, y, inside', [
    (5.0, 2.0, True), (0.0, 0.0, True), (10.0, 5.0, True), (-0.001, 2.0, False), (10.001, 2.0, False),
    (5.0, -0.001, False), (5.0, 5.001, False)])
def test_the_edge_belongs_to_the_inside(x, y, inside):
    assert FIELD.contains(Pose2D(x, y)) is inside


def test_without_bounds_the_plane_has_no_edge():
    assert StraightLinePlanner().reachable(Pose2D(1e9, -1e9))


@pytest.mark.parametrize('pose, nearest', [
    (Pose2D(3.0, 2.0, 1.0), Pose2D(3.0, 2.0, 1.0)), (Pose2D(12.0, 2.0, 1.0), Pose2D(10.0, 2.0, 1.0)),
    (Pose2D(-1.0, 9.0, 1.0), Pose2D(0.0, 5.0, 1.0)), (Pose2D(3.0, -4.0, 1.0), Pose2D(3.0, 0.0, 1.0))])
def test_the_nearest_pose_inside_keeps_its_heading(pose, nearest):
    assert FIELD.nearest(pose) == nearest


@given(POSES, POSES)
def test_nothing_inside_is_nearer_than_the_nearest(pose, other):
    nearest = FIELD.nearest(pose)
    assert FIELD.contains(nearest)
    assert pose.distance_to(nearest) <= pose.distance_to(FIELD.nearest(other)) + 1e-9


# ---- plans

def test_a_way_goes_straight_in_quarter_metres_heading_along_it():
    assert straight_path(Pose2D(0.0, 0.0, 1.0), Pose2D(0.0, 1.0, 2.0)) == [
        Pose2D(0.0, 0.0, 1.0), Pose2D(0.0, 0.25, math.pi / 2), Pose2D(0.0, 0.5, math.pi / 2),
        Pose2D(0.0, 0.75, math.pi / 2), Pose2D(0.0, 1.0, 2.0)]


def test_a_way_to_where_the_robot_is_has_start_and_goal():
    goal = Pose2D(1.0, 1.0, 2.0)
    assert straight_path(START, goal) == [START, goal]


@given(POSES, POSES)
def test_any_way_begins_at_the_start_ends_at_the_goal_and_has_even_steps_of_a_quarter_metre_at_most(start, goal):
    path = straight_path(start, goal)
    assert (path[0], path[-1]) == (start, goal)
    steps = [a.distance_to(b) for a, b in zip(path, path[1:])]
    assert max(steps) <= 0.25 + 1e-9
    assert max(steps) - min(steps) <= 1e-9
    assert sum(steps) == pytest.approx(start.distance_to(goal), abs=1e-6)


def test_a_way_of_any_length_has_a_bounded_number_of_poses():
    for x in (1e5, 1e9):
        path = straight_path(Pose2D(), Pose2D(x, 0.0))
        assert (len(path) <= 10_001, path[-1]) == (True, Pose2D(x, 0.0))


def test_a_plan_ends_inside_or_there_is_none():
    planner = StraightLinePlanner(FIELD)
    inside, outside = Pose2D(3.0, 1.0), Pose2D(12.0, 1.0)
    assert (planner.reachable(inside), planner.reachable(outside)) == (True, False)
    assert (planner.plan(START, inside), planner.plan(START, outside)) == (straight_path(START, inside), [])


def test_a_plan_near_a_goal_inside_goes_to_the_goal():
    goal = Pose2D(3.0, 1.0)
    assert StraightLinePlanner(FIELD).plan_near(START, goal, 5.0) == straight_path(START, goal)


@pytest.mark.parametrize('tolerance, found', [(0.0, False), (1.99, False), (2.0, True), (9.0, True),
                                              (math.nan, False)])
def test_a_plan_near_a_goal_outside_needs_the_tolerance_and_appends_the_goal_as_move_base_does(tolerance, found):
    planner, goal, near = StraightLinePlanner(FIELD), Pose2D(12.0, 1.0, 0.3), Pose2D(10.0, 1.0, 0.3)
    path = straight_path(START, near)
    assert planner.plan_near(START, goal, tolerance) == (path + [goal] if found else [])
    assert planner.plan_near(START, goal, tolerance, add_goal=False) == (path if found else [])
