"""Footprints as costmap_2d reads them, and the window that goes with the robot."""
import math

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.maps.costmaps import Footprint, Window, read_costmaps
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D

WHERE = '/robot_0/move_base'
SQUARE = [[0.18, 0.2], [0.18, -0.2], [-0.18, -0.2], [-0.18, 0.2]]


def footprints(raw):
    """Return the corners of (global, local) footprint, without padding."""
    plain = {costmap: {'footprint_padding': 0.0, **raw.pop(costmap, {})}
             for costmap in ('global_costmap', 'local_costmap')}
    costmaps, _ = read_costmaps({**plain, **raw}, WHERE)
    return [[list(point) for point in footprint.points] for footprint in (costmaps.global_footprint,
                                                                          costmaps.local_footprint)]


@pytest.mark.parametrize('value', [
    SQUARE, '[[0.18,0.2],[0.18,-0.2],[-0.18,-0.2],[-0.18,0.2]]',
    ' [ [0.18, 0.2] , [.18 -2e-1]\n, [-0.18, -0.2], [-0.18, 0.2] ] '])
def test_a_footprint_comes_as_a_list_or_as_a_text(value):
    assert footprints({'global_costmap': {'footprint': value}})[0] == SQUARE
    assert footprints({'footprint': value}) == [SQUARE, SQUARE]


def test_the_costmaps_own_footprint_comes_before_the_shared_one_and_both_before_a_radius():
    other = [[1, 0], [0, 1], [-1, -1]]
    assert footprints({'footprint': other, 'local_costmap': {'footprint': SQUARE}}) == [other, SQUARE]
    assert footprints({'footprint': other, 'local_costmap': {'robot_radius': 2.0}}) == [other, other]


@pytest.mark.parametrize('empty', ['', '[]', []])
def test_without_a_footprint_the_robot_is_a_circle_of_sixteen_corners(empty):
    own, shared = footprints({'footprint': empty, 'robot_radius': 2, 'global_costmap': {'robot_radius': 1.5}})
    for points, radius in ((own, 1.5), (shared, 2.0), (footprints({})[0], 0.46)):
        assert len(points) == 16
        assert points[0] == [radius, 0.0]
        assert [math.hypot(*point) for point in points] == pytest.approx([radius] * 16)


def test_padding_moves_each_corner_away_from_the_middle_by_a_centimetre_or_what_is_said():
    raw = {'footprint': [[1.0, 0], [-1.0, 0.5], [0, -1.0]], 'local_costmap': {'footprint_padding': 0.1}}
    costmaps, used = read_costmaps(raw, WHERE)
    assert costmaps.global_footprint.points == ((1.01, 0.0), (-1.01, 0.51), (0.0, -1.01))
    assert costmaps.local_footprint.points == ((1.1, 0.0), (-1.1, 0.6), (0.0, -1.1))
    assert sorted(set(used)) == ['~footprint', '~local_costmap/footprint_padding']


@pytest.mark.parametrize('value', [
    7, {'x': 1}, [[0, 1], [1, 0]], [[0, 1], [1, 0], [1]], [[0, 1], [1, 0], ['1', 2]], [[0, 1], [1, 0], [math.nan, 2]],
    '[[0,1],[1,0]]', '[[0,1],[1,0],[1,1]', '[[0,1],[1,0],[1,1]]]', '[[0,1],[1,0],[1,one]]', '[0,1]', '[[[0,1]]]',
    '[[0,1],[1,0],[1,1_0]]', 'none', '[[0,1],[1,0],[1,nan]]', '[' * 200_000, [[0, 1]] * 1001])
def test_what_is_no_footprint_is_an_error_that_says_what_is(value):
    with pytest.raises(ConfigurationError, match=r'parameter /robot_0/move_base/local_costmap/footprint: got .*; '
                                                 'allowed: 3 to 1000 points'):
        read_costmaps({'local_costmap': {'footprint': value}}, WHERE)


def test_settings_carry_the_costmaps_and_count_what_is_ignored_without_them():
    settings = read_settings({'footprint': SQUARE, 'local_costmap': {'width': 4, 'update_frequency': 5.0}}, WHERE)
    assert settings.costmaps.window == Window(80, 200, 0.05)
    assert settings.ignored == ['local_costmap/update_frequency']


INFLATES, STATIC = {'name': 'i', 'type': 'costmap_2d::InflationLayer'}, {'name': 's', 'type': 'costmap_2d/StaticLayer'}


