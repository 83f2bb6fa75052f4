"""Ways around obstacles: never longer than over the cells, clear of what is not free, the same whatever was asked."""
import math
import random

import numpy as np
import pytest

from move_base_abstract.maps import kept
from move_base_abstract.maps.cost_field import CostField
from move_base_abstract.maps.grid_planner import GridPlanner, MapWays
from move_base_abstract.maps.map_check import TEXT_OFF_MAP, MapCheck
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.maps.planning import WorldBounds, path_along
from move_base_abstract.maps.planning_grid import PlanningGrid
from move_base_abstract.maps.tightening import tightened
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_mapf.movingai import read_map, read_problems
from movingai_files import FOLDER, optima, optimum, write

MAPS = ('rooms', 'boxes', 'scattered')
WALL = [(row, column) for row in range(2, 10) for column in (5,)]  # of an area of 10 x 10 cells, open in the south


def occupancy(blocked, resolution=1.0, origin=Pose2D()):
    """Return the OccupancyMap of blocked cells, [row from the south, column]."""
    return OccupancyMap(np.where(blocked, 100, 0).astype(np.int8), resolution, origin)


def walled():
    """Return 10 x 10 cells with a wall."""
    blocked = np.zeros((10, 10), bool)
    for row, column in WALL:
        blocked[row, column] = True
    return blocked


def length_of(start, corners, goal):
    """Return the length of a way [m]."""
    points = [(start.x, start.y), *corners, (goal.x, goal.y)]
    return sum(math.dist(one, other) for one, other in zip(points, points[1:]))


# ---- against the optimum over the cells

@pytest.mark.parametrize('name', MAPS)
def test_the_files_are_as_their_format_says_and_their_optima_are_right(name, tmp_path):
    blocked, problems = read_map(FOLDER / (name + '.map')), read_problems(FOLDER / (name + '.scen'))
    rows = (FOLDER / (name + '.map')).read_text().split('\n')[4:-1]
    write(tmp_path, name, rows, problems)
    for kind in ('.map', '.scen'):
        assert (tmp_path / (name + kind)).read_bytes() == (FOLDER / (name + kind)).read_bytes()
    assert optimum(blocked, problems[0].start, problems[0].start) == (0, 0)


@pytest.mark.parametrize('name', MAPS)
def test_ways_are_clear_and_never_longer_than_the_optimum_over_the_cells(name):
    blocked = read_map(FOLDER / (name + '.map'))[::-1]
    ways = MapWays(the_map := occupancy(blocked, 0.5, Pose2D(3.0, -2.0, 0.7)), 0.0)
    shares = []
    for problem, best in zip(read_problems(FOLDER / (name + '.scen')), optima(FOLDER / (name + '.scen'))):
        start, goal = (Pose2D(*the_map.from_cells(column + 0.5, blocked.shape[0] - row - 0.5))
                       for column, row in (problem.start, problem.goal))
        corners = ways.corners(start, goal)
        length = length_of(start, corners, goal)
        assert ways.is_clear([(start.x, start.y), *corners, (goal.x, goal.y)])
        assert length <= 0.5 * best * (1.0 + 1e-6)
        assert length >= start.distance_to(goal) * (1.0 - 1e-12)
        shares.append(length / (0.5 * best))
    assert sum(shares) / len(shares) < 0.985  # any angle is worth something


# ---- which way

def test_it_goes_straight_where_nothing_lies_between_and_round_the_end_of_a_wall():
    ways = MapWays(the_map := occupancy(walled()), 0.0)
    assert ways.corners(Pose2D(1.2, 0.9), Pose2D(8.0, 1.1)) == ()
    corners = ways.corners(Pose2D(2.5, 5.5), Pose2D(8.5, 5.5))
    assert corners == ((4.992188, 1.992188), (6.007812, 1.992188))  # 2/256 of a cell off the wall's
    assert ways.corners(Pose2D(8.5, 5.5), Pose2D(2.5, 5.5)) == corners[::-1]
    assert the_map.width == 10


@pytest.mark.parametrize('start, goal', [((8.5, 30.5), (110.5, 78.5)), ((20.5, 110.5), (82.5, 33.5)),
                                         ((60.5, 5.5), (60.5, 115.5)), ((10.5, 90.5), (85.5, 40.5))])
