"""What is large: ways that are kept, open orders, event logs, images, nets of lanes. Each is linear, or has a limit."""
import json
import resource
import subprocess
import sys

import pytest
import yaml
from night import times
from PIL import Image

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.map_files import read_pixels
from move_base_abstract.fleet import Dispatch
from move_base_abstract.maps.kept import LEAST, Kept
from move_base_abstract.maps.lane_map import make_lane_map
from move_base_abstract.maps.lane_planner import LaneWays
from move_base_abstract.orders import dispatcher
from move_base_abstract.runs import ends, event_log
from move_base_abstract.scenario import make_scenario
from move_base_abstract_worlds.check import findings_of
from move_base_abstract_worlds.world import read_world

#: MB per simulated hour by which a fleet with all parts may grow once it has driven for a while
MOST_GROWTH = 0.5
SOAK = """
import gc, sys
from move_base_abstract.fleet import Dispatch
from move_base_abstract.scenario import read_scenario

dispatch = Dispatch(read_scenario(sys.argv[1]), trace=None)
for hour in (int(hour) for hour in sys.argv[2:]):
    dispatch.run(until=3600.0 * hour)
    gc.collect()
    with open('/proc/self/statm') as status:
        print(hour, int(status.read().split()[1]) * 4096 / 1e6, flush=True)
"""


def net(rows, columns, **lane):
    nodes = [{'name': '{} {}'.format(row, column), 'x': 2.5 * column, 'y': 2.5 * row}
             for row in range(rows) for column in range(columns)]
    names = {node['name'] for node in nodes}
    edges = [{'from': '{} {}'.format(row, column), 'to': to, **lane} for row in range(rows) for column in range(columns)
             for to in ('{} {}'.format(row, column + 1), '{} {}'.format(row + 1, column)) if to in names]
    return {'nodes': nodes, 'edges': edges}


def written(path, content):
    path.write_text(json.dumps(content))
    return str(path)


def everything(path, robots):
    """Return a scenario with all parts, whose orders lead anywhere."""
    return {
        'seed': 1, 'deadlock': 'abort', 'dispatcher': {'charge_below': 0.3},
        'defaults': {
            'max_speed': 2.0, 'acceleration': 1.0, 'duration_distribution': 'gamma', 'duration_cv': 0.3,
            'failure_by_length': [[0.0, 0.01]], 'failure_kind': 'stall', 'failures_per_hour': 6.0, 'repair_time': 20.0,
            'battery_capacity': 1000.0, 'battery_thresholds': [0.5, 0.2], 'routes': 'lanes', 'lanes': path},
        'robots': [{'name': 'robot', 'count': robots, 'start_x': 4.0, 'start_y': 4.0, 'step_y': 1.5}],
        'zones': [{'name': 'gate', 'rectangle': [25.0, 15.0, 35.0, 25.0], 'capacity': 10},
                  {'name': 'dock', 'rectangle': [2.0, 2.0, 6.0, 38.0], 'charger': 20.0}],
        'places': [{'name': 'bay', 'x': 30.0, 'y': 4.0, 'duration': 5.0, 'reach': 1000.0}],
        'orders': [{'name': 'picks', 'rate_per_hour': 1200.0, 'deadline': 600.0, 'stops': [
            {'area': [5.0, 19.0, 55.0, 21.0]}, {'place': 'bay', 'action': 'load'}, {'area': [5.0, 35.0, 55.0, 37.0]}]}]}


def test_what_is_kept_is_bounded_by_its_size_and_found_again():
    asked = []
    kept = Kept(lambda key: asked.append(key) or 'x' * key, len, 10 * LEAST)
    for key in (1, 2, 1, 9 * LEAST, 1, 2, 100 * LEAST, 1):
        assert len(kept(key)) == key
    assert asked == [1, 2, 9 * LEAST, 2, 100 * LEAST, 1]
    assert len(kept) == 1 and kept.size == LEAST


def test_ways_over_long_lanes_are_kept_up_to_a_number_of_corners():
    count = 20_000
    ways = LaneWays(make_lane_map({
        'nodes': [{'name': 'a', 'x': 0.0, 'y': 0.0}, {'name': 'b', 'x': 1.0 * count, 'y': 0.0}],
        'edges': [{'from': 'a', 'to': 'b', 'points': [[1.0 * x, x % 2] for x in range(1, count)]}]}), 1.0)
    for y in range(10):
        assert len(ways.way((0.0, 0.0), (1.0 * count, 1.0 + y))) > count - 10
    assert len(ways._found) <= 3


