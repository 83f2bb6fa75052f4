"""The most orders on a net of lanes (bench/lane_bound.py), against nets whose answers are plain."""
import pathlib
import sys

import pytest

pytest.importorskip('scipy')
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / 'bench'))
import lane_bound  # noqa: E402

A, B = (0.0, 0.0), (10.0, 0.0)
THERE_AND_BACK = {A: {B: 1.0}, B: {A: 1.0}}


def most(tmp_path, edges, pairs=None, robots=50):
    """Return the most orders in 1,000 s on a net of A, B and C, at 1 m/s."""
    path = tmp_path / 'net.yaml'
    path.write_text('nodes: [{{name: A, x: 0.0, y: 0.0}}, {{name: B, x: 10.0, y: 0.0}}, {{name: C, x: 0.0, y: 10.0}}]\n'
                    'edges: {}\n'.format(edges))
    return lane_bound.most_orders(str(path), pairs or THERE_AND_BACK, robots, 1.0, 1000.0)


def test_one_lane_for_both_directions_is_full_after_its_time(tmp_path):
    assert most(tmp_path, '[{from: A, to: B, capacity: 1}]') == pytest.approx(50.0)
    assert most(tmp_path, '[{from: A, to: B, capacity: 3}]') == pytest.approx(150.0)


def test_without_capacities_robots_drive_all_the_time(tmp_path):
    assert most(tmp_path, '[{from: A, to: B}]', robots=7) == pytest.approx(350.0)


def test_flows_take_the_ways_round_as_far_as_that_is_better(tmp_path):
    lanes = '[{from: A, to: B, one_way: true, capacity: 1}, {from: B, to: A, capacity: 1}, ' \
            '{from: A, to: C, capacity: 1}, {from: C, to: B, capacity: 1}]'
    assert most(tmp_path, lanes, {A: {B: 1.0}}) == pytest.approx(200.0 + 1000.0 / 200.0 ** 0.5)