def test_round_an_obstacle_ways_are_tight(start, goal):
    rows, columns = np.mgrid[0:120, 0:120]
    ways = MapWays(the_map := occupancy((columns - 60) ** 2 + (rows - 60) ** 2 <= 20 ** 2), 0.0)
    corners = ways.corners(Pose2D(*start), Pose2D(*goal))
    # Tangents to a circle of the outermost cells' corners, and an arc between them.
    radius, centre = 21.0, (60.5, 60.5)
    (a, alpha), (b, beta) = ((math.dist(place, centre), math.atan2(place[1] - centre[1], place[0] - centre[0]))
                             for place in (start, goal))
    arc = abs(math.remainder(alpha - beta, 2.0 * math.pi)) - math.acos(radius / a) - math.acos(radius / b)
    tight = math.sqrt(a * a - radius ** 2) + math.sqrt(b * b - radius ** 2) + radius * arc
    length = length_of(Pose2D(*start), corners, Pose2D(*goal))
    assert length <= 1.005 * tight, length / tight
    assert the_map.width == 120


def test_pulling_tight_makes_no_way_longer_and_changes_a_tight_one_in_nothing():
    blocked = read_map(FOLDER / 'scattered.map')[::-1]
    grid, chance = PlanningGrid(blocked), random.Random(2)
    cells = np.flatnonzero(grid.free).tolist()
    changed = 0
    for _ in range(60):
        start, goal = chance.sample(cells, 2)
        field = CostField(grid, goal)
        if field.leads_from(start):
            places = [grid.centre_of(cell) for cell in field.way_from(start)]
            found = tightened(grid, places)
            assert (found[0], found[-1]) == (places[0], places[-1])
            assert all(grid.sees(one, other) for one, other in zip(found, found[1:]))
            assert sum(map(math.dist, found, found[1:])) <= sum(map(math.dist, places, places[1:])) * (1.0 + 1e-9)
            changed += found != places
    assert changed > 30


def test_of_two_equal_ways_it_is_the_one_whose_first_step_comes_first():
    blocked = np.zeros((9, 9), bool)
    blocked[3:6, 4] = True  # a wall with as long a way round in the north as in the south
    ways = MapWays(the_map := occupancy(blocked), 0.0)
    assert ways.corners(Pose2D(1.5, 4.5), Pose2D(7.5, 4.5)) == ((3.992188, 6.007812), (5.007812, 6.007812))
    turned = MapWays(other := occupancy(blocked.T.copy()), 0.0)
    assert turned.corners(Pose2D(4.5, 1.5), Pose2D(4.5, 7.5)) == ((6.007812, 3.992188), (6.007812, 5.007812))
    assert (the_map.width, other.width) == (9, 9)


def test_it_keeps_the_radius_from_the_wall():
    ways = MapWays(the_map := occupancy(walled()), 1.0)
    assert ways.corners(Pose2D(2.5, 5.5), Pose2D(8.5, 5.5)) == (
        (3.992188, 1.992188), (4.992188, 0.992188), (6.007812, 0.992188), (7.007812, 1.992188))
    assert not ways.is_free(Pose2D(4.5, 5.5)) and ways.is_free(Pose2D(3.5, 5.5)) and the_map.width


def test_a_robot_within_the_radius_of_a_wall_goes_to_the_nearest_free_cell_first():
    ways = MapWays(the_map := occupancy(walled()), 1.0)
    assert ways.corners(Pose2D(4.1, 5.5), Pose2D(3.5, 8.5)) == ((3.5, 5.5),)
    assert ways.corners(Pose2D(5.5, 5.5), Pose2D(3.5, 8.5)) == ((3.5, 5.5),)
    wide = MapWays(other := occupancy(np.ones((9, 9), bool)), 1.0)
    assert wide.corners(Pose2D(4.5, 4.5), Pose2D(1.5, 1.5)) is None
    assert (the_map.width, other.width) == (10, 9)


