"""The cells that a robot may be in, and which places see each other, against reckonings cell by cell."""
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays

from move_base_abstract.maps.planning_grid import PARTS, STEPS, PlanningGrid, blocked_cells

BLOCKED = arrays.arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.booleans(),
                        fill=st.just(False))
CELLS = arrays.arrays(np.int8, st.tuples(st.integers(1, 8), st.integers(1, 12)),
                      elements=st.sampled_from((0, 50, 100, -1)))


# ---- inflation

@given(CELLS, st.sampled_from((0.0, 0.9, 1.0, 1.5, 2.0, 2.3, 5.0, 40.0)), st.booleans())
def test_blocked_is_what_lies_within_the_radius_of_an_occupied_cell(cells, radius, unknown_is_free):
    blocked = blocked_cells(cells, radius, unknown_is_free)
    occupied = np.argwhere(cells == 100)
    for row, column in np.ndindex(cells.shape):
        is_near = any(math.hypot(*(one - (row, column))) <= radius for one in occupied)
        assert blocked[row, column] == (is_near or (cells[row, column] == -1 and not unknown_is_free))


@pytest.mark.parametrize('radius, resolution, reach', [(0.3, 0.1, 3), (0.7, 0.1, 7), (0.15, 0.05, 3), (0.29, 0.1, 2)])
def test_a_radius_of_whole_cells_is_one_in_spite_of_rounding(radius, resolution, reach):
    cells = np.zeros((1, 21), np.int8)
    cells[0, 10] = 100
    for exact in (resolution, float(np.float32(resolution))):
        assert blocked_cells(cells, radius / exact).sum() == 2 * reach + 1


def test_values_that_no_map_has_are_occupied():
    assert blocked_cells(np.array([[0, 99, 101, -2, -1]], np.int8), 0.0).tolist() == [[False, False, True, True, False]]


# ---- cells and places

