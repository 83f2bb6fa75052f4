"""Ways bend at the true corners of what is not free: against a visibility graph, and clear as they are driven."""
import math
import random
from fractions import Fraction

import networkx
import numpy as np
import pytest

from move_base_abstract.maps import grid_planner
from move_base_abstract.maps.cost_field import CostField
from move_base_abstract.maps.grid_planner import MapWays
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.maps.planning_grid import PARTS, PlanningGrid
from move_base_abstract.maps.tightening import is_taut, tightened
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_mapf.movingai import read_map
from movingai_files import FOLDER

#: by map: how much longer than the shortest ways may be on average, and how many of 20 have to be the shortest. A way
#: may pass an obstacle on the side that is not the shorter one; a bend adds nothing
EXCESS = {'walls': (1e-6, 20), 'rooms': (1e-6, 20), 'boxes': (6e-3, 15), 'discs': (1e-6, 20), 'scattered': (1.2e-2, 8)}


def the_map(name):
    """Return an OccupancyMap, and the radius [m] of the robots on it."""
    chance = random.Random(2)
    if name == 'discs':
        rows, columns = np.mgrid[0:80, 0:100]
        discs = [(chance.randrange(100), chance.randrange(80), chance.randrange(4, 13)) for _ in range(10)]
        return occupancy(sum((columns - x) ** 2 + (rows - y) ** 2 <= r * r for x, y, r in discs) > 0), 0.3
    if name == 'walls':
        blocked = np.zeros((60, 90), bool)
        for column in range(12, 90, 13):
            blocked[:, column] = True
            row = chance.randrange(50)
            blocked[row:row + 8, column] = False
        return occupancy(blocked), 0.2
    return occupancy(read_map(FOLDER / (name + '.map'))[::-1]), 0.0


def occupancy(blocked):
    """Return the OccupancyMap of blocked cells, [row from the south, column], of 0.1 m."""
    return OccupancyMap(np.where(blocked, 100, 0).astype(np.int8), 0.1)


def asked(ways, an_occupancy, number, seed):
    """Return ``number`` ways that have corners: [all their points, m], from anywhere to anywhere."""
    chance, found = random.Random(seed), []
    while len(found) < number:
        start, goal = (Pose2D(*an_occupancy.from_cells(chance.uniform(0.0, ways.grid.columns),
                                                       chance.uniform(0.0, ways.grid.rows))) for _ in range(2))
        corners = ways.corners(start, goal) if ways.is_free(start) and ways.is_free(goal) else ()
        if corners:
            found.append([(start.x, start.y), *corners, (goal.x, goal.y)])
    return found


def length_of(points):
    """Return the length of a way."""
    return sum(map(math.dist, points, points[1:]))


# ---- against the shortest of all

def bends_of(grid):
    """Return all places at which a shortest way may bend: those next to convex corners of what is not free."""
    free = grid.free.reshape(grid.rows + 2, grid.columns + 2)
    bends = []
    for row, column in np.argwhere(free):
        for dx, dy in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
            if free[row, column + dx] and free[row + dy, column] and not free[row + dy, column + dx]:
                bends.append(tuple(int(cell - 1) * PARTS + (PARTS - 2 if step > 0 else 2)
                                   for cell, step in ((column, dx), (row, dy))))
    return bends


def visibility(grid, bends):
    """Return the graph of which bends see each other by the planner's own rule, with their distances in cells."""
    graph = networkx.Graph()
    for number, one in enumerate(bends):
        graph.add_weighted_edges_from((one, other, math.dist(one, other) / PARTS)
                                      for other in bends[:number] if grid.sees(one, other))
    return graph


def shortest(grid, graph, bends, ends):
    """Return the length of the shortest way between two places that do not see each other [cells]."""
    for end in ends:
        graph.add_weighted_edges_from((('end', end), bend, math.dist(end, bend) / PARTS)
                                      for bend in bends if grid.sees(end, bend))
    length = networkx.dijkstra_path_length(graph, *(('end', end) for end in ends))
    graph.remove_nodes_from([('end', end) for end in ends])
    return length


@pytest.mark.parametrize('name', EXCESS)
def test_ways_are_as_short_as_by_a_visibility_graph_but_for_the_side_on_which_they_pass(name):
    an_occupancy, radius = the_map(name)
    ways = MapWays(an_occupancy, radius)
    grid = ways.grid
    bends = bends_of(grid)
    graph = visibility(grid, bends)
    excess = []
    for points in asked(ways, an_occupancy, 20, 5):
        places = [grid.place(*an_occupancy.to_cells(*point)) for point in points]
        assert all(grid.sees(*piece) for piece in zip(places, places[1:]))
        assert all(is_taut(grid, *places[index - 1:index + 2]) for index in range(1, len(places) - 1))
        excess.append(length_of(places) / PARTS / shortest(grid, graph, bends, (places[0], places[-1])) - 1.0)
    assert min(excess) > -1e-9
    most, least = EXCESS[name]
    assert sum(excess) / len(excess) < most, sum(excess) / len(excess)
    assert sum(each < 1e-6 for each in excess) >= least


