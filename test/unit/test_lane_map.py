"""Files of lanes: ours and the topological maps of L-CAS, and what is wrong with one, in one line."""
import math
import os

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.maps.lane_map import make_lane_map, read_lane_map

LANES = os.path.abspath(os.path.join(os.path.dirname(__file__), '..', '..', 'config', 'lanes', 'farm_yard.yaml'))
NODES = [{'name': 'a', 'x': 0, 'y': 0}, {'name': 'b', 'x': 10, 'y': 0, 'yaw': 1.0}]
EDGE = {'from': 'a', 'to': 'b'}
TURNED = {'orientation': {'x': 0, 'y': 0, 'z': math.sqrt(0.5), 'w': math.sqrt(0.5)}}


def topological(**more):
    """Return a map in the format tmap2 as the topological navigation writes it, with what is not used here."""
    def node(name, x, y, edges):
        return {'meta': {'map': 'm', 'node': name, 'pointset': 'p'}, 'node': {
            'name': name, 'parent_frame': 'topo_map', 'properties': {'xy_goal_tolerance': 0.3}, 'edges': edges,
            'localise_by_topic': '', 'pose': {'position': {'x': x, 'y': y, 'z': 0.0}, **TURNED},
            'restrictions_planning': 'True', 'verts': [{'x': 0.3, 'y': 0.3}]}}

    def edge(to, *config):
        return {'action': 'move_base', 'edge_id': 'x_' + to, 'node': to, 'config': list(config), 'fail_policy': 'fail'}
    slow = {'namespace': '/DWAPlannerROS', 'name': 'max_vel_x', 'value': 0.3, 'reset': True}
    return {'meta': {'last_updated': 'today'}, 'metric_map': 'm', 'name': 'm', 'pointset': 'p',
            'nodes': [node('A', 1.0, 2.0, [edge('B', slow), edge('B')]), node('B', 4.0, 2.0, [edge('A')])], **more}


def test_nodes_and_edges_keep_the_order_of_the_file():
    lanes = make_lane_map({'nodes': NODES, 'edges': [
        {**EDGE, 'points': [[5, 5]], 'speed': 0.5, 'capacity': 2, 'one_way': True}]})
    assert list(lanes.nodes) == ['a', 'b'] and lanes.nodes['b'].yaw == 1.0
    edge, = lanes.edges
    assert (edge.begin, edge.end, edge.points) == ('a', 'b', ((0.0, 0.0), (5.0, 5.0), (10.0, 0.0)))
    assert (edge.speed, edge.capacity, edge.one_way, edge.share) == (0.5, 2, True, 1.0)


def test_a_length_says_how_much_slower_the_straight_line_is_driven():
    assert make_lane_map({'nodes': NODES, 'edges': [{**EDGE, 'length': 40}]}).edges[0].share == 0.25


def test_a_topological_map_is_lanes_that_lead_one_way_each():
    lanes = make_lane_map(topological())
    assert {name: (pose.x, pose.y) for name, pose in lanes.nodes.items()} == {'A': (1.0, 2.0), 'B': (4.0, 2.0)}
    assert lanes.nodes['A'].yaw == pytest.approx(math.pi / 2)
    assert [(edge.begin, edge.end, edge.speed, edge.one_way) for edge in lanes.edges] == [
        ('A', 'B', 0.3, True), ('B', 'A', None, True)]


def test_the_config_of_a_topological_map_of_early_2021_is_a_mapping_with_a_top_speed():
    early = topological()
    early['nodes'][0]['node']['edges'][0]['config'] = {'inflation_radius': 0.0, 'top_vel': 0.55}
    assert [edge.speed for edge in make_lane_map(early).edges] == [0.55, None]


def test_a_topological_map_in_a_frame_of_its_own_is_brought_into_its_parents():
    transformation = {'parent': 'map', 'child': 'topo_map', 'translation': {'x': 10.0, 'y': 0.0, 'z': 0.0},
                      'rotation': TURNED['orientation']}
    lanes = make_lane_map(topological(transformation=transformation))
    assert (lanes.nodes['A'].x, lanes.nodes['A'].y) == pytest.approx((8.0, 1.0))
    other = make_lane_map(topological(transformation={**transformation, 'child': 'another'}))
    assert (other.nodes['A'].x, other.nodes['A'].y) == (1.0, 2.0)


def test_a_map_of_strands_is_a_list_whose_edges_have_a_top_speed_and_whose_orientations_may_be_zeros(tmp_path):
    path = tmp_path / 'site.tmap'
    path.write_text("""- meta: {map: m, node: A, pointset: m}
  node:
    edges:
    - {action: move_base, edge_id: A_B, inflation_radius: 0.0, map_2d: m, node: B, top_vel: 0.55}
    - {action: dock, edge_id: A_B2, node: B, top_vel: 0.1}
    localise_by_topic: ''
    name: A
    pose: {orientation: {w: 0.0, x: 0.0, y: 0.0, z: 0.0}, position: {x: 1.0, y: 2.0, z: 0.0}}
    verts: [{x: 0.7, y: 0.3}]
- meta: {map: m, node: B, pointset: m}
  node:
    edges: [{action: move_base, edge_id: B_A, node: A, top_vel: -1.0}]
    name: B
    pose: {orientation: {w: 0.0, x: 0.0, y: 0.0, z: 1.0}, position: {x: 4.0, y: 2.0, z: 0.0}}
""")
    lanes = read_lane_map(str(path), 'here')
    assert {name: (pose.x, pose.y, pose.yaw) for name, pose in lanes.nodes.items()} == {
        'A': (1.0, 2.0, 0.0), 'B': (4.0, 2.0, pytest.approx(math.pi))}
    assert [(edge.begin, edge.end, edge.speed, edge.one_way) for edge in lanes.edges] == [
        ('A', 'B', 0.55, True), ('B', 'A', None, True)]