def test_places_lie_inside_of_their_cells_and_off_the_grid_there_is_none():
    grid = PlanningGrid(np.zeros((3, 5), bool))
    assert grid.place(0.0, 0.0) == (2, 2)
    assert grid.place(4.9999999, 2.5) == (5 * PARTS - 2, 2 * PARTS + PARTS // 2)
    assert grid.place(5.0, 1.0) is None and grid.place(-1e-9, 1.0) is None and grid.place(1.0, 3.0) is None
    assert grid.place(math.nan, 1.0) is None
    for column, row in ((0, 0), (4, 2), (3, 1)):
        place = column * PARTS + PARTS // 2, row * PARTS + PARTS // 2
        assert grid.place(column + 0.5, row + 0.5) == place
        assert grid.centre_of(grid.cell_of(place)) == place
    for part in range(2, PARTS - 1):  # what is given to a micrometre is the same place again
        assert {grid.place(round(3.0 + part / PARTS, 6) + shift, 1.5)[0] for shift in (-1e-6, 0.0, 1e-6)} == {
            3 * PARTS + part}


@given(BLOCKED)
def test_steps_lead_to_free_cells_and_cut_no_corner(blocked):
    grid = PlanningGrid(blocked)

    def is_free(row, column):
        return 0 <= row < blocked.shape[0] and 0 <= column < blocked.shape[1] and not blocked[row, column]
    for row, column in np.ndindex(blocked.shape):
        cell = grid.cell_of((column * PARTS + 1, row * PARTS + 1))
        assert grid.is_free(cell) == is_free(row, column)
        allowed = [bool(grid.steps[cell] >> number & 1) for number in range(8)]
        assert allowed == [is_free(row, column) and is_free(row + dy, column + dx) and is_free(row + dy, column)
                           and is_free(row, column + dx) for dx, dy in STEPS]
        assert grid.is_corner(cell) == (is_free(row, column) and any(
            is_free(row + dy, column) and is_free(row, column + dx) and not is_free(row + dy, column + dx)
            for dx, dy in STEPS[4:]))


def test_the_nearest_free_cell_of_equal_ones_is_the_southernmost_then_the_westernmost():
    blocked = np.ones((7, 7), bool)
    blocked[1, 3] = blocked[3, 1] = blocked[3, 5] = blocked[5, 3] = False
    grid = PlanningGrid(blocked)
    middle = 3 * PARTS + 5, 3 * PARTS + 7
    assert grid.nearest_free(middle, 2) == grid.cell_of((3 * PARTS, 1 * PARTS))
    assert grid.nearest_free(middle, 1) is None
    assert grid.nearest_free(middle, 10 ** 6) == grid.nearest_free(middle, 2)  # no more than the grid is looked at
    blocked[1, 3] = True
    assert PlanningGrid(blocked).nearest_free(middle, 2) == grid.cell_of((1 * PARTS, 3 * PARTS))


# ---- sight

def touches(one, other, column, row, margin=0):
    """Return whether the straight piece between two places comes to the cell, its border and ``margin`` included."""
    low, high = sorted((one, other))
    box = [(x, y) for x in (column * PARTS - margin, (column + 1) * PARTS + margin)
           for y in (row * PARTS - margin, (row + 1) * PARTS + margin)]
    south, north = sorted((one[1], other[1]))
    if high[0] < box[0][0] or low[0] > box[3][0] or north < box[0][1] or south > box[3][1]:
        return False
    sides = [(high[0] - low[0]) * (y - low[1]) - (high[1] - low[1]) * (x - low[0]) for x, y in box]
    return min(sides) <= 0 <= max(sides)


@given(BLOCKED, st.integers(0, 1), st.data())
def test_places_see_each_other_where_all_cells_near_the_line_are_free(blocked, margin, data):
    rows, columns = blocked.shape
    inside = st.sampled_from((2, PARTS // 2, PARTS - 2)) | st.integers(2, PARTS - 2)
    one, other = [(data.draw(st.integers(0, columns - 1)) * PARTS + data.draw(inside),
                   data.draw(st.integers(0, rows - 1)) * PARTS + data.draw(inside)) for _ in range(2)]
    expected = not any(touches(one, other, column, row, margin) and blocked[row, column]
                       for row, column in np.ndindex(blocked.shape))
    grid = PlanningGrid(blocked)
    assert grid.sees(one, other, margin) == grid.sees(other, one, margin) == expected


@pytest.mark.parametrize('off, seen', [(0, [False, False]), (1, [True, False]), (2, [True, False]), (3, [True, True])])
def test_a_line_that_passes_a_corner_within_a_part_is_seen_without_a_margin_only(off, seen):
    blocked = np.zeros((9, 9), bool)
    blocked[4, 4] = True  # its north-west corner is (4, 5); the line has half of ``off`` parts between them, each way
    low = 2 * PARTS + PARTS // 2, 3 * PARTS + PARTS // 2 + off
    high = low[0] + 4 * PARTS, low[1] + 4 * PARTS
    assert [PlanningGrid(blocked).sees(low, high, margin) for margin in (0, 1)] == seen


@given(BLOCKED)
def test_ways_bend_two_parts_off_the_corners_of_what_is_not_free(blocked):
    rows, columns = blocked.shape
    grid = PlanningGrid(blocked)
    padded = np.pad(blocked, 1, constant_values=True)
    expected = []
    for row, column in np.ndindex(blocked.shape):
        for dx, dy in STEPS[4:]:
            near = padded[row + 1, column + 1], padded[row + 1, column + 1 + dx], padded[row + 1 + dy, column + 1]
            if not any(near) and padded[row + 1 + dy, column + 1 + dx]:
                corner = (column + (dx > 0)) * PARTS, (row + (dy > 0)) * PARTS
                bend = corner[0] - 2 * dx, corner[1] - 2 * dy
                assert grid.corner_at(bend) == (dx, dy) and grid.is_corner(grid.cell_of(bend))
                expected.append((*corner, *bend))
    found = grid.corners_within(((1, 1), (columns * PARTS - 1, rows * PARTS - 1)))
    assert sorted(map(tuple, np.hstack(found).tolist())) == sorted(expected)
    assert grid.corner_at((2, 3)) is None


def test_a_line_through_a_corner_touches_all_four_cells():
    grid = PlanningGrid(np.array([[False, True], [False, False]]))
    low, high = (PARTS // 2, PARTS // 2), (3 * PARTS // 2, 3 * PARTS // 2)
    assert not grid.sees(low, high)
    assert grid.sees((low[0], low[1] + PARTS), high)
