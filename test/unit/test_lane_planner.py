"""Ways along lanes: the shortest in time, to the net and from it, and robots that drive them."""
import json
import random
from pathlib import Path

import networkx
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.lane_map import make_lane_map
from move_base_abstract.maps.lane_planner import LaneWays
from move_base_abstract.maps.priced_ways import times_to
from move_base_abstract.scenario import make_scenario, read_scenario
from traces import leg_of

S = 1_000_000_000
LANES = Path(__file__).resolve().parents[2] / 'config' / 'lanes' / 'farm_yard.yaml'
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'
PLACES = {'a': (0, 0), 'b': (10, 0), 'c': (10, 10), 'd': (0, 10)}
NODES = [{'name': name, 'x': x, 'y': y} for name, (x, y) in PLACES.items()]


def net(*edges):
    """Return what is in a file of lanes; an edge is 'ab', or ('ab', {key: value})."""
    pairs = [(edge, {}) if isinstance(edge, str) else edge for edge in edges]
    return {'nodes': NODES, 'edges': [{'from': pair[0], 'to': pair[1], **more} for pair, more in pairs]}


def ways(*edges, speed=1.0):
    return LaneWays(make_lane_map(net(*edges)), speed)


RING = 'ab', 'bc', 'cd', 'da'


@pytest.fixture
def fleet_on(tmp_path):
    """Return a function that makes a Fleet of one robot, 'bot', at a on lanes."""
    def make(*edges, **settings):
        path = tmp_path / 'lanes.yaml'
        path.write_text(json.dumps(net(*edges)))
        (tmp_path / 'scenario.yaml').write_text(json.dumps({
            'lanes': 'lanes.yaml', 'defaults': {'routes': 'lanes', 'max_speed': 2.0, **settings},
            'robots': [{'name': 'bot'}]}))
        return Fleet(read_scenario(tmp_path / 'scenario.yaml'), start_ns=0)
    return make


def ended(fleet):
    return fleet.trace[-1].time_ns / S, fleet.trace[-1].values[1:]


@pytest.mark.parametrize(('start', 'goal', 'corners', 'lanes'), [
    ((0, 0), (10, 0), (), (0,)),
    ((0, 0), (10, 10), ((10, 0),), (0, 1)),  # as long as by d, which comes later in the file
    ((10, 10), (0, 0), ((10, 0),), (1, 0)),
    ((0, 0), (10, 13), ((10, 0), (10, 10)), (0, 1, None)),  # off the net straight, from the node that is nearest
    ((-2, 1), (10, 0), ((0, 0),), (None, 0)),
    ((4, 0), (10, 3), ((10, 0),), (0, 1)),  # both on lanes
    ((4, 0), (7, 0), (), (0,)), ((7, 0), (4, 0), (), (0,)),
    ((5, -2), (1, 0), ((0, 0),), (None, 0)),  # as near to a as to b
    ((3, 0), (3, 0.005), (), ()),
])
def test_the_way_over_the_ring(start, goal, corners, lanes):
    way = ways(*RING).way(start, goal)
    assert (way, way.lanes) == (corners, lanes)


def test_the_shortest_way_takes_the_least_time():
    slow = ways(('ab', {'speed': 0.4}), 'bc', 'cd', 'da')
    assert slow.way((0, 0), (10, 10)) == ((0, 10),)
    assert slow.way((0, 0), (10, 0)) == ()  # 25 s, 30 s the other way round
    assert ways(('ab', {'length': 31}), 'bc', 'cd', 'da').way((0, 0), (10, 0)) == ((0, 10), (10, 10))
    assert ways(('ab', {'speed': 0.4}), 'bc', 'cd', 'da', speed=0.3).way((0, 0), (10, 10)) == ((10, 0),)


def test_one_way_lanes_are_driven_one_way_also_from_their_middle():
    one_way = ways(('ab', {'one_way': True}), 'bc', 'cd', 'da')
    assert one_way.way((10, 0), (0, 0)) == ((10, 10), (0, 10))
    assert one_way.way((7, 0), (4, 0)) == ((10, 0), (10, 10), (0, 10), (0, 0))
    assert one_way.way((4, 0), (7, 0)) == ()


def test_the_points_of_a_lane_are_corners_in_both_directions():
    bent = ways(('ab', {'points': [[3, -4], [7, -4]]}))
    assert bent.way((0, 0), (10, 0)) == ((3, -4), (7, -4)) and bent.way((10, 0), (0, 0)) == ((7, -4), (3, -4))
    assert bent.way((5, -4), (10, 0)) == ((7, -4),) and bent.way((5, -4), (0, 0)) == ((3, -4),)


