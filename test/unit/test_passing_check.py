"""What `scenario check` says of places that bar ways, and of robots that cannot pass each other."""
import pytest
import yaml

from move_base_abstract_worlds.check import findings_of
from move_base_abstract_worlds.world import read_world

NODES = {'A': (0, 0), 'J': (10, 0), 'K': (20, 0), 'B': (30, 0), 'S': (10, 5), 'T': (10, 5.005)}
CORRIDOR = ['AJ', 'JK', 'KB']


def found(folder, lanes, robots, node_capacity=1, **more):
    """Return [(kind, name, points), ...] of the findings about passing."""
    used = [name for name in NODES if any(name in lane for lane in lanes)]
    (folder / 'net.yaml').write_text(yaml.safe_dump({
        'nodes': [{'name': name, 'x': NODES[name][0], 'y': NODES[name][1]} for name in used],
        'edges': [{'from': begin, 'to': end, 'capacity': 1} for begin, end in lanes],
        **({} if node_capacity is None else {'node_capacity': node_capacity})}))
    (folder / 'scenario.yaml').write_text(yaml.safe_dump({
        'lanes': 'net.yaml', 'deadlock': 'avoid', 'defaults': {'routes': 'lanes', 'max_speed': 1.0},
        'robots': [{'name': f'r_{node}', 'start_x': NODES[node][0], 'start_y': NODES[node][1]} for node in robots],
        **more}))
    return [(one.kind, one.name, one.points) for one in findings_of(read_world(folder / 'scenario.yaml'))
            if one.kind in ('bars_ways', 'cannot_pass', 'not_checked')]


def test_two_robots_in_a_corridor_without_a_siding_cannot_pass(tmp_path):
    assert found(tmp_path, CORRIDOR, 'AB') == [('cannot_pass', 'robots r_A and r_B', ((0.0, 0.0), (30.0, 0.0)))]


@pytest.mark.parametrize('lanes, capacity', [([*CORRIDOR, 'JS'], 1), (CORRIDOR, 2), (CORRIDOR, None)])
def test_with_a_siding_or_with_room_at_the_nodes_they_can(lanes, capacity, tmp_path):
    assert found(tmp_path, lanes, 'AB', capacity) == []


def test_where_two_nodes_are_at_one_point_it_is_not_checked(tmp_path):
    assert [one[:2] for one in found(tmp_path, [*CORRIDOR, 'JS', 'JT'], 'AB')] == [('not_checked', 'robots that pass')]


def test_zones_count_as_the_places_of_nodes(tmp_path):
    zones = [{'name': name, 'capacity': 1, 'rectangle': [x - 2, y - 2, x + 2, y + 2]}
             for name, (x, y) in NODES.items() if name != 'S']
    assert [one[:2] for one in found(tmp_path, CORRIDOR, 'AB', None, zones=zones)] == [
        ('cannot_pass', 'robots r_A and r_B')]


def test_a_place_on_the_only_way_between_two_others_bars_it(tmp_path):
    lanes = [*CORRIDOR, 'JS']
    places = [{'name': 'work', 'x': 20.0, 'y': 0.0}]
    assert found(tmp_path, lanes, 'AB', places=places) == [('bars_ways', 'node K', ((20.0, 0.0),))]
    assert found(tmp_path, [*lanes, 'SB'], 'AB', places=places) == []
    places = [{'name': 'work', 'x': 10.0, 'y': 5.0}]
    assert found(tmp_path, lanes, 'AB', places=places) == []
