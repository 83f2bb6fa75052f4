"""Robots that go around what the map shows: durations, endings, pre-emption, other maps meanwhile, and what is off."""
import gc
import math
import random

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.maps import grid_planner, kept
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits, Tolerances
from move_base_abstract.motion.route import CornerLaw, Route
from move_base_abstract.runs.trace import TraceEntry
from move_base_abstract.scenario import make_scenario
from traces import leg_of

S = NS_PER_S
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'
START, GOAL = Pose2D(2.5, 5.5), Pose2D(8.5, 5.5)
CORNERS = ((4.992188, 1.992188), (6.007812, 1.992188))  # 2/256 of a cell off the wall's
LIMITS = MotionLimits(2.0, 1.0, 1.0)


def area(*walls):
    """Return a map of 12 x 12 cells of 1 m; a wall is (rows, column), each a number or a slice."""
    cells = np.zeros((12, 12), np.int8)
    for rows, column in walls:
        cells[rows, column] = 100
    return OccupancyMap(cells, 1.0)


WALL = slice(2, 12), 5
CLOSED = slice(0, 12), 5


def fleet_on(occupancy, **settings):
    """Return a Fleet of one robot, 'bot', at START."""
    defaults = {'max_speed': 2.0, 'acceleration': 1.0, 'turn_rate': 1.0, 'start_x': START.x, 'start_y': START.y,
                'use_map': True, 'routes': 'grid', 'robot_radius': 0.0, **settings}
    return Fleet(make_scenario({'defaults': defaults, 'robots': [{'name': 'bot'}]}), start_ns=0, occupancy=occupancy)


def kinds(fleet):
    """Return what was recorded: [(time [s], kind)]."""
    return [(round(entry.time_ns / S, 3), entry.kind) for entry in fleet.trace]


# ---- on the way

@pytest.mark.parametrize('law', CornerLaw)
def test_a_robot_travels_the_route_to_the_nanosecond(law):
    fleet = fleet_on(area(WALL), corners=law.value, xy_goal_tolerance=0.25)
    route = Route(START, GOAL, CORNERS, LIMITS, Tolerances(0.25), 0, law)
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    for share in (0.1, 0.4, 0.5, 0.8):
        fleet.run(int(share * route.arrive_ns))
        assert fleet.robot('bot').pose == route.pose_at(fleet.now_ns)
        assert fleet.robot('bot').distance == route.distance_at(fleet.now_ns)
    fleet.run()
    assert fleet.trace[1:] == [
        TraceEntry(0, 'bot', 'departed', (8.5, 5.5, 0.0)),
        TraceEntry(route.arrive_ns, 'bot', 'stands', (route.end.x, route.end.y, 0.0)),
        TraceEntry(route.arrive_ns, 'bot', 'ended', ('bot-1', 'SUCCEEDED', 'Goal reached.'))]


def test_a_goal_in_sight_is_as_without_routes():
    traces = []
    for routes in ('grid', 'none'):
        fleet = fleet_on(area(WALL), routes=routes)
        fleet.robot('bot').send(1.25, 9.0, 1.0)
        fleet.run()
        traces.append(fleet.trace)
    assert traces[0] == traces[1]


def test_without_routes_a_map_with_walls_stops_nobody():
    fleet = fleet_on(area(CLOSED), routes='none')
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.run()
    assert [entry.kind for entry in fleet.trace] == ['goal', 'departed', 'stands', 'ended']
    assert fleet.trace[-1].time_ns == 5 * S  # 6 m: 6 / 2 + 2 / 1


