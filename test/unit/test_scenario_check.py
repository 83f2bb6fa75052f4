"""What `scenario check` finds: small worlds whose answers are known by hand or by networkx."""
import itertools
import json
import math
import random

import networkx
import numpy as np
import pytest
import yaml
from PIL import Image

from move_base_abstract.fleet import Dispatch, Fleet
from move_base_abstract.maps.map_files import write_map
from move_base_abstract.scenario import read_scenario
from move_base_abstract_worlds import command
from move_base_abstract_worlds.check import findings_of
from move_base_abstract_worlds.world import read_world

SQUARE = {'a': (0, 0), 'b': (10, 0), 'c': (10, 10), 'd': (0, 10)}


def world_file(folder, net=None, **scenario):
    """Write a scenario, and the net {'nodes': {name: (x, y)}, 'edges': [...]}; return its path."""
    if net is not None:
        nodes = [{'name': name, 'x': x, 'y': y} for name, (x, y) in net[0].items()]
        edges = [{'from': one[0], 'to': one[1], **(one[2] if len(one) > 2 else {})} for one in net[1]]
        (folder / 'net.yaml').write_text(yaml.safe_dump({'nodes': nodes, 'edges': edges}))
        scenario = {'lanes': 'net.yaml', **scenario}
        scenario['defaults'] = {'routes': 'lanes', 'max_speed': 1.0, **scenario.get('defaults', {})}
    scenario.setdefault('robots', [{'name': 'r'}])
    path = folder / 'scenario.yaml'
    path.write_text(yaml.safe_dump(scenario))
    return path


def map_file(folder, rows, resolution=1.0):
    """Write a map of text, '#' occupied, the first row in the north; return its path."""
    return write_map(str(folder), 'ground', np.array([[cell == '#' for cell in row] for row in rows]), resolution)


def found(path, map_path=None):
    return findings_of(read_world(path, map_path))


def names(path, map_path=None):
    return [(one.kind, one.name) for one in found(path, map_path)]


def ring(**lane):
    return SQUARE, [(one, other, {'one_way': True, **lane}) for one, other in zip('abcd', 'bcda')]


def test_nothing_is_found_where_nothing_is_wrong(tmp_path):
    assert names(world_file(tmp_path, ring())) == []
    assert names(world_file(tmp_path, (SQUARE, ['ab', 'bc', 'cd']), places=[{'name': 'p', 'x': 5.0}])) == []


def test_dead_ends_and_nodes_that_nobody_gets_to(tmp_path):
    one_way = {'one_way': True}
    net = SQUARE, [('a', 'b', one_way), ('b', 'a', one_way), ('b', 'c', one_way), ('d', 'a', one_way)]
    assert names(world_file(tmp_path, net)) == [('dead_end', 'node c'), ('unreachable', 'node d')]
    places = {**SQUARE, 'e': (20, 10)}
    net = places, [('a', 'b', one_way), ('b', 'c', one_way), ('c', 'e'), ('a', 'd')]
    assert names(world_file(tmp_path, net)) == [('dead_end', 'nodes c, e')]
    two = [{'name': 'r'}, {'name': 's', 'start_x': 10.0}]
    dead, *unreached = found(world_file(tmp_path, net, robots=two))
    assert dead.name == 'nodes c, e' and [one.name for one in unreached] == ['node a', 'node d']
    assert 'from the start of 1 of 2 robots (s)' in unreached[0].what
    assert unreached[0].where == 'net.yaml: nodes[0]'


