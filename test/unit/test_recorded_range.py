"""Goals outside of what a calibration was fitted to: found, counted in the log, warned of once."""
import copy
import math
import os
import warnings

import numpy as np
import pytest
import yaml

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.maps.way_clearance import LIMIT, distance_field, way_clearance
from move_base_abstract.motion.calibration import make_calibration
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.recorded_range import HELD
from move_base_abstract.scenario import make_scenario

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
RAW = load_yaml_file(os.path.join(ROOT, 'config', 'calibrated', 'move_base_dwa_stage.yaml'))
RANGES = {'length': [2.0, 30.0], 'start_turn': [0.0, 2.0], 'clearance': [0.5, 3.0]}


def a_fleet(tmp_path, ranges, occupancy=None, robots=('bot',), **parameters):
    """Return a fleet whose robots have a calibration with the ``ranges``, None: without."""
    raw = {key: value for key, value in RAW.items() if key not in ('recorded', 'intervals')}
    raw['tail_rate'] = raw['failure_by_length'] = 0.0
    raw['failure_by_length'] = []
    if ranges is not None:
        raw['recorded'] = ranges
    path = tmp_path / 'mine.yaml'
    path.write_text(yaml.safe_dump(raw))
    return Fleet(make_scenario({'defaults': {'calibration': str(path), **parameters},
                                'robots': [{'name': name} for name in robots]}), start_ns=0, occupancy=occupancy)


def beyond(fleet):
    return [entry.values for entry in fleet.trace if entry.kind == 'beyond']


def go(fleet, *goals, name='bot'):
    for goal in goals:
        fleet.robot(name).send(*goal)
        fleet.run()


def test_a_goal_outside_is_noted_before_it_departs(tmp_path):
    fleet = a_fleet(tmp_path, RANGES)
    with pytest.warns(UserWarning) as said:
        go(fleet, (20.0, 0.0), (51.0, 0.0), (52.0, 0.0), (20.0, 0.0))
    tolerance = RAW['xy_goal_tolerance']
    assert [values[0] for values in beyond(fleet)] == ['longer', 'shorter', 'longer']
    assert beyond(fleet)[0][1] == pytest.approx(31.0 + tolerance)  # it had stopped that much before its last goal
    assert 'turn' in beyond(fleet)[2] and beyond(fleet)[2][3] == pytest.approx(math.pi, abs=0.01)
    kinds = [entry.kind for entry in fleet.trace]
    assert kinds[0] == 'recorded'
    assert fleet.trace[0].values == ('length', 2.0, 30.0, 'start_turn', 0.0, 2.0, 'clearance', 0.5, 3.0)
    assert [kinds[place + 1] for place, kind in enumerate(kinds) if kind == 'beyond'] == ['departed'] * 3
    assert len(said) == 1
    assert str(said[0].message) == (
        'bot: a goal lies outside the ranges to which its calibration was fitted (a way of 31.10 m, recorded: 2.00 to '
        '30.00 m); this warning comes once, but event logs have a row beyond for each such goal')


def test_the_edge_of_what_was_recorded_is_inside(tmp_path):
    fleet = a_fleet(tmp_path, RANGES)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        go(fleet, (30.0, 0.0))
        fleet.robot('bot').place(Pose2D(0.0, 0.0, 2.0 + math.radians(0.9)))
        go(fleet, (2.0, 0.0))
    assert beyond(fleet) == []
    fleet = a_fleet(tmp_path, RANGES)
    with pytest.warns(UserWarning):
        go(fleet, (30.001, 0.0))
        fleet.robot('bot').place(Pose2D(0.0, 0.0, 2.0 + math.radians(1.1)))
        go(fleet, (2.0, 0.0))
    assert [values[0] for values in beyond(fleet)] == ['longer', 'turn']


def test_a_goal_counts_once_however_often_its_robot_sets_out(tmp_path):
    fleet = a_fleet(tmp_path, RANGES)
    with pytest.warns(UserWarning) as said:
        fleet.robot('bot').send(40.0, 0.0)
        fleet.run_for(5.0)
        fleet.robot('bot').hold('because')
        fleet.run_for(1.0)
        fleet.robot('bot').release('because')
        fleet.run()
    assert len([entry for entry in fleet.trace if entry.kind == 'departed']) == 2
    assert len(beyond(fleet)) == len(said) == 1


def test_a_fleet_warns_once_for_all_its_robots(tmp_path):
    fleet = a_fleet(tmp_path, RANGES, robots=('a', 'b'))
    with pytest.warns(UserWarning) as said:
        go(fleet, (40.0, 0.0), name='a')
        go(fleet, (40.0, 0.0), name='b')
    assert len(said) == 1
    assert len(beyond(fleet)) == 2