@pytest.mark.parametrize(('group', 'inflation', 'topic', 'used'), [
    ({}, math.inf, 'map', []), ({'inflation_radius': 0.3}, 0.3, 'map', ['inflation_radius']),
    ({'inflation_layer': {'inflation_radius': 0.3}}, 0.3, 'map', ['inflation_layer/inflation_radius']),
    ({'plugins': [STATIC]}, 0.0, 'map', ['plugins']), ({'plugins': [INFLATES]}, math.inf, None, ['plugins']),
    ({'plugins': [STATIC, INFLATES], 'i': {'inflation_radius': 0.3}, 's': {'map_topic': '/yard'}}, 0.3, '/yard',
     ['i/inflation_radius', 'plugins', 's/map_topic']),
    ({'plugins': [STATIC, INFLATES], 'inflation_radius': 0.2, 'i': {'inflation_radius': 0.3}}, 0.2, 'map',
     ['i/inflation_radius', 'inflation_radius', 'plugins']),  # costmap_2d copies the outer one into its layer
    ({'plugins': [STATIC, INFLATES], 'i': {'enabled': False}}, 0.0, 'map', ['i/enabled', 'plugins']),
    ({'static_map': False}, math.inf, None, ['static_map']),
    ({'plugins': [STATIC, {'name': 'o', 'type': 'x::ObstacleLayer'}]}, 0.0, 'map', [])])
def test_the_layers_of_the_global_costmap_say_how_far_it_inflates_and_which_map_it_has(group, inflation, topic, used):
    costmaps, paths = read_costmaps({'global_costmap': group}, WHERE)
    assert (costmaps.inflation, costmaps.map_topic) == (inflation, topic)
    assert sorted(paths) == ['~global_costmap/' + name for name in used]
    assert read_costmaps({'global_costmap': group}, WHERE, uses_map=False)[1] == []


def test_a_robot_on_a_map_hears_it_where_its_costmap_does_unless_its_own_topic_is_set():
    group = {'global_costmap': {'map_topic': 'yard'}, 'use_map': True}
    assert read_settings(group, WHERE).values['map_topic'] == 'yard'
    assert read_settings({**group, 'map_topic': '/other'}, WHERE).values['map_topic'] == '/other'
    assert read_settings({**group, 'use_map': False}, WHERE).values['map_topic'] is None


def test_a_footprint_turns_with_the_robot():
    corners = Footprint(((1.0, 0.0), (0.0, 2.0))).at(Pose2D(10.0, 20.0, math.pi / 2))
    assert corners == [pytest.approx((10.0, 21.0)), pytest.approx((8.0, 20.0))]


def test_a_window_lies_around_the_robot_on_whole_cells():
    window = Window(8, 4, 0.5)
    assert window.corner(Pose2D(0.0, 0.0)) == (-2.0, -1.0)
    assert window.corner(Pose2D(0.49, 0.5)) == (-2.0, -0.5)
    assert window.corner(Pose2D(-0.01, 0.0)) == (-2.5, -1.0)
    assert window.corner(Pose2D(1e9, -1e9)) == (1e9 - 2.0, -1e9 - 1.0)


def test_a_window_of_too_many_cells_is_refused():
    with pytest.raises(ConfigurationError, match='allowed: at most 4000000 cells'):
        read_costmaps({'local_costmap': {'width': 1e308, 'resolution': 1e-3}}, WHERE)


def test_what_a_window_shows_of_a_map_is_the_map_under_the_centres_of_its_cells():
    ground = OccupancyMap(np.array([[0, 100, -1], [1, 99, 50]], np.int8), 1.0, Pose2D(10.0, 20.0))
    assert ground.cut(10.0, 20.0, 3, 2, 1.0).tolist() == [[0, 100, -1], [1, 99, 50]]
    assert ground.cut(9.0, 19.5, 3, 2, 1.0).tolist() == [[-1, 0, 100], [-1, 1, 99]]
    assert ground.cut(10.0, 20.0, 4, 1, 0.5).tolist() == [[0, 0, 100, 100]]
    turned = OccupancyMap(np.array([[0, 100, -1], [1, 99, 50]], np.int8), 1.0, Pose2D(0.0, 0.0, math.pi / 2))
    assert turned.cut(-2.0, 0.0, 2, 3, 1.0).tolist() == [[1, 0], [99, 100], [50, -1]]
    assert set(turned.cut(1e300, -1e300, 2, 3, 1.0).ravel().tolist()) == {-1}