def test_a_map_of_strands_may_be_a_text(tmp_path):
    path = tmp_path / 'site.tmap'
    text = """node: \n\tA\n\twaypoint:\n\t\t1.0,2.5,0.0,0,0,0,0\n\tedges:\n\t\t B, dock\n\t\t B, move_base\n\tvertices:
\t\t0.69,0.287\n\t\t-0.69, 0.287\nnode: \n\tB\n\twaypoint:\n\t\t-4, 2,0,0,0,-1.0,0.0\n\tedges:\n\t\t A, undock\n"""
    path.write_text(text)
    lanes = read_lane_map(str(path), 'here')
    assert {name: (pose.x, pose.y, abs(pose.yaw)) for name, pose in lanes.nodes.items()} == {
        'A': (1.0, 2.5, 0.0), 'B': (-4.0, 2.0, pytest.approx(math.pi))}
    assert [(edge.begin, edge.end, edge.one_way) for edge in lanes.edges] == [('A', 'B', True), ('B', 'A', True)]
    path.write_text(text.replace('2.5', 'north'))
    with pytest.raises(ConfigurationError, match=r"site.tmap: nodes\[0\]: got .*'north' is no number"):
        read_lane_map(str(path), 'there')


def test_the_lanes_of_the_yard_ship():
    assert len(read_lane_map(LANES, 'here').nodes) == 11


@pytest.mark.parametrize(('raw', 'words'), [
    (3, ['got 3', 'nodes and edges']), ({'nodes': NODES}, ['nodes and edges']),
    ({'nodes': [], 'edges': []}, ['at least one']),
    ({'nodes': NODES, 'edges': [], 'egdes': []}, ['egdes', "did you mean 'edges'?"]),
    ({'nodes': [*NODES, NODES[0]], 'edges': []}, ['nodes[2]', "'a' is there twice"]),
    ({'nodes': [{'name': 'a', 'x': 0}], 'edges': []}, ['nodes[0]', 'y is missing']),
    ({'nodes': [{'name': '', 'x': 0, 'y': 0}], 'edges': []}, ['nodes[0]', 'name']),
    ({'nodes': [{'name': 'a', 'x': math.nan, 'y': 0}], 'edges': []}, ['nodes[0]', 'x: got nan']),
    ({'nodes': NODES, 'edges': [{'from': 'a', 'to': 'c'}]}, ['edges[0]', "to: got 'c'", 'the name of a node']),
    ({'nodes': NODES, 'edges': [{'from': 'a', 'to': 'a'}]}, ['edges[0]', 'two nodes']),
    ({'nodes': NODES, 'edges': [{**EDGE, 'sped': 1}]}, ['edges[0]', "did you mean 'speed'?"]),
    ({'nodes': NODES, 'edges': [{**EDGE, 'speed': 0}]}, ['edges[0]', 'speed: got 0']),
    ({'nodes': NODES, 'edges': [{**EDGE, 'capacity': 0.5}]}, ['edges[0]', 'capacity: got 0.5']),
    ({'nodes': NODES, 'edges': [{**EDGE, 'points': [[0, 0]]}]}, ['edges[0]', 'the same place twice']),
    ({'nodes': NODES, 'edges': [EDGE, {'from': 'b', 'to': 'a', 'one_way': True}]}, ['edges[1]', 'edges[0] leads']),
    (topological(nodes=[{'node': {'name': 'A'}}]), ['nodes[0]', 'not a node of a topological map', 'pose']),
    (topological(nodes=[*topological()['nodes'], {'node': 3}]), ['nodes[2]', 'not a node of a topological map']),
    (topological(nodes=topological()['nodes'][:1]), ['edges[0]', "to: got 'B'"]),
])
def test_lanes_that_cannot_be_are_refused_in_words(raw, words):
    with pytest.raises(ConfigurationError) as error:
        make_lane_map(raw, 'lanes.yaml')
    for word in ('lanes.yaml', *words):
        assert word in str(error.value)


def test_a_file_is_given_by_an_absolute_path(tmp_path):
    with pytest.raises(ConfigurationError, match="bot/lanes: got 'lanes.yaml'; allowed: an absolute path"):
        read_lane_map('lanes.yaml', 'bot')
    with pytest.raises(ConfigurationError, match='cannot be read: No such file'):
        read_lane_map(str(tmp_path / 'none.yaml'), 'bot')