@pytest.mark.parametrize('seed', range(20))
def test_any_net_is_judged_as_by_all_pairs_of_ways(tmp_path, seed):
    dice = random.Random(seed)
    nodes = {'n{}'.format(index): (float(index), float(dice.randrange(100))) for index in range(9)}
    pairs = sorted(dice.sample(list(itertools.combinations(nodes, 2)), 9))
    edges = [(one, other, {'one_way': dice.random() < 0.8}) for one, other in pairs]
    start = nodes['n0']
    path = world_file(tmp_path, (nodes, edges), robots=[{'name': 'r', 'start_x': start[0], 'start_y': start[1]}])
    graph = networkx.DiGraph([(one, other) for one, other, _ in edges]
                             + [(other, one) for one, other, lane in edges if not lane['one_way']])
    graph.add_nodes_from(nodes)
    reach = {one: {other for other in nodes if networkx.has_path(graph, one, other)} for one in nodes}
    stuck = {frozenset(reach[one]) for one in nodes if all(reach[other] == reach[one] for other in reach[one])
             and any(one in reach[other] for other in set(nodes) - reach[one])}
    findings = found(path)
    assert {one.name for one in findings if one.kind == 'unreachable'} == {
        'node ' + one for one in set(nodes) - reach['n0']}
    assert {frozenset(next(name for name in nodes if nodes[name] == point) for point in one.points)
            for one in findings if one.kind == 'dead_end'} == stuck


def test_what_lies_off_the_net(tmp_path):
    places = [{'name': 'on', 'x': 5.0}, {'name': 'off', 'x': 5.0, 'y': 3.0}]
    zones = [{'name': 'near', 'rectangle': [9, 9, 11, 11], 'charger': True},
             {'name': 'far', 'rectangle': [20, 20, 22, 22], 'charger': True}]
    off, charger = found(world_file(tmp_path, ring(), places=places, zones=zones))
    assert (off.name, charger.name, off.where) == ('place off', 'charger far', 'scenario.yaml: places[1]')
    assert 'lies 3.00 m from' in off.what
    assert 'lies {:.2f} m from'.format(math.hypot(11, 11)) in charger.what


WALLED = ('..........', '.....#....', '.....#....', '.....#....', '..........')


def test_robots_places_and_lanes_in_walls(tmp_path):
    ground = map_file(tmp_path, WALLED)
    robots = [{'name': 'in', 'start_x': 5.5, 'start_y': 2.5}, {'name': 'off', 'start_x': -1.0},
              {'name': 'at', 'start_x': 3.5, 'start_y': 2.5, 'robot_radius': 2.6}, {'name': 'ok', 'start_x': 0.5}]
    path = world_file(tmp_path, robots=robots, places=[{'name': 'p', 'x': 5.5, 'y': 1.5}, {'name': 'q', 'x': 9.5}])
    assert names(path, ground) == [('start_in_wall', 'in'), ('start_in_wall', 'off'), ('start_in_wall', 'at'),
                                   ('starts_overlap', 'at'), ('place_in_wall', 'place p')]
    nodes = {'a': (1.5, 2.5), 'b': (8.5, 2.5), 'c': (1.5, 0.5), 'd': (5.5, 3.5)}
    path = world_file(tmp_path, (nodes, ['ab', 'ac', 'cd']), robots=[{'name': 'r', 'start_x': 1.5, 'start_y': 0.5,
                                                                      'robot_radius': 0.3}])
    assert names(path, ground) == [('node_in_wall', 'node d'), ('node_in_wall', 'lane a - b'),
                                   ('node_in_wall', 'lane c - d')]


def test_where_the_map_leaves_no_way(tmp_path):
    ground = map_file(tmp_path, ['.....#....'] * 5)
    robots = [{'name': 'r', 'start_x': 2.5, 'start_y': 2.5}, {'name': 's', 'start_x': 8.5, 'start_y': 2.5}]
    path = world_file(tmp_path, robots=robots, defaults={'routes': 'grid', 'use_map': True, 'robot_radius': 0.3},
                      places=[{'name': 'p', 'x': 7.5, 'y': 2.5}])
    lost, = found(path, ground)
    assert (lost.kind, lost.name) == ('unreachable', 'place p')
    assert lost.what.startswith('cannot be reached by 1 of 2 robots (r): No way leads from (2.5, 2.5)')
    assert names(path) == [('not_checked', 'map')]


def test_robots_that_start_on_one_another(tmp_path):
    robots = [{'name': 'a', 'start_x': 5.0, 'robot_radius': 0.5}, {'name': 'b', 'start_x': 6.1, 'robot_radius': 0.5},
              {'name': 'c', 'start_x': 5.5, 'start_y': 0.8, 'robot_radius': 0.5}]
    one, = found(world_file(tmp_path, robots=robots))
    assert one.name == 'c' and 'on robot a' in one.what
    assert len(found(world_file(tmp_path, robots=[{'name': 'r', 'count': 1000}]))) == 999


