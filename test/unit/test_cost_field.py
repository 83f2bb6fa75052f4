"""Costs over the cells: against Dijkstra's algorithm in a few lines; which of equal ways; asked in any order."""
import heapq

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays

from move_base_abstract.maps import cost_field
from move_base_abstract.maps.cost_field import DIAGONAL, STRAIGHT, CostField
from move_base_abstract.maps.planning_grid import STEPS, PlanningGrid

BLOCKED = arrays.arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12)), elements=st.booleans(),
                        fill=st.just(False))
LENGTHS = [STRAIGHT if 0 in step else DIAGONAL for step in STEPS]


def neighbours(grid, cell):
    """Return (step's number, cell) of all steps that are allowed."""
    return [(number, cell + int(grid.offsets[number])) for number in range(8) if grid.steps[cell] >> number & 1]


def dijkstra(grid, goal):
    """Return {cell: cost}."""
    costs, queue = {}, [(0, goal)]
    while queue:
        cost, cell = heapq.heappop(queue)
        if cell not in costs:
            costs[cell] = cost
            for number, near in neighbours(grid, cell):
                heapq.heappush(queue, (cost + LENGTHS[number], near))
    return costs


def test_a_diagonal_step_is_the_root_of_two():
    assert pytest.approx(2.0 ** 0.5, rel=3e-7) == DIAGONAL / STRAIGHT


@given(BLOCKED, st.randoms(use_true_random=False))
def test_costs_and_ways_are_those_of_dijkstra_whatever_is_asked_first(blocked, chance):
    grid = PlanningGrid(blocked)
    cells = np.flatnonzero(grid.free).tolist()
    if not cells:
        return
    goal = chance.choice(cells)
    expected = dijkstra(grid, goal)
    field = CostField(grid, goal)
    chance.shuffle(cells)
    for cell in cells:
        assert field.leads_from(cell) == (cell in expected)
        if chance.random() < 0.2:
            field.rest()
        if cell in expected:
            way = field.way_from(cell)
            assert (way[0], way[-1]) == (cell, goal)
            for here, there in zip(way, way[1:]):
                best = [near for number, near in neighbours(grid, here)
                        if expected[near] + LENGTHS[number] == expected[here]]
                assert there == best[0]  # the first of STEPS


def test_long_ways_have_larger_numbers_and_are_no_others(monkeypatch):
    blocked = np.random.default_rng(5).random((40, 40)) < 0.25
    grid = PlanningGrid(blocked)
    goal = int(np.flatnonzero(grid.free)[0])
    cells = np.flatnonzero(grid.free).tolist()
    small = CostField(grid, goal)
    ways = {cell: small.way_from(cell) for cell in cells if small.leads_from(cell)}
    monkeypatch.setattr(cost_field, '_MOST', 10 * STRAIGHT << 3)  # costs are to have more bits from ten cells on
    large = CostField(grid, goal)
    assert max(map(len, ways.values())) > 30
    assert {cell: large.way_from(cell) for cell in cells if large.leads_from(cell)} == ways


def test_it_goes_no_further_than_it_is_asked_to():
    grid = PlanningGrid(np.zeros((200, 200), bool))
    field = CostField(grid, 203)
    assert field.leads_from(208) and field.way_from(208) == [208, 207, 206, 205, 204, 203]
    assert (field._steps < 255).sum() < 100
