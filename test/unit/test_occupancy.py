"""Cells from images in every mode, at the exact edges of the thresholds; places on maps that are shifted and turned."""

import math

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.map_images import ImageRule, MapMode, cells_of_image
from move_base_abstract.maps.map_check import TEXT_OFF_MAP, Ground, MapCheck, square_rings
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.maps.planning import StraightLinePlanner, WorldBounds, straight_path
from move_base_abstract.motion.geometry import Pose2D, quaternion_of_yaw, yaw_of_quaternion

SCALE, RAW = MapMode.SCALE, MapMode.RAW
CELLS = np.array([[0, 100, -1], [1, 99, 50]], np.int8)  # the first row is the southern one


def cells(rule, *pixels):
    """Return the cells of one row of pixels, each a shade or a tuple of channels."""
    array = np.array([pixels], np.uint8)
    return cells_of_image(array[:, :, np.newaxis] if array.ndim == 2 else array, rule)[0].tolist()


# ---- images

def test_the_lowest_row_of_the_image_is_the_first_row_of_the_map():
    pixels = np.array([[0, 205, 254], [254, 254, 0]], np.uint8)[:, :, np.newaxis]
    result = cells_of_image(pixels, ImageRule())
    assert (result.tolist(), result.dtype) == ([[0, 0, 100], [100, -1, 0]], np.int8)


def test_trinary_with_the_usual_thresholds_switches_between_the_shades_that_map_server_does():
    # (255 - 89) / 255 = 0.6510, (255 - 90) / 255 = 0.6471; (255 - 205) / 255 = 0.19608, (255 - 206) / 255 = 0.1922
    assert cells(ImageRule(), 0, 89, 90, 205, 206, 255) == [100, 100, -1, -1, 0, 0]


def test_negate_makes_white_occupied():
    assert cells(ImageRule(negate=True), 255, 166, 165, 50, 49, 0) == [100, 100, -1, -1, 0, 0]


@pytest.mark.parametrize('mode, at_free, at_occupied', [(MapMode.TRINARY, -1, -1), (SCALE, 1, 99)])
def test_an_occupancy_that_equals_a_threshold_is_neither_free_nor_occupied(mode, at_free, at_occupied):
    rule = ImageRule(mode, free_thresh=51 / 255.0, occupied_thresh=204 / 255.0)
    assert cells(rule, 205, 204, 51, 50) == [0, at_free, at_occupied, 100]


def test_scale_maps_what_lies_between_to_1_to_99_and_cuts_fractions_off():
    rule = ImageRule(SCALE, free_thresh=0.0, occupied_thresh=1.0)
    # occupancy 0 is not below 0, occupancy 1 is not above 1; 1 + 98 * 128 / 255 = 50.19, 1 + 98 * 254 / 255 = 98.6
    assert cells(rule, 255, 127, 1, 0) == [1, 50, 98, 99]


def test_raw_takes_the_byte_as_it_is_whatever_the_thresholds():
    assert cells(ImageRule(RAW, occupied_thresh=0.1), 0, 1, 100, 101, 127, 128, 254, 255) == [
        0, 1, 100, 101, 127, -128, -2, -1]
    assert cells(ImageRule(RAW, negate=True), 255, 155, 0) == [0, 100, -1]


def test_colours_count_by_the_mean_of_their_channels():
    # the means are 89.33 and 89.67: one on each side of 0.65 = (255 - 89.25) / 255, then cut off in raw
    assert cells(ImageRule(occupied_thresh=0.649), (89, 89, 90), (90, 90, 89)) == [100, -1]
    assert cells(ImageRule(RAW), (89, 89, 90), (90, 90, 89), (0, 0, 0)) == [89, 89, 0]


def test_in_mode_trinary_alpha_is_one_more_channel_of_the_mean_as_in_map_server():
    # means with alpha: 63.75 -> 0.75, 0 -> 1.0, 255 -> 0.0, 191.25 -> 0.25
    assert cells(ImageRule(), (0, 0, 0, 255), (0, 0, 0, 0), (255, 255, 255, 255), (255, 255, 255, 0)) == [
        100, 100, 0, -1]