def test_what_is_found_does_not_depend_on_what_was_asked_before():
    blocked = read_map(FOLDER / 'boxes.map')[::-1]
    chance = random.Random(3)
    the_map = occupancy(blocked)
    places = [Pose2D(chance.uniform(0.0, 48.0), chance.uniform(0.0, 36.0)) for _ in range(14)]
    pairs = [(start, goal) for start in places for goal in places[:5]]
    shared = MapWays(the_map, 0.7)
    chance.shuffle(pairs)
    found = [shared.corners(*pair) for pair in pairs]
    assert [MapWays(the_map, 0.7).corners(*pair) for pair in pairs] == found
    assert sum(corners is None for corners in found) < len(found) / 2 and any(found)


def test_robots_of_one_radius_share_what_is_found_on_a_map():
    the_map, another = occupancy(walled()), occupancy(walled())
    assert MapWays.on(the_map, 0.5) is MapWays.on(the_map, 0.5)
    assert len({id(ways) for ways in (MapWays.on(the_map, 0.5), MapWays.on(the_map, 0.6), MapWays.on(another, 0.5),
                                      MapWays.on(the_map, 0.5, False))}) == 4


def test_fields_beyond_what_is_kept_are_made_again(monkeypatch):
    monkeypatch.setattr('move_base_abstract.maps.grid_planner._FIELDS_BYTES', 1)
    monkeypatch.setattr(kept, 'LEAST', kept.MOST_CORNERS)  # so that it keeps one way
    ways = MapWays(the_map := occupancy(walled()), 0.0)
    goals = [Pose2D(8.5, 5.5), Pose2D(9.5, 8.5)]
    first = [ways.corners(Pose2D(2.5, 5.5), goal) for goal in goals]
    assert [ways.corners(Pose2D(2.5, 5.5), goal) for goal in goals] == first and the_map.width


# ---- the planner

def planner(blocked, radius=0.0, bounds=WorldBounds(), **rules):
    """Return a GridPlanner on a map that it keeps."""
    return GridPlanner(MapCheck(occupancy(blocked), **rules), radius, bounds)


def test_what_cannot_be_reached_and_why():
    blocked = walled()
    blocked[8, :] = True
    ways = planner(blocked, 1.0, WorldBounds(0.0, 0.0, 9.0, 10.0))
    start = Pose2D(2.5, 5.5)
    for goal, why in ((Pose2D(20.0, 1.0), TEXT_OFF_MAP),
                      (Pose2D(5.5, 5.5), 'The goal (5.5, 5.5) lies in an occupied cell of the map.'),
                      (Pose2D(4.5, 5.5), 'The goal (4.5, 5.5) lies nearer to an occupied cell of the map than the '
                                         'inscribed radius of the robot, 1 m.'),
                      (Pose2D(9.5, 1.5), 'The goal (9.5, 1.5) lies outside of world_bounds, [0, 0, 9, 10].')):
        assert (ways.corners(start, goal), ways.plan(start, goal)) == (None, [])
        assert ways.refusal_of_way(start, goal) == why
    ways = planner(blocked)
    assert ways.corners(start, Pose2D(2.5, 9.5)) is None and ways.reachable(Pose2D(2.5, 9.5))
    assert ways.refusal_of_way(start, Pose2D(2.5, 9.5)) == (
        'No way leads from (2.5, 5.5) to the goal (2.5, 9.5) on the map for a robot of 0 m.')


def test_unknown_cells_are_free_or_not():
    cells = np.zeros((5, 9), np.int8)
    cells[:4, 4] = -1
    start, goal = Pose2D(1.5, 1.5), Pose2D(7.5, 1.5)
    for allow_unknown, corners in ((True, ()), (False, ((3.992188, 4.007812), (5.007812, 4.007812)))):
        check = MapCheck(OccupancyMap(cells, 1.0), allow_unknown)
        assert GridPlanner(check, 0.0).corners(start, goal) == corners


def test_without_a_map_nothing_is_reachable_and_nothing_is_cut():
    ways = GridPlanner(MapCheck(lacking='where is the map?'), 0.3)
    assert ways.corners(Pose2D(), Pose2D(1.0)) is None and ways.refusal_of_way(Pose2D(), Pose2D(1.0)) == ways.lacking
    assert ways.is_clear([(0.0, 0.0), (1.0, 0.0)])