def test_logs_of_robots_without_ranges_have_no_rows_of_them(tmp_path):
    fleet = a_fleet(tmp_path, None)
    go(fleet, (400.0, 0.0))
    plain = Fleet(make_scenario({'robots': [{'name': 'bot', 'duration_factor': 1.2}]}), start_ns=0)
    go(plain, (400.0, 0.0))
    assert not {'beyond', 'recorded'} & {entry.kind for entry in fleet.trace + plain.trace}


def a_map(gap):
    """Return a map of 20 x 10 m, 0.1 m a cell: a wall at x = 10 m with a gap of so many cells at y = 5 m."""
    cells = np.zeros((100, 200), np.int8)
    cells[:, 100] = 100
    cells[50 - gap // 2:50 - gap // 2 + gap, 100] = 0
    return OccupancyMap(cells, 0.1)


@pytest.mark.parametrize(('gap', 'expected'), [(6, ['narrow']), (20, [])])
def test_a_way_through_a_gap_that_is_narrower_than_all_recorded_ones_is_noted(tmp_path, gap, expected):
    ranges = {**RANGES, 'length': [0.0, 100.0], 'start_turn': [0.0, 3.15]}
    fleet = a_fleet(tmp_path, ranges, a_map(gap), use_map=True, start_x=5.0, start_y=5.0)
    with warnings.catch_warnings(record=True):
        go(fleet, (15.0, 5.0))
    assert [values[0] for values in beyond(fleet)] == expected
    without_map = a_fleet(tmp_path, ranges, start_x=5.0, start_y=5.0)
    go(without_map, (15.0, 5.0))
    assert beyond(without_map) == []


def test_distances_are_those_of_a_search_of_all_cells():
    generator = np.random.default_rng(3)
    for _ in range(20):
        occupied = generator.random((generator.integers(1, 30), generator.integers(1, 30))) < 0.03
        reach = int(generator.integers(1, 12))
        rows, columns = np.nonzero(occupied)
        y, x = np.indices(occupied.shape)
        expected = np.full(occupied.shape, reach * reach)
        for row, column in zip(rows, columns):
            expected = np.minimum(expected, (y - row) ** 2 + (x - column) ** 2)
        assert (distance_field(occupied, reach) == expected).all()


def test_a_way_comes_as_near_as_its_nearest_point():
    occupancy = a_map(20)
    assert way_clearance(occupancy, [(1.0, 5.0), (5.0, 5.0)]) == LIMIT
    assert way_clearance(occupancy, [(1.0, 1.0), (9.0, 1.0), (1.0, 1.0)]) == pytest.approx(0.95, abs=0.11)
    assert way_clearance(occupancy, [(5.0, 5.0), (15.0, 5.0)]) == pytest.approx(0.95, abs=0.11)
    assert way_clearance(occupancy, [(5.0, 1.0), (15.0, 1.0)]) == 0.0
    assert way_clearance(occupancy, [(9.0, 1.0)]) == pytest.approx(0.95, abs=0.11)
    assert way_clearance(occupancy, [(-50.0, -50.0), (-40.0, 50.0)]) == LIMIT


@pytest.mark.parametrize('section', [
    {'recorded': 3}, {'recorded': {'length': [1.0, 2.0]}}, {'recorded': {**RANGES, 'width': [0.0, 1.0]}},
    {'recorded': {**RANGES, 'length': [2.0, 1.0]}}, {'recorded': {**RANGES, 'start_turn': [0.0, 4.0]}},
    {'recorded': {**RANGES, 'length': [1.0, math.inf]}}, {'recorded': {**RANGES, 'length': 'long'}},
    {'intervals': []}, {'intervals': {'spread': 'unknown'}}, {'intervals': {'spread': [2.0, 1.0]}},
    {'intervals': {3: [1.0, 2.0]}},
])
def test_sections_that_cannot_be_used_are_named(section):
    with pytest.raises(ConfigurationError, match='{}.*allowed'.format(next(iter(section)))):
        make_calibration({**copy.deepcopy(RAW), **section}, 'mine.yaml')


def test_sections_are_read_and_may_be_missing():
    raw = {key: value for key, value in RAW.items() if key not in ('recorded', 'intervals')}
    assert make_calibration(raw, 'x').durations.recorded is None
    found = make_calibration({**raw, 'recorded': RANGES, 'intervals': {'spread': [0.1, 0.2], 'bow_length': HELD}}, 'x')
    assert found.durations.recorded.length == (2.0, 30.0)
    assert found.durations.recorded.tolerance == RAW['xy_goal_tolerance']