def test_in_mode_scale_only_what_is_fully_transparent_and_between_the_thresholds_is_unknown():
    rule = ImageRule(SCALE, free_thresh=0.2, occupied_thresh=0.8)
    grey = (127, 127, 127)
    assert cells(rule, grey + (0,), grey + (1,), grey + (255,), (0, 0, 0, 0), (255, 255, 255, 0)) == [
        -1, 50, 50, 100, 0]


def test_in_mode_raw_alpha_counts_for_nothing():
    assert cells(ImageRule(RAW), (10, 20, 30, 0), (10, 20, 30, 255)) == [20, 20]


def test_thresholds_the_wrong_way_round_or_equal_give_no_nonsense():
    assert cells(ImageRule(SCALE, free_thresh=0.9, occupied_thresh=0.1), 255, 200, 0) == [0, 100, 100]
    assert cells(ImageRule(SCALE, free_thresh=0.2, occupied_thresh=0.2), 205, 204, 203) == [0, 1, 100]


@pytest.mark.parametrize('pixels', [
    np.zeros((2, 2), np.uint8), np.zeros((2, 2, 2), np.uint8), np.zeros((0, 2, 1), np.uint8), np.zeros((2, 2, 1))])
def test_pixels_of_another_kind_are_refused(pixels):
    with pytest.raises(ConfigurationError, match='image: got pixels of type .*; allowed: uint8 of shape'):
        cells_of_image(pixels, ImageRule())


@pytest.mark.parametrize('name', ['occupied_thresh', 'free_thresh'])
def test_a_threshold_must_be_a_number(name):
    with pytest.raises(ConfigurationError, match=name + ': got nan; allowed: a finite number'):
        ImageRule(**{name: math.nan})