@pytest.mark.night
def test_a_fleet_with_all_parts_grows_by_no_more_than_a_bound(tmp_path):
    path = written(tmp_path / 'scenario.yaml', everything(written(tmp_path / 'net.yaml', net(25, 40, capacity=2)), 20))
    done = subprocess.run([sys.executable, '-c', SOAK, path, '8', '32'], check=True, stdout=subprocess.PIPE, text=True)
    (begin, before), (end, after) = (map(float, line.split()) for line in done.stdout.splitlines())
    growth = (after - before) / (end - begin)
    print('{:.1f} MB after {:g} h, {:.1f} MB after {:g} h: {:.3f} MB per simulated hour'.format(
        before, begin, after, end, growth))
    assert growth < MOST_GROWTH


def test_many_open_orders_cost_as_much_each_as_few(monkeypatch):
    looked, turn = [], dispatcher._turn
    monkeypatch.setattr(dispatcher, '_turn', lambda one: looked.append(one) or turn(one))
    dispatch = Dispatch(make_scenario({
        'robots': [{'name': 'bot', 'max_speed': 1.0}], 'dispatcher': {},
        'orders': [{'name': 'o', 'every': 1e-3, 'count': 3000, 'priority': 1, 'stops': [{'x': 1.0}]},
                   {'name': 'p', 'every': 1e-3, 'count': 3, 'priority': 2, 'stops': [{'x': 1.0}]}]}))
    dispatch.run()
    done = [entry.values[0] for entry in dispatch.fleet.trace if entry.kind == 'order_done']
    assert done == ['p_1', 'p_2', 'p_3'] + ['o_{}'.format(n) for n in range(1, 3001)]
    assert len(looked) == 2 * 3003  # when it comes, and when it is assigned


def test_of_a_long_log_only_the_lines_about_ends_are_understood(tmp_path, monkeypatch):
    path = tmp_path / 'run.jsonl'
    rows = ['{"time_ns":%d,"robot":"bot","kind":"arrived","values":[1.5]}\n' % n for n in range(1000)]
    rows[7] = '{"time_ns":7,"robot":"/node","kind":"uncaught","values":["KeyError: 1","callback"]}\n'
    end = {'events': 1000, 'repeatable': True, 'not_repeatable_because': [], 'degraded_because': [], 'departures': [
        {'node': '/node', 'time_ns': 8, 'died': True}]}
    path.write_text('{"event_log":1}\n' + ''.join(rows) + json.dumps({'end': end}, separators=(',', ':')) + '\n')
    understood = []
    plain = json.loads
    monkeypatch.setattr(event_log.json, 'loads', lambda text: understood.append(text) or plain(text))
    log = ends.read_log(str(path))
    assert log.is_whole and log.departures == {'/node': (8, True)}
    assert log.uncaught == {'/node': [(7, 'KeyError: 1 in callback')]} and len(understood) == 3


@pytest.mark.parametrize('mode, most', [('L', 3), ('P', 6), ('RGB', 9), ('RGBA', 10)])
def test_a_small_file_of_a_large_image_takes_few_bytes_a_pixel(tmp_path, mode, most):
    side = times(3000, 9000)
    Image.new(mode, (side, side)).save(tmp_path / 'map.png')
    program = 'import resource, sys\nfrom move_base_abstract.common.map_files import read_pixels\n' \
        'before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\nread_pixels(sys.argv[1])\n' \
        'print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)'
    took = subprocess.run([sys.executable, '-W', 'ignore', '-c', program, str(tmp_path / 'map.png')], check=True,
                          stdout=subprocess.PIPE).stdout
    assert int(took) * 1024 < most * side ** 2 + 2 ** 22


def test_an_image_of_too_many_pixels_is_refused_before_it_is_decoded(tmp_path):
    Image.new('1', (11600, 11600)).save(tmp_path / 'map.png')
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ConfigurationError, match=r'too large: got 11600 x 11600 pixels; allowed: 134217728 in all'):
        read_pixels(tmp_path / 'map.png')
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 60_000  # kB


def test_capacities_of_a_large_net_are_not_checked_and_that_is_said(tmp_path):
    path = written(tmp_path / 'net.yaml', net(40, 40, capacity=1))
    scenario = tmp_path / 'scenario.yaml'
    scenario.write_text(yaml.safe_dump({'lanes': path, 'defaults': {'routes': 'lanes'}, 'robots': [
        {'name': 'a'}, {'name': 'b', 'start_x': 2.5}]}))
    assert [finding.what for finding in findings_of(read_world(str(scenario))) if finding.kind == 'not_checked'] == [
        'the net has 3120 lanes; capacities are checked on at most 3000']