def test_there_and_back_are_equally_long_on_average():
    an_occupancy, radius = the_map('boxes')
    ways = MapWays(an_occupancy, radius)
    there = asked(ways, an_occupancy, 60, 6)
    back = [[points[-1], *ways.corners(Pose2D(*points[-1]), Pose2D(*points[0])), points[0]] for points in there]
    shares = [length_of(one) / length_of(other) for one, other in zip(there, back)]
    assert abs(sum(shares) / len(shares) - 1.0) < 2e-3
    assert sum(abs(share - 1.0) < 1e-6 for share in shares) > 50


# ---- clear, as it is driven

def touched(one, other):
    """Yield the cells (column, row) that the line between two points touches, given in cells; without rounding."""
    (x, y), (end_x, end_y) = sorted((tuple(map(Fraction, one)), tuple(map(Fraction, other))))
    for column in range(math.floor(x) - 1, math.floor(end_x) + 1):
        sides = max(x, column), min(end_x, column + 1)
        if sides[0] <= sides[1]:
            rows = sorted([y, end_y] if x == end_x else [y + (end_y - y) * (side - x) / (end_x - x) for side in sides])
            for row in range(math.ceil(rows[0]) - 1, math.floor(rows[1]) + 1):
                yield column, row


@pytest.mark.parametrize('name', ['rooms', 'boxes', 'discs', 'scattered'])
def test_ways_touch_free_cells_only_as_they_are_driven_and_are_clear_from_wherever_the_robot_is(name):
    an_occupancy, radius = the_map(name)
    ways = MapWays(an_occupancy, radius)
    free = ways.grid.free.reshape(ways.grid.rows + 2, ways.grid.columns + 2)
    chance = random.Random(7)
    for points in asked(ways, an_occupancy, 30, 8):
        cells = [an_occupancy.to_cells(*point) for point in points]
        for number, piece in enumerate(zip(cells, cells[1:])):
            assert all(free[row + 1, column + 1] for column, row in touched(*piece))
            share = chance.random()
            here = tuple(a + (b - a) * share for a, b in zip(points[number], points[number + 1]))
            assert ways.is_clear([here, *points[number + 1:]])


def test_a_line_that_passes_a_corner_by_less_than_is_rounded_is_no_way():
    blocked = np.zeros((9, 9), bool)
    blocked[4, 4] = True
    an_occupancy, chance, number = occupancy(blocked), random.Random(9), 0
    ways = MapWays(an_occupancy, 0.0)
    while number < 40:
        ends = [tuple(chance.uniform(low, low + 2.0) for low in lows) for lows in ((1.0, 3.0), (5.0, 4.5))]
        places = [ways.grid.place(*end) for end in ends]
        if not ways.grid.sees(*places, 0) or ways.grid.sees(*places, 1):
            continue
        number += 1
        ends = [an_occupancy.from_cells(*end) for end in ends]
        way = [ends[0], *ways.corners(*(Pose2D(*end) for end in ends)), ends[1]]
        for share in np.arange(0.0, 1.0, 0.01).tolist():
            for index, (one, other) in enumerate(zip(way, way[1:])):
                here = tuple(a + (b - a) * share for a, b in zip(one, other))
                assert ways.is_clear([here, *way[index + 1:]])


def test_on_cells_smaller_than_a_millimetre_corners_have_the_digits_that_it_takes():
    blocked = np.zeros((10, 10), bool)
    blocked[2:, 5] = True
    an_occupancy = OccupancyMap(np.where(blocked, 100, 0).astype(np.int8), 1e-5)
    corners = MapWays(an_occupancy, 0.0).corners(Pose2D(2.5e-5, 5.5e-5), Pose2D(8.5e-5, 5.5e-5))
    assert [tuple(value * PARTS for value in an_occupancy.to_cells(*corner)) for corner in corners] == [
        pytest.approx(place, abs=0.01) for place in ((5 * PARTS - 2, 2 * PARTS - 2), (6 * PARTS + 2, 2 * PARTS - 2))]


# ---- the work

def test_a_way_over_cells_is_pulled_tight_in_a_few_looks_for_each_of_them(monkeypatch):
    looks, sees = [0], PlanningGrid.sees

    def counted(grid, *places):
        looks[0] += 1
        return sees(grid, *places)
    monkeypatch.setattr(PlanningGrid, 'sees', counted)
    grid = PlanningGrid(read_map(FOLDER / 'scattered.map')[::-1])
    chance, cells, number = random.Random(3), np.flatnonzero(grid.free).tolist(), 0
    for _ in range(60):
        start, goal = chance.sample(cells, 2)
        field = CostField(grid, goal)
        if field.leads_from(start):
            places = [grid.centre_of(cell) for cell in field.way_from(start)]
            found = tightened(grid, places)
            assert all(is_taut(grid, *found[index - 1:index + 2]) for index in range(1, len(found) - 1))
            number += len(places)
    assert looks[0] < 3 * number


def test_pulling_tight_is_the_lesser_part_of_planning(monkeypatch):
    looks, sees = [0], PlanningGrid.sees

    def counted(grid, *places):
        looks[0] += 1
        return sees(grid, *places)
    monkeypatch.setattr(PlanningGrid, 'sees', counted)
    an_occupancy, radius = the_map('discs')
    asked(MapWays(an_occupancy, radius), an_occupancy, 30, 5)
    with_corners, looks[0] = looks[0], 0
    monkeypatch.setattr(grid_planner, 'tightened', lambda _grid, places: places)
    asked(MapWays(an_occupancy, radius), an_occupancy, 30, 5)
    assert looks[0] < with_corners < 1.2 * looks[0]
