"""Ways out of jams (deadlock: avoid): the exact search over joint places, and robots that drive by its moves."""
import collections
import json

import pytest

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario
from move_base_abstract.traffic import ways_out
from move_base_abstract.traffic.joint_search import Net, TooManyStates, find_most, find_moves
from tiny_nets import instance, is_solvable
from traces import rows

SIDING = {'A': (0, 0), 'J': (10, 0), 'K': (20, 0), 'B': (30, 0), 'S': (10, 5)}
LANES = [('A', 'J'), ('J', 'K'), ('K', 'B'), ('J', 'S')]


def net_of(nodes, edges, room=1):
    """Return the Net of nodes and edges with ``room`` robots on each."""
    steps = {node: {} for node in nodes}
    for begin, end in edges:
        steps[begin][end] = steps[end][begin] = ((begin, end),)
    return Net({node: (node,) for node in nodes}, steps, dict.fromkeys([*nodes, *edges], room))


@pytest.mark.parametrize('seed', range(200))
def test_the_search_finds_moves_exactly_where_trying_all_joint_places_does(seed):
    one = instance(seed)
    net = net_of(one.nodes, one.edges)
    begin = tuple(start for start, _ in one.robots.values())
    wanted = [goal for _, goal in one.robots.values()]
    moves = find_moves(net, begin, wanted)
    assert (moves is not None) == is_solvable(one, stays=False)
    joint = list(begin)
    for robot, place in moves or ():
        assert place in net.steps[joint[robot]]
        assert place not in joint
        joint[robot] = place
    assert moves is None or joint == wanted


def test_the_search_takes_the_fewest_moves_and_gives_up_when_it_has_looked_at_too_much():
    net = net_of(SIDING, LANES)
    assert len(find_moves(net, ('A', 'B'), ['B', 'A'])) == 8
    assert len(find_moves(net_of(SIDING, LANES, room=2), ('A', 'B'), ['B', 'A'])) == 6
    assert find_moves(net, ('A', 'B'), ['B', None]) == [(1, 'K'), (1, 'J'), (1, 'S'), (0, 'J'), (0, 'K'), (0, 'B')]
    with pytest.raises(TooManyStates):
        find_moves(net, ('A', 'B'), ['B', 'A'], most=3)


@pytest.fixture
def fleet_of(tmp_path):
    """Return a function that makes a Fleet on the corridor A - J - K - B with the siding S; one robot on each lane."""
    def make(robots, nodes=SIDING, edges=LANES, one_at_nodes=True, one_way=(), **more):
        (tmp_path / 'net.yaml').write_text(json.dumps({
            'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in nodes.items()],
            'edges': [{'from': begin, 'to': end, 'capacity': 1, 'one_way': f'{begin} - {end}' in one_way}
                      for begin, end in edges],
            **({'node_capacity': 1} if one_at_nodes else {})}))
        return Fleet(make_scenario({
            'lanes': str(tmp_path / 'net.yaml'), 'deadlock': 'avoid', 'defaults': {'routes': 'lanes', 'max_speed': 1.0},
            'robots': [{'name': name, 'start_x': nodes[node][0], 'start_y': nodes[node][1]} for name, node in robots],
            **more}))
    return make


ZONES = [{'name': 'zA', 'rectangle': [-2, -2, 2, 2], 'capacity': 1},
         {'name': 'zB', 'rectangle': [28, -2, 32, 2], 'capacity': 1}]