def on_a_line(folder, charge, **more):
    """A robot 100 m from the charger, which has the charge [kJ] at the start, of 100 kJ."""
    battery = {'battery_capacity': 100e3 / 3600.0 / 12.0, 'battery_start': charge / 100.0, 'mass': 50.0,
               'friction_coefficient': 0.2, 'ambient_power': 10.0, 'max_speed': 2.0}
    return world_file(folder, defaults=battery, zones=[{'name': 'dock', 'rectangle': [99, -1, 101, 1],
                                                        'charger': True}], **more)


def test_chargers_that_nobody_reaches_with_the_charge_that_there_is(tmp_path):
    need = (50.0 * 2.0 ** 2 + 0.2 * 50.0 * 9.81 * 100.0 + 10.0 * 50.0) / 1e3  # m v^2 + f m g d + P t: 10.51 kJ
    assert found(on_a_line(tmp_path, need * 1.001)) == []
    charger, robot = found(on_a_line(tmp_path, need * 0.999))
    assert (charger.name, robot.name) == ('charger dock', 'r')
    assert 'takes 10.5 kJ' in charger.what
    for share, is_empty in ((1.001, False), (0.999, True)):  # and so it comes, by the battery itself
        fleet = Fleet(read_scenario(on_a_line(tmp_path, need * share)))
        fleet.robot('r').send(100.0, 0.0)
        fleet.run()
        assert fleet.robot('r').condition.battery.is_empty is is_empty


def test_a_place_that_is_too_far_from_any_charger(tmp_path):
    places = [{'name': 'near', 'x': 100.0, 'y': 400.0}, {'name': 'far', 'x': 100.0, 'y': 500.0}]
    assert names(on_a_line(tmp_path, 100.0, places=places)) == [('out_of_charge', 'place far')]


def test_orders_that_no_full_battery_is_enough_for(tmp_path):
    places = [{'name': name, 'x': 100.0, 'y': y} for name, y in (('near', 0.0), ('far', 400.0), ('north', -400.0))]
    orders = [{'name': 'short', 'every': 10.0, 'stops': [{'place': 'far'}]},
              {'name': 'long', 'every': 10.0, 'stops': [{'places': ['near', 'far']}, {'place': 'north'}]}]
    path = on_a_line(tmp_path, 100.0, places=places, orders=orders)
    one, = found(path)
    assert (one.kind, one.name, one.where) == ('out_of_charge', 'orders long', 'scenario.yaml: orders[1]')
    share = (3 * 50.0 * 2.0 ** 2 + 0.2 * 50.0 * 9.81 * 1600.0 + 10.0 * 800.0) / 100e3  # there, across and back
    assert one.what.endswith('takes {:.2f} of a full battery'.format(share))
    path.write_text(path.read_text() + 'dispatcher: {charge_reserve: 0.2}\n')
    assert [one.name for one in found(path)] == ['orders short', 'orders long']
    dispatch = Dispatch(read_scenario(path))  # and so it comes
    dispatch.run(until=2005.0)
    refused = [row.values[0] for row in dispatch.fleet.trace if row.kind == 'order_refused']
    for name, one in zip(('short', 'long'), found(path)):
        assert one.what.startswith('no robot can do {} of the first 200'.format(sum(name in one for one in refused)))
    assert found(on_a_line(tmp_path, 100.0, places=places, orders=orders, robots=[
        {'name': 'a'}, {'name': 'without', 'start_x': 5.0, 'battery_capacity': 0.0}])) == []


def locks(path):
    return [(one.name, int(one.what.split()[0])) for one in found(path) if one.kind == 'can_lock']