@given(st.integers(0, 255), st.booleans(), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_negate_is_the_same_as_the_negative_of_the_image(shade, negate, free, occupied):
    for mode in MapMode:
        one, other = ImageRule(mode, negate, occupied, free), ImageRule(mode, not negate, occupied, free)
        assert one.cell_of_shade(shade) == other.cell_of_shade(255 - shade)


# ---- places

@pytest.mark.parametrize('x, y, value', [
    (0.0, 0.0, 0), (0.49, 0.49, 0), (0.5, 0.0, 100), (1.49, 0.2, -1), (0.0, 0.5, 1), (1.25, 0.99, 50),
    (-1e-9, 0.2, None), (0.2, -1e-9, None), (1.5, 0.2, None), (0.2, 1.0, None), (math.nan, 0.2, None),
    (math.inf, 0.2, None), (1e300, 1e300, None)])
def test_a_cell_reaches_from_its_lower_edge_to_below_its_upper_one(x, y, value):
    assert OccupancyMap(CELLS, 0.5).cell_at(x, y) == value


def test_the_origin_is_the_pose_of_the_lower_left_corner():
    shifted = OccupancyMap(CELLS, 0.5, Pose2D(-10.0, 20.0))
    assert (shifted.cell_at(-9.25, 20.25), shifted.cell_at(0.25, 0.25)) == (100, None)
    # turned by a quarter: the map's x axis points north, its y axis west
    turned = OccupancyMap(CELLS, 0.5, Pose2D(3.0, 4.0, math.pi / 2))
    assert [turned.cell_at(2.75, y) for y in (4.25, 4.75, 5.25)] == [0, 100, -1]
    assert [turned.cell_at(2.25, y) for y in (4.25, 4.75, 5.25, 5.75)] == [1, 99, 50, None]
    assert turned.cell_at(3.25, 4.25) is None


@given(st.floats(-math.pi, math.pi), st.floats(-100, 100), st.floats(-100, 100), st.integers(0, 2), st.integers(0, 1))
def test_the_middle_of_each_cell_is_found_wherever_the_map_lies(yaw, x, y, column, row):
    origin = Pose2D(x, y, yaw)
    place = origin.compose(Pose2D(0.2 * (column + 0.5), 0.2 * (row + 0.5)))
    assert OccupancyMap(CELLS, 0.2, origin).cell_at(place.x, place.y) == CELLS[row, column]


def test_values_below_100_are_free_as_for_move_base():
    raw = OccupancyMap(np.array([[0, 99, 100, 101, -1, -2, -128]], np.int8), 1.0)
    assert [raw.ground_at(x + 0.5, 0.5) for x in range(8)] == [
        Ground.FREE, Ground.FREE, Ground.OCCUPIED, Ground.OCCUPIED, Ground.UNKNOWN, Ground.OCCUPIED, Ground.OCCUPIED,
        Ground.OFF_MAP]


def test_unknown_cells_are_free_if_one_says_so():
    terrain = OccupancyMap(CELLS, 1.0)
    assert [terrain.is_free(Pose2D(x + 0.5, 0.5), unknown) for unknown in (True, False) for x in range(4)] == [
        True, False, True, False, True, False, False, False]


def test_a_map_knows_its_size_and_cannot_be_changed():
    terrain = OccupancyMap(CELLS, 0.5)
    assert (terrain.width, terrain.height, terrain.size) == (3, 2, (1.5, 1.0))
    with pytest.raises(ValueError, match='read-only'):
        terrain.cells[0, 0] = 1


@pytest.mark.parametrize('allowed, resolutions', [
    ('a finite number > 0', (0.0, -1.0, math.nan, math.inf)), ('a number > 0 that 32 bits hold', (1e-60, 1e60))])
def test_a_resolution_is_positive_and_one_that_a_message_can_tell(allowed, resolutions):
    for resolution in resolutions:
        with pytest.raises(ConfigurationError, match=r'resolution: got .*; allowed: ' + allowed + r' \[m/cell\]'):
            OccupancyMap(CELLS, resolution)


@pytest.mark.parametrize('bad', [np.zeros((0, 3), np.int8), np.zeros(3, np.int8), np.zeros((2, 2), np.uint8)])
def test_cells_must_be_a_grid_of_int8(bad):
    with pytest.raises(ConfigurationError, match='map: got cells of type'):
        OccupancyMap(bad, 1.0)


# ---- goals

TERRAIN = OccupancyMap(CELLS, 1.0)
START = Pose2D(0.5, 0.5)
FREE, OCCUPIED, UNKNOWN, OFF = Pose2D(0.5, 1.5), Pose2D(1.5, 0.5), Pose2D(2.5, 0.5), Pose2D(-0.5, 0.5)


@pytest.mark.parametrize('rules, refused', [
    ({}, [OCCUPIED, OFF]), ({'allow_unknown': False}, [OCCUPIED, UNKNOWN, OFF]), ({'allow_occupied': True}, []),
    ({'allow_occupied': True, 'allow_unknown': False}, [])])
def test_which_goals_are_refused(rules, refused):
    planner = StraightLinePlanner(map_check=MapCheck(TERRAIN, **rules))
    assert [goal for goal in (FREE, OCCUPIED, UNKNOWN, OFF) if not planner.reachable(goal)] == refused


def test_why_a_goal_is_refused():
    planner = StraightLinePlanner(map_check=MapCheck(TERRAIN, allow_unknown=False))
    assert [planner.refusal(goal) for goal in (FREE, OCCUPIED, UNKNOWN, OFF)] == [
        None, 'The goal (1.5, 0.5) lies in an occupied cell of the map.',
        'The goal (2.5, 0.5) lies in an unknown cell of the map.', TEXT_OFF_MAP]


def test_without_a_map_nothing_can_be_judged_and_nothing_is_near():
    check = MapCheck(lacking='where is the map?')
    planner = StraightLinePlanner(map_check=check)
    assert (planner.lacking, planner.reachable(FREE), planner.plan_near(START, FREE, 5.0)) == (
        'where is the map?', False, [])
    check.use(TERRAIN)
    assert (planner.lacking, planner.reachable(FREE)) == (None, True)
    assert StraightLinePlanner().lacking is None


def test_bounds_count_on_a_map_too():
    planner = StraightLinePlanner(WorldBounds(0.0, 0.0, 1.0, 1.0), MapCheck(TERRAIN))
    assert (planner.reachable(START), planner.reachable(FREE), planner.refusal(FREE)) == (True, False, None)


def test_rings_go_from_the_inside_out_in_the_order_of_move_base():
    assert list(square_rings(1.0, 1.0)) == [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)]
    offsets = list(square_rings(0.5, 1.9))
    assert len(offsets) == 7 * 7 - 1 == len(set(offsets))
    assert offsets[8:14] == [(-1.0, 0.0), (1.0, 0.0), (-1.0, -0.5), (1.0, -0.5), (-1.0, 0.5), (1.0, 0.5)]
    assert [list(square_rings(*bad)) for bad in ((1.0, 0.9), (1.0, -1.0), (0.0, 1.0))] == [[], [], []]