def test_where_no_lanes_lead_there_is_no_way():
    assert ways('ab').way((0, 0), (10, 10)) is None
    assert ways().way((0, 0), (10, 10)) is None
    assert ways().way((1, 0), (0, 1)) == ((0, 0),)


def test_ways_do_not_depend_on_what_was_asked_before():
    pairs = [((x, 0.5), (10.2, y)) for x in (0, 3, 8) for y in (0, 5, 11)]
    together = ways(*RING)
    assert [together.way(*pair) for pair in pairs] == [ways(*RING).way(*pair) for pair in reversed(pairs)][::-1]


# ---- robots

def test_the_times_to_a_node_are_those_of_networkx():
    chance = random.Random(3)
    for _ in range(20):
        count = chance.randrange(1, 30)
        graph = networkx.DiGraph()
        graph.add_nodes_from(range(count))
        graph.add_weighted_edges_from((chance.randrange(count), chance.randrange(count), chance.randrange(1, 9))
                                      for _ in range(3 * count))
        arriving = [[(begin, lane['weight']) for begin, _, lane in graph.in_edges(node, data=True)]
                    for node in range(count)]
        times = times_to(arriving, 0)
        assert {node: time for node, time in enumerate(times) if time is not None} == (
            networkx.single_source_dijkstra_path_length(graph.reverse(), 0))


def test_a_robot_drives_the_lanes(fleet_on):
    fleet = fleet_on(*RING)
    fleet.robot('bot').send(10, 10)
    assert leg_of(fleet).corners == ((10.0, 0.0),)
    fleet.run()
    assert ended(fleet) == (10.0, ('SUCCEEDED', 'Goal reached.'))


@pytest.mark.parametrize(('law', 'seconds'), [
    # to 2 m/s and back to 1 m/s: 2 + 1.5 m; 10 m at 1 m/s, of which the last 0.5 m in 1 s
    ('keep', 2.0 + 6.5 / 2.0 + 1.0 + 9.5 + 1.0), ('stop', 7.0 + 11.0)])
def test_each_piece_has_its_own_speed(fleet_on, law, seconds):
    fleet = fleet_on('ab', ('bc', {'speed': 1.0}), acceleration=1.0, corners=law)
    fleet.robot('bot').send(10, 10)
    fleet.run()
    assert ended(fleet)[0] == pytest.approx(seconds)


def test_a_length_is_how_long_it_takes(fleet_on):
    fleet = fleet_on(('ab', {'length': 25}))
    fleet.robot('bot').send(10, 0)
    fleet.run()
    assert (ended(fleet)[0], fleet.robot('bot').distance) == (12.5, 10.0)


def test_the_scenario_that_ships_drives_on_lanes_and_waits_at_the_crossing():
    fleet = Fleet(read_scenario(LANES.parents[1] / 'lanes_scenario.yaml'))
    for name, place in zip(fleet.names, ((43, 11), (43, 11), (56, 4), (4, 4), (4, 36))):
        fleet.robot(name).send(*place)
    fleet.run()
    assert {entry.values[1] for entry in fleet.trace if entry.kind == 'ended'} == {'SUCCEEDED'}
    assert [entry.values for entry in fleet.trace if entry.kind == 'held']


def test_a_goal_without_lanes_ends_with_upstreams_text(fleet_on):
    fleet = fleet_on('ab')
    fleet.robot('bot').send(10, 10)
    assert ended(fleet) == (0.0, ('ABORTED', NO_PLAN))


def test_a_robot_that_was_stopped_on_a_lane_goes_on_along_it(fleet_on):
    fleet = fleet_on(('ab', {'one_way': True}), 'bc', 'cd', 'da')
    fleet.robot('bot').send(10, 10)
    fleet.run(4 * S)
    fleet.robot('bot').hold('test')
    fleet.robot('bot').release('test')
    fleet.run()
    assert (ended(fleet)[0], fleet.robot('bot').distance) == (10.0, 20.0)


def test_what_does_not_fit_lanes_is_refused(fleet_on):
    with pytest.raises(ConfigurationError, match="got 'matrix' without travel_matrix"):
        fleet_on('ab', routes='matrix')
    calibrated = {'lanes': str(LANES), 'defaults': {'routes': 'lanes', 'calibration': 'move_base_dwa_stage'},
                  'robots': [{'name': 'bot'}]}
    with pytest.raises(ConfigurationError, match='neither speed nor length'):
        make_scenario(calibrated)
    with pytest.raises(ConfigurationError, match="routes: got 'lanes' without lanes"):
        make_scenario({'defaults': {'routes': 'lanes'}, 'robots': [{'name': 'bot'}]})