def test_a_ring_of_lanes_locks_with_as_many_robots_as_it_has_room_for(tmp_path):
    def of(count, capacity=1):
        return world_file(tmp_path, ring(capacity=capacity), robots=[
            {'name': 'r' + name, 'count': count, 'start_x': x, 'start_y': y, 'robot_radius': 0.0}
            for name, (x, y) in SQUARE.items()])
    assert locks(of(1)) == [('lane a - b', 4)]
    assert locks(of(1, capacity=2)) == []  # there are 4 robots, it takes 8
    assert locks(of(2, capacity=2)) == [('lane a - b', 8)]
    path = of(1)
    path.write_text(path.read_text() + 'deadlock: avoid\n')
    assert locks(path) == []
    fleet = Fleet(read_scenario(of(1)))  # and it does
    for name, goal in zip('abcd', 'cdab'):
        fleet.robot('r{}_0'.format(name)).send(*map(float, SQUARE[goal]))
    fleet.run()
    assert [entry.kind for entry in fleet.trace].count('deadlock') == 1


def test_two_lanes_in_both_directions_lock_with_two_and_one_after_the_other_never(tmp_path):
    line = {'a': (0, 0), 'b': (5, 0), 'c': (10, 0)}
    both = [{'name': 'r'}, {'name': 's', 'start_x': 10.0}]
    one_way = {'one_way': True, 'capacity': 1}
    assert locks(world_file(tmp_path, (line, [('a', 'b', {'capacity': 1}), ('b', 'c', {'capacity': 1})]),
                            robots=both)) == [('lane a - b', 2)]
    assert locks(world_file(tmp_path, (line, [('a', 'b', one_way), ('b', 'c', one_way)]), robots=both)) == []


def test_zones_lock_with_lanes_and_a_zone_around_all_cures_it(tmp_path):
    line = {'a': (0, 0), 'b': (5, 0), 'c': (10, 0)}
    both = [{'name': 'r'}, {'name': 's', 'start_x': 10.0}]
    zone = {'name': 'z', 'rectangle': [5, -1, 9, 1], 'capacity': 1}
    path = world_file(tmp_path, (line, [('a', 'b', {'capacity': 1}), ('b', 'c')]), robots=both, zones=[zone])
    assert locks(path) == [('zone z', 2)]
    fleet = Fleet(read_scenario(path))
    fleet.robot('r').send(10.0, 0.0)
    fleet.at(2_000_000_000, lambda fleet: fleet.robot('s').send(0.0, 0.0))
    fleet.run()
    assert [entry.kind for entry in fleet.trace].count('deadlock') == 1
    around = {'name': 'all', 'rectangle': [0, -2, 10, 2], 'capacity': 1}
    assert locks(world_file(tmp_path, (line, [('a', 'b', {'capacity': 1}), ('b', 'c')]), robots=both,
                            zones=[zone, around])) == []
    around['capacity'] = 2
    assert locks(world_file(tmp_path, (line, [('a', 'b', {'capacity': 1}), ('b', 'c')]), robots=both,
                            zones=[zone, around])) == [('zone z', 2)]