@pytest.mark.parametrize('tolerance, near', [
    (0.0, None), (math.nan, None), (-1.0, None), (0.2, None),
    (0.6, Pose2D(1.5, 1.1)),  # below three cells the tolerance itself is the step
    (3.0, None)])
def test_a_plan_near_an_occupied_goal_tries_squares_three_cells_apart(tolerance, near):
    grid = np.full((8, 8), 100, np.int8)
    grid[1, 1] = 0
    planner = StraightLinePlanner(map_check=MapCheck(OccupancyMap(grid, 1.0)))
    goal = Pose2D(1.5, 0.5)
    expected = [] if near is None else straight_path(START, near) + [goal]
    assert planner.plan_near(START, goal, tolerance) == expected


def test_a_plan_near_a_goal_takes_the_first_free_place_of_the_search_not_the_nearest():
    grid = np.full((20, 20), 100, np.int8)
    grid[10, 13], grid[11, 10] = 0, 0  # three cells east; one cell north, which no try hits
    planner = StraightLinePlanner(map_check=MapCheck(OccupancyMap(grid, 1.0)))
    goal = Pose2D(10.5, 10.5, 1.0)
    assert planner.plan_near(START, goal, 3.0) == straight_path(START, Pose2D(13.5, 10.5, 1.0)) + [goal]
    assert planner.plan_near(START, goal, 3.0, add_goal=False)[-1] == Pose2D(13.5, 10.5, 1.0)


def test_a_search_with_any_tolerance_ends():
    planner = StraightLinePlanner(map_check=MapCheck(OccupancyMap(np.full((4, 4), 100, np.int8), 1.0)))
    assert planner.plan_near(START, OCCUPIED, math.inf) == []


@given(st.floats(0.001, 10.0), st.floats(-4.0, 4.0) | st.sampled_from([0.0, math.pi / 2, math.pi]),
       st.integers(0, 40), st.integers(0, 40), st.floats(-100.0, 100.0))
@example(0.05, 0.0, 21, 7, 0.0)
@example(0.1, 0.3, 3, 3, 1.0)
def test_a_place_on_a_border_is_in_the_same_cell_of_a_map_from_a_file_and_from_a_topic(resolution, yaw, column, row, x):
    cells = np.arange(41 * 41, dtype=np.int64).reshape(41, 41).astype(np.int8)
    on_topic = yaw_of_quaternion(quaternion_of_yaw(yaw))
    file, topic = (OccupancyMap(cells, side, Pose2D(x, 0.0, angle)) for side, angle in (
        (resolution, yaw), (float(np.float32(resolution)), on_topic)))
    for place in ((x + column * resolution, row * resolution), file.from_cells(column, row)):
        assert file.to_cells(*place) == topic.to_cells(*place)