def test_plans_follow_the_corners_a_quarter_of_a_metre_apart():
    ways, start, goal = planner(walled()), Pose2D(2.5, 5.5, 1.0), Pose2D(8.5, 5.5, -1.0)
    plan = ways.plan(start, goal)
    assert (plan[0], plan[-1]) == (start, goal)
    assert max(one.distance_to(other) for one, other in zip(plan, plan[1:])) <= 0.25 + 1e-12
    assert length_of(plan[0], [(pose.x, pose.y) for pose in plan[1:-1]], plan[-1]) == pytest.approx(
        length_of(start, ways.corners(start, goal), goal))
    corner = next(pose for pose in plan if (pose.x, pose.y) == (4.992188, 1.992188))
    assert corner.yaw == 0.0  # where it heads from there
    assert path_along(start, ways.corners(start, goal), goal) == plan


def test_a_plan_near_a_goal_ends_at_a_place_to_which_a_way_leads():
    blocked = walled()
    blocked[7, :] = True  # beyond which nothing is reached
    ways, start, goal = planner(blocked), Pose2D(2.5, 1.5), Pose2D(2.5, 8.5, 0.5)
    assert ways.plan_near(start, goal, 1.0) == []
    plan = ways.plan_near(start, goal, 4.0, add_goal=False)
    assert plan[-1] == Pose2D(2.5, 5.5, 0.5)
    assert ways.plan_near(start, goal, 4.0) == plan + [goal]


# ---- as upstream's planner

def test_inflation_below_the_radius_lets_ways_come_nearer_in_whole_cells():
    check, start, goal = MapCheck(occupancy(walled())), Pose2D(2.5, 8.5), Pose2D(7.5, 8.5)
    for inflation, nearest in ((math.inf, 2), (2.0, 2), (1.2, 2), (1.0, 1), (0.4, 1), (0.0, 0)):
        ways = GridPlanner(check, 2.0, inflation=inflation)
        beside = [column for column in range(5) if ways.reachable(Pose2D(column + 0.5, 5.5))]
        assert max(beside) == 4 - nearest
        assert (ways.corners(start, goal) is None) == (nearest == 2)  # two cells are left south of the wall
    assert 'the inscribed radius of the robot, 1 m' in GridPlanner(check, 2.0, inflation=0.4).refusal(Pose2D(4.5, 5.5))


def test_within_the_tolerance_the_nearest_place_to_which_a_way_leads_counts():
    blocked = walled()
    ways = GridPlanner(MapCheck(occupancy(blocked)), 0.0, tolerance=2.0)
    start, goal = Pose2D(2.5, 8.5), Pose2D(5.5, 8.2, 0.7)
    assert ways.corners(start, goal) is None
    assert ways.nearest_to(start, goal) == Pose2D(4.5, 8.2, 0.7)  # of two equally near ones the western one comes first
    blocked[:, 6:] = True
    ways = GridPlanner(MapCheck(occupancy(blocked)), 0.0, tolerance=1.0)
    assert ways.nearest_to(start, Pose2D(5.5, 8.2)) == Pose2D(4.5, 8.2)
    assert ways.nearest_to(start, Pose2D(7.5, 8.2)) is None
    assert ways.nearest_to(start, Pose2D(-0.5, 8.2)) == Pose2D(0.5, 8.2)  # from off the map, too


def test_a_robot_that_leaves_obstacles_goes_to_the_nearest_free_cell_from_anywhere():
    blocked = np.ones((10, 10), bool)
    blocked[8:, :] = False
    stays, leaves = (GridPlanner(MapCheck(occupancy(blocked)), 0.0, leaves=one) for one in (False, True))
    goal = Pose2D(2.5, 9.5)
    assert stays.corners(Pose2D(2.5, 2.5), goal) is None
    assert leaves.corners(Pose2D(2.5, 2.5), goal) == ((2.5, 8.5),)
    for off, first in ((Pose2D(-7.0, 9.2), (0.5, 9.5)), (Pose2D(4.2, 17.5), (4.5, 9.5)),
                       (Pose2D(1e9, -1e9), (9.5, 8.5))):
        assert stays.corners(off, goal) is None
        assert leaves.corners(off, goal)[0] == first
        assert leaves.plan_near(off, Pose2D(2.5, 7.5), 2.0)
    assert leaves.corners(Pose2D(2.5, 9.2), Pose2D(2.5, 2.5)) is None  # it goes into none