def test_a_newer_goal_counts_from_the_exact_place_on_the_route():
    fleet = fleet_on(area(WALL))
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.run(9 * S // 2)
    here = fleet.robot('bot').pose
    fleet.robot('bot').send(START.x, START.y)
    assert fleet.robot('bot').distance == pytest.approx(math.dist((2.5, 5.5), CORNERS[0]) + here.x - CORNERS[0][0])
    fleet.run()
    states = [entry.values[1] for entry in fleet.trace if entry.kind == 'ended']
    assert states == ['PREEMPTED', 'SUCCEEDED'] and here.y == CORNERS[0][1] and CORNERS[0][0] < here.x < CORNERS[1][0]
    assert TraceEntry(9 * S // 2, 'bot', 'stands', (here.x, here.y, here.yaw)) in fleet.trace
    assert fleet.robot('bot').pose == START


def test_a_robot_that_is_placed_elsewhere_plans_from_there():
    fleet = fleet_on(area(WALL))
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.run(S)
    fleet.robot('bot').place(Pose2D(8.5, 1.5, math.pi / 2.0))
    fleet.run()
    assert fleet.trace[-1].time_ns == S + 4 * S + round(math.pi / 2.0 * S)


# ---- where there is no way

@pytest.mark.parametrize('goal', [GOAL, Pose2D(5.5, 5.5), Pose2D(20.0, 5.5)])
def test_what_cannot_be_reached_ends_with_the_text_of_upstream_at_once(goal):
    fleet = fleet_on(area(CLOSED))
    fleet.robot('bot').send(goal.x, goal.y)
    fleet.run()
    assert fleet.trace == [TraceEntry(0, 'bot', 'goal', ('bot-1',)),
                           TraceEntry(0, 'bot', 'ended', ('bot-1', 'ABORTED', NO_PLAN))]


def test_with_the_policy_of_upstream_it_takes_its_time():
    fleet = fleet_on(area(CLOSED), abort_policy='upstream')
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.run()
    end_ns = RecoveryPolicy(fast=False).schedule(0)[1]
    assert fleet.trace[1:] == [TraceEntry(end_ns, 'bot', 'ended', ('bot-1', 'ABORTED', NO_PLAN))]


# ---- another map meanwhile

def test_a_route_that_a_new_map_cuts_is_planned_again_at_that_instant():
    fleet = fleet_on(area(WALL))
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.at(3 * S, lambda fleet: fleet.use_map(area((slice(0, 10), 5))))
    fleet.run(3 * S)
    corners = leg_of(fleet).corners
    fleet.run()
    assert [entry.kind for entry in fleet.trace] == ['goal', 'departed', 'stands', 'departed', 'stands', 'ended']
    assert {entry.time_ns for entry in fleet.trace[2:4]} == {3 * S}
    here = Pose2D(*fleet.trace[2].values)
    assert corners[-1] == (6.007812, 10.007812)
    route = Route(here, GOAL, corners, LIMITS, depart_ns=3 * S)
    assert fleet.trace[-1].time_ns == route.arrive_ns and fleet.trace[-1].values[1] == 'SUCCEEDED'


@pytest.mark.parametrize('wall', [(slice(9, 11), 1), (slice(3, 6), 3)])
def test_a_route_that_a_new_map_does_not_cut_goes_on(wall):
    fleets = [fleet_on(area(WALL)), fleet_on(area(WALL))]
    for fleet in fleets:
        fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleets[0].at(5 * S, lambda fleet: fleet.use_map(area(WALL, wall)))  # the second wall lies behind the robot
    for fleet in fleets:
        fleet.run()
    assert fleets[0].trace == fleets[1].trace


def test_a_map_without_a_way_ends_the_goal_and_one_with_a_way_saves_it():
    fleet = fleet_on(area(WALL))
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.at(3 * S, lambda fleet: fleet.use_map(area(CLOSED)))
    fleet.run()
    assert kinds(fleet)[2:] == [(3.0, 'stands'), (3.0, 'ended')] and fleet.trace[-1].values[2] == NO_PLAN

    fleet = fleet_on(area(CLOSED), abort_policy='upstream')
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.at(7 * S, lambda fleet: fleet.use_map(area(CLOSED)))
    fleet.at(8 * S, lambda fleet: fleet.use_map(area(WALL)))
    fleet.run()
    assert kinds(fleet)[1:2] == [(8.0, 'departed')]
    assert [entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == ['SUCCEEDED']


def test_without_routes_a_new_map_counts_for_the_next_goal_only():
    fleet = fleet_on(area(), routes='none')
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    fleet.at(S, lambda fleet: fleet.use_map(area((5, 8))))
    fleet.run()
    fleet.robot('bot').send(GOAL.x, GOAL.y)
    assert [entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == [
        GoalState.SUCCEEDED.name, GoalState.ABORTED.name]


# ---- settings

@pytest.mark.parametrize('settings, text', [
    ({'routes': 'straight'}, "parameter scenario: robots[0]/routes: got 'straight'; allowed: 'none', 'grid', 'lanes' "
                             "or 'matrix'"),
    ({'corners': 'cut'}, "parameter scenario: robots[0]/corners: got 'cut'; allowed: 'keep' or 'stop'"),
    ({'use_map': False}, "parameter scenario: robots[0]/routes: got 'grid' with use_map: false; allowed: with use_map: "
                         'true only'),
    ({'allow_occupied_goals': True}, "parameter scenario: robots[0]/routes: got 'grid' with allow_occupied_goals: "
                                     'true; allowed: with allow_occupied_goals: false only')])
def test_what_is_not_allowed(settings, text):
    with pytest.raises(ConfigurationError) as error:
        fleet_on(area(), **settings)
    assert str(error.value) == text


def test_routes_need_a_map():
    with pytest.raises(ConfigurationError, match="routes: got 'grid' for a robot without a map"):
        fleet_on(None)


def test_the_radius_is_the_inscribed_one_of_the_outline_with_its_padding():
    for outline, radius in (({'footprint': [[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]}, 1.01),
                            ({'robot_radius': 1.0}, 1.0)):
        settings = make_scenario({'defaults': outline, 'robots': [{'name': 'bot'}]}).robots[0].settings
        assert settings.costmaps.global_footprint.inscribed_radius == pytest.approx(radius, abs=0.01)


def test_what_is_kept_of_ways_is_bounded_however_long_the_fleet_drives(monkeypatch):
    assert grid_planner._FIELDS_BYTES + grid_planner._WAVES_BYTES <= 96 * 1024 * 1024  # as the page says
    occupancy, pick, counts = area(WALL), random.Random(4), []
    monkeypatch.setattr(grid_planner, '_FIELDS_BYTES', 5 * 14 * 14)
    monkeypatch.setattr(kept, 'LEAST', kept.MOST_CORNERS // 20)  # so that it keeps 20 ways

    def next_goal(robot, *_):
        if ended[0] % 150 == 0:
            gc.collect()
            counts.append(len(gc.get_objects()))
        ended[0] += 1
        if ended[0] <= 450:
            fleet.robot(robot).send(pick.choice((2.5, 8.5)) + pick.random(), 1.5 + 9.0 * pick.random())

    ended = [0]
    robots = [{'name': 'bot', 'max_speed': 2.0, 'use_map': True, 'routes': 'grid', 'robot_radius': 0.0,
               'start_x': START.x, 'start_y': START.y}]
    fleet = Fleet(make_scenario({'robots': robots}), on_end=next_goal, trace=None, occupancy=occupancy)
    next_goal('bot')
    fleet.run()
    [ways] = occupancy._kept.values()
    assert len(ways._fields) == len(ways._shorteners) == 5 and len(ways._ways) == 20
    assert abs(counts[3] - counts[2]) < 100 < 450 <= ended[0]