@pytest.mark.parametrize('seed', range(10))
def test_the_fewest_that_lock_are_those_of_the_least_circle_of_all(tmp_path, seed):
    dice = random.Random(seed)
    nodes = {'n{}'.format(index): (10.0 * (index % 3) + dice.random(), 10.0 * (index // 3) + dice.random())
             for index in range(6)}  # so that no two ways are equally long
    grid = [pair for pair in itertools.combinations(nodes, 2) if math.dist(nodes[pair[0]], nodes[pair[1]]) < 11.5]
    edges = [(*(pair if dice.random() < 0.5 else pair[::-1]), {'one_way': dice.random() < 0.6,
                                                               'capacity': dice.randint(1, 3)}) for pair in grid]
    graph = networkx.DiGraph()
    for number, (one, other, lane) in enumerate(edges):
        for begin, end in [(one, other)] + [(other, one)] * (not lane['one_way']):
            graph.add_edge(begin, end, lane=number, far=math.dist(nodes[begin], nodes[end]))
    far = dict(networkx.all_pairs_dijkstra_path_length(graph, weight='far'))
    arrows = networkx.DiGraph((graph[a][b]['lane'], graph[b][c]['lane']) for a, b in graph.edges for c in graph[b]
                              if c != a and math.isclose(far[a][c], graph[a][b]['far'] + graph[b][c]['far']))
    least = [min(sum(edges[number][2]['capacity'] for number in circle)
                 for circle in networkx.simple_cycles(arrows.subgraph(part)))
             for part in networkx.strongly_connected_components(arrows) if len(part) > 1]
    robots = [{'name': 'r', 'count': 12, 'robot_radius': 0.0, 'start_y': -5.0}]
    path = world_file(tmp_path, (nodes, edges), robots=robots)
    assert sorted(count for _, count in locks(path)) == sorted(count for count in least if count <= 12)


def test_goals_beyond_what_a_calibration_was_fitted_to(tmp_path):
    places = [{'name': 'near', 'x': 6.0}, {'name': 'far', 'x': 5000.0}]
    path = world_file(tmp_path, defaults={'calibration': 'move_base_dwa_stage'}, places=places)
    findings = [one for one in found(path) if one.name == 'place far']
    assert [one.kind for one in findings] == ['beyond_calibration']
    assert 'a way of 50' in findings[0].what


@pytest.fixture
def said(capsys):
    def run(*words):
        with pytest.raises(SystemExit) as end:
            command.main([str(word) for word in words])
        output = capsys.readouterr()
        return end.value.code, output.out, output.err
    return run


def test_the_command_says_it_and_writes_it(tmp_path, said):
    path = world_file(tmp_path, ring(), places=[{'name': 'off', 'x': 5.0, 'y': 3.0}])
    for _ in range(2):  # the second time in the place of its own
        code, out, _ = said('check', path, '--picture', tmp_path / 'p.png', '--json', tmp_path / 'f.json')
        assert code == 1 and 'place off' in out and 'where: scenario.yaml: places[0]' in out
    finding, = json.loads((tmp_path / 'f.json').read_text())['findings']
    assert finding['kind'] == 'off_net' and finding['points'] == [[5.0, 3.0]]
    assert said('check', path, '--json', '-')[1] == (tmp_path / 'f.json').read_text()
    assert Image.open(tmp_path / 'p.png').size[0] > 600
    assert said('check', world_file(tmp_path, ring()))[0] == 0


def test_the_command_replaces_nothing_that_it_did_not_make(tmp_path, said):
    path = world_file(tmp_path, ring())
    for option, name in (('--json', 'f.json'), ('--picture', 'p.png')):
        (tmp_path / name).write_bytes(b'\x89PNG\r\n mine')
        code, _, err = said('check', path, option, tmp_path / name)
        assert code == 2 and 'did not make it' in err
        assert (tmp_path / name).read_bytes() == b'\x89PNG\r\n mine'


@pytest.mark.parametrize('text', [
    '', '[]', 'robots: 7', 'robots: [{name: r, count: 0}]', '\x00', 'robots: [{name: r}', 'lanes: nowhere.yaml\n'
    'defaults: {routes: lanes}\nrobots: [{name: r}]'])
def test_what_is_no_scenario_is_refused(tmp_path, said, text):
    (tmp_path / 'bad.yaml').write_text(text)
    code, _, err = said('check', tmp_path / 'bad.yaml')
    assert code == 2 and err.startswith('scenario: ') and 'Traceback' not in err
    assert said('check', tmp_path / 'none.yaml')[0] == 2


def test_a_scenario_without_robots_or_of_huge_numbers_is_judged_all_the_same(tmp_path, said):
    assert said('check', world_file(tmp_path, robots=[]), '--picture', tmp_path / 'p.png')[0] == 0
    path = world_file(tmp_path, robots=[{'name': 'r', 'start_x': 1e9, 'start_y': -1e9}, {'name': 's'}],
                      places=[{'name': 'p', 'x': 1e9}], defaults={'battery_capacity': 1e9},
                      zones=[{'name': 'z', 'rectangle': [-1e9, -1e9, 1e9, 1e9], 'charger': True, 'capacity': 1}])
    assert said('check', path, '--picture', tmp_path / 'p.png')[0] in (0, 1)