@pytest.mark.parametrize('at_nodes', [True, False])
@pytest.mark.parametrize('names', ['ab', 'ba'])
def test_two_robots_exchange_the_ends_of_a_corridor_with_a_siding_again_and_again(fleet_of, at_nodes, names):
    fleet = fleet_of(zip(names, 'AB'), one_at_nodes=at_nodes, zones=[] if at_nodes else ZONES)
    to, done, seen = dict(zip(names, (30.0, 0.0))), collections.Counter(), 0
    for name, x in to.items():
        fleet.robot(name).send(x, 0.0)
    while min(done['a'], done['b']) < 20 and fleet.now < 4000.0:
        fleet.run_for(1.0)
        new, seen = fleet.trace[seen:], len(fleet.trace)
        for name, state in [(one.robot, one.values[1]) for one in new if one.kind == 'ended']:
            assert state == 'SUCCEEDED'
            done[name] += 1
            to[name] = 30.0 - to[name]
            fleet.robot(name).send(to[name], 0.0)
    assert min(done['a'], done['b']) == 20
    assert not rows(fleet, 'deadlock')


def test_a_robot_lets_the_others_through_before_it_stays_in_their_way(fleet_of):
    """J is the goal of a, and all others have to pass there: a comes to its goal when they have."""
    fleet = fleet_of([('a', 'S'), ('b', 'A')])
    fleet.robot('a').send(10.0, 0.0)
    fleet.robot('b').send(30.0, 0.0)
    fleet.run()
    assert [row[1] for row in rows(fleet, 'ended')] == ['a', 'b']
    assert all(row[4] == 'SUCCEEDED' for row in rows(fleet, 'ended'))
    assert rows(fleet, 'ended')[0][0] > max(row[0] for row in rows(fleet, 'left') if row[1:] == ('b', 'left', 'node J'))


def test_moves_end_when_a_robot_is_cancelled_and_begin_anew_without_it(fleet_of):
    fleet = fleet_of([('a', 'A'), ('b', 'B')])
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.run_for(12.0)  # a is on its way into the siding
    fleet.robot('a').cancel()
    fleet.run_for(60.0)
    fleet.robot('a').send(30.0, 0.0)
    fleet.run()
    assert sorted(row[1:5:3] for row in rows(fleet, 'ended')) == [
        ('a', 'PREEMPTED'), ('a', 'SUCCEEDED'), ('b', 'SUCCEEDED')]


def test_robots_that_cannot_pass_are_named_once_and_both_wait(fleet_of):
    fleet = fleet_of([('a', 'A'), ('b', 'B')], {key: SIDING[key] for key in 'AJKB'}, LANES[:3])
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.run()
    told = [one for one in fleet.warnings if one.text.startswith('There is no order of moves')]
    assert [(one.robot, one.time_ns) for one in told] == [('a', 1_000_000_000)]
    assert 'a to B, b to A' in told[0].text
    assert not rows(fleet, 'ended')
    assert told[0].text.endswith(' Held until that changes: a, b.')
    assert [row[1:] for row in rows(fleet, 'deadlock')] == [('b', 'deadlock', 'a', 'lane A - J', 'b', 'lane K - B')]
    assert [row[1:] for row in rows(fleet, 'entered')] == [('a', 'entered', 'node A'), ('b', 'entered', 'node B')]


CROSS = {'A': (0, 0), 'J': (10, 0), 'B': (20, 0), 'C': (10, -10), 'D': (10, 10)}
#: that J - D is one way makes D a place that a robot must not make way to
CROSSING = [('A', 'J'), ('J', 'B'), ('C', 'J'), ('J', 'D')]


@pytest.mark.parametrize('later', [1.0, 50.0])
def test_robots_without_a_way_are_held_where_they_do_not_bar_that_of_others(fleet_of, later):
    fleet = fleet_of([('a', 'A'), ('b', 'B'), ('c', 'C')], CROSS, CROSSING, one_way=['J - D', 'C - J'])
    fleet.robot('a').send(20.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.run(until=later)
    fleet.robot('c').send(10.0, 10.0)
    fleet.run()
    assert [row[1::3] for row in rows(fleet, 'ended')] == [('c', 'SUCCEEDED')]
    assert [(pose.x, pose.y) for pose in (robot.navigator.robot.pose_at(fleet.now_ns) for robot in fleet.robots)] == [
        (0.0, 0.0), (20.0, 0.0), (10.0, 10.0)]
    assert rows(fleet, 'deadlock')[-1][1:] == ('b', 'deadlock', 'a', 'lane A - J', 'b', 'lane J - B')


def test_robots_that_were_held_go_on_when_there_is_a_way_again(fleet_of):
    fleet = fleet_of([('a', 'A'), ('b', 'B'), ('c', 'C')], CROSS, CROSSING)
    fleet.robot('a').send(20.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.robot('c').send(10.0, 0.0)
    fleet.run_for(5.0)
    fleet.robot('c').cancel()
    fleet.run()
    assert sorted(row[1:5:3] for row in rows(fleet, 'ended')) == [
        ('a', 'SUCCEEDED'), ('b', 'SUCCEEDED'), ('c', 'PREEMPTED')]


def test_a_robot_that_makes_way_keeps_a_way_to_its_goal():
    steps = {'A': {'J': ()}, 'J': {'A': (), 'B': (), 'D': ()}, 'B': {'J': ()}, 'D': {}}
    net = Net({node: (node,) for node in steps}, steps, dict.fromkeys(steps, 1))
    assert find_moves(net, ('A', 'J'), ['J', None]) == [(1, 'B'), (0, 'J')]
    assert find_moves(net, ('A', 'B'), ['B', None]) == [(1, 'J'), (1, 'D'), (0, 'J'), (0, 'B')]
    assert find_moves(net, ('A', 'B'), ['B', None], goals=['B', 'A']) is None
    assert find_most(net, ('A', 'B'), ['B', 'A'], 100, ['B', 'A']) == ([], [None, None])


def test_a_net_with_two_nodes_at_one_point_is_not_searched_and_a_warning_says_so(fleet_of):
    fleet = fleet_of([('a', 'A'), ('b', 'B')], {**SIDING, 'T': (10, 5.005)}, [*LANES, ('J', 'T')])
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.run()
    text = 'No way out of a jam is searched, because the nodes S and T are at one point. a, b get places as if each '
    assert [one.text[:len(text)] for one in fleet.warnings if 'This is said once' in one.text] == [text]
    assert not rows(fleet, 'broken_off')


def test_six_robots_on_nine_nodes_all_change_places(fleet_of):
    nodes = {'n{}'.format(number): (10 * (number % 3), 10 * (number // 3)) for number in range(9)}
    edges = [('n{}'.format(one), 'n{}'.format(other)) for one in range(9) for other in range(9)
             if (other - one == 1 and other % 3) or other - one == 3]
    fleet = fleet_of([('r{}'.format(number), 'n{}'.format(number)) for number in range(6)], nodes, edges)
    for number in range(6):
        fleet.robot('r{}'.format(number)).send(*map(float, nodes['n{}'.format(5 - number)]))
    fleet.run()
    assert [row[4] for row in rows(fleet, 'ended')] == ['SUCCEEDED'] * 6
    assert not fleet.warnings


@pytest.mark.parametrize('bound, text', [
    ('MOST_ROBOTS', 'No way out of a jam is searched for more than 1 robots at a time. a, b get places as if each '),
    ('MOST_STATES', 'The search for a way out of a jam gave up after 1 joint places. a, b get places as if each ')])
def test_a_bound_that_is_hit_is_named_once(fleet_of, monkeypatch, bound, text):
    for one in (bound, 'MOST_ALONE') if bound == 'MOST_ROBOTS' else (bound,):
        monkeypatch.setattr(ways_out, one, 1)
    fleet = fleet_of([('a', 'A'), ('b', 'B')])
    for _ in range(2):
        fleet.robot('a').send(30.0, 0.0)
        fleet.robot('b').send(0.0, 0.0)
        fleet.run()
    assert [one.text[:len(text)] for one in fleet.warnings if 'This is said once' in one.text] == [text]
