"""Choices of traffic: priorities, blocks, groups, what waiting costs a route; and worlds with all of them on."""
import itertools
import json
import random

import networkx
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Dispatch, Fleet
from move_base_abstract.maps.lane_map import make_lane_map
from move_base_abstract.maps.lane_planner import LaneWays
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.orders.order import Order, Stop
from move_base_abstract.scenario import make_scenario
from traces import rows

S = 1_000_000_000


def fleet_of(robots, **more):
    """Return a Fleet at time 0; ``robots``: [{name, ...}], all at 2 m/s."""
    return Fleet(make_scenario({'defaults': {'max_speed': 2.0, **more.pop('defaults', {})}, **more, 'robots': robots}),
                 start_ns=0)


def net_of(tmp_path, nodes, edges):
    path = tmp_path / 'net.yaml'
    path.write_text(json.dumps({
        'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in nodes.items()],
        'edges': [{'from': a, 'to': b, **more} for a, b, more in edges]}))
    return {'lanes': str(path), 'defaults': {'routes': 'lanes'}}


# ---- priorities

def oracle_of_priorities(arrivals, seconds):
    """Return when each of [(instant, priority)] comes in: whoever is first in the queue whenever the gate is free.

    Who comes at the instant at which it gets free is in the queue, too.
    """
    came, left, free = {}, dict(enumerate(arrivals)), 0
    while left:
        now = max(free, min(instant for instant, _ in left.values()))
        first = min((index for index in left if left[index][0] <= now),
                    key=lambda index: (-left[index][1], left[index][0], index))
        del left[first]
        came[first], free = now, now + seconds
    return came


@pytest.mark.parametrize('seed', range(5))
def test_the_higher_priority_comes_first_in_a_queue(seed):
    dice = random.Random(seed)
    arrivals = [(instant, dice.randint(-2, 2)) for instant in sorted(dice.sample(range(1, 60), 20))]
    robots = [{'name': 'r{}'.format(index), 'start_x': 4.0 - 2.0 * instant, 'start_y': 0.1 * index,
               'priority': priority} for index, (instant, priority) in enumerate(arrivals)]
    fleet = fleet_of(robots, zones=[{'name': 'gate', 'rectangle': [4, -50, 10, 50], 'capacity': 1}])
    for index, robot in enumerate(robots):
        fleet.robot(robot['name']).send(20.0, 0.1 * index)
    fleet.run()
    came = {int(row[1][1:]): round(row[0], 6) for row in rows(fleet, 'entered')}
    assert came == oracle_of_priorities(arrivals, 3)


def test_what_priority_may_be():
    with pytest.raises(ConfigurationError, match='priority: got 1.5; allowed: a whole number'):
        fleet_of([{'name': 'a', 'priority': 1.5}])


def test_who_finds_one_place_at_one_instant_gets_it_by_name():
    for order in ('ab', 'ba'):
        fleet = fleet_of([{'name': name, 'start_y': float('ab'.index(name))} for name in order], zones=[
            {'name': 'gate', 'rectangle': [4, -50, 6, 50], 'capacity': 1}])
        for name in order:
            fleet.robot(name).send(10.0, 'ab'.index(name))
        fleet.run()
        assert [row[1] for row in rows(fleet, 'entered')] == ['a', 'b']


# ---- blocks

ROW = [{'name': name, 'rectangle': [x, -5, x + 4, 5], 'capacity': 1} for name, x in (
    ('one', 4), ('two', 8), ('six', 12))]


@pytest.mark.parametrize('blocks, stands_at', [(1, 8.0), (2, 4.0), (3, 4.0)])
def test_a_robot_goes_on_only_where_so_many_zones_have_room(blocks, stands_at):
    fleet = fleet_of([{'name': 'a', 'start_x': 10.0}, {'name': 'b', 'start_y': 1.0}], zones=ROW, blocks=blocks)
    fleet.robot('b').send(30.0, 1.0)
    fleet.run(10 * S)
    assert fleet.robot('b').pose.x == pytest.approx(stands_at, abs=1e-6)
    fleet.robot('a').send(30.0, 0.0)  # it frees the one, and is for a while in the next
    fleet.run()
    assert [row[1] for row in rows(fleet, 'ended')] == ['a', 'b']


def test_who_looks_ahead_keeps_nobody_out_there():
    fleet = fleet_of([{'name': 'a', 'start_x': 5.0}, {'name': 'b', 'start_y': 1.0}, {'name': 'c', 'start_x': 10.0,
                      'start_y': 9.0}], zones=ROW, blocks=2)
    fleet.robot('b').send(30.0, 1.0)  # it waits for room in one, where a stands
    fleet.run(10 * S)
    fleet.robot('c').send(10.0, 0.0)
    fleet.run(20 * S)
    assert fleet.zones[1].robots == ('c',)


# ---- groups

def test_a_group_of_lanes_and_zones_holds_as_many_as_it_says(tmp_path):
    nodes = {'a': (0, 0), 'b': (10, 0), 'c': (0, 5), 'd': (10, 5)}
    world = net_of(tmp_path, nodes, [('a', 'b', {'group': 'g'}), ('c', 'd', {'group': 'g'})])
    robots = [{'name': 'r', 'start_y': 0.0}, {'name': 's', 'start_y': 5.0},
              {'name': 't', 'start_y': 20.0, 'routes': 'none'}]
    zones = [{'name': 'z', 'rectangle': [4, 15, 6, 25], 'group': 'g'}]
    came = {}
    for room in (1, 3):
        fleet = fleet_of(robots, zones=zones, groups={'g': room}, **{**world, 'defaults': dict(world['defaults'])})
        for name, y in (('r', 0.0), ('s', 5.0), ('t', 20.0)):
            fleet.robot(name).send(10.0, y)
        fleet.run()
        came[room] = {row[1]: row[0] for row in rows(fleet, 'entered') if row[3] == 'group g'}
    assert came == {1: {'r': 0.0, 's': 5.0, 't': 10.0}, 3: {'r': 0.0, 's': 0.0, 't': 2.0}}


def test_a_group_is_not_left_between_two_of_its_lanes(tmp_path):
    world = net_of(tmp_path, {'a': (0, 0), 'b': (10, 0), 'c': (20, 0)}, [
        ('a', 'b', {'group': 'g'}), ('b', 'c', {'group': 'g'})])
    fleet = fleet_of([{'name': 'r'}, {'name': 's'}], **world)
    for name in 'rs':
        fleet.robot(name).send(20.0, 0.0)
    fleet.run()
    assert [row for row in rows(fleet, 'entered', 'left') if row[3] == 'group g'] == [
        (0.0, 'r', 'entered', 'group g'), (10.0, 'r', 'left', 'group g'),
        (10.0, 's', 'entered', 'group g'), (20.0, 's', 'left', 'group g')]


@pytest.mark.parametrize('groups', [[], {'g': 0}, {'1g': 1}, {'g': True}])
def test_what_groups_may_be(groups):
    with pytest.raises(ConfigurationError, match='groups: got .*; allowed: a mapping of names of groups to whole'):
        make_scenario({'groups': groups})


# ---- what waiting costs a route

@pytest.mark.parametrize('seed', range(5))
def test_the_priced_way_is_the_cheapest_of_all(seed):
    dice = random.Random(seed)
    nodes = {str(number): (dice.uniform(0, 50), dice.uniform(0, 50)) for number in range(25)}
    pairs = dice.sample(list(itertools.permutations(nodes, 2)), 120)
    net = make_lane_map({'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in nodes.items()],
                         'edges': [{'from': a, 'to': b, 'one_way': True} for a, b in pairs]})
    extra = {index: dice.randint(0, 20) * S for index in range(120)}
    graph = networkx.DiGraph()
    for index, edge in enumerate(net.edges):
        length = ((edge.points[0][0] - edge.points[1][0]) ** 2 + (edge.points[0][1] - edge.points[1][1]) ** 2) ** 0.5
        graph.add_edge(edge.begin, edge.end, cost=round(length * S) + extra[index])
    ways = LaneWays(net, 1.0)
    for first, last in itertools.permutations(nodes, 2):
        way = ways.priced_way(nodes[first], nodes[last], lambda edge, _time_ns: extra[edge])
        if way is None:
            assert not networkx.has_path(graph, first, last)
            continue
        found = sum(graph.edges[net.edges[edge].begin, net.edges[edge].end]['cost'] for edge in way.lanes)
        assert found == networkx.dijkstra_path_length(graph, first, last, weight='cost')


DIAMOND = {'a': (0, 0), 'b': (10, 3), 'c': (10, -4), 'd': (20, 0), 'x': (-10, 0)}
EDGES = [('x', 'a', {}), *((one, other, {'capacity': 1}) for one, other in ('ab', 'ac', 'bd', 'cd'))]


@pytest.mark.parametrize('price, by', [(0.0, 3.0), (0.01, 3.0), (1.0, -4.0)])
def test_who_departs_goes_round_a_full_lane_where_that_is_cheaper(tmp_path, price, by):
    fleet = fleet_of([{'name': 'r', 'start_x': 5.0, 'start_y': 1.5}, {'name': 's', 'log_motion': True}],
                     lane_price=price, **net_of(tmp_path, DIAMOND, EDGES))
    fleet.robot('r').send(6.0, 1.8)  # on the lane, where it stays
    fleet.run()
    fleet.robot('s').send(20.0, 0.0)
    fleet.run(until=100.0)
    first = next(row[3:] for row in rows(fleet, 'pieces') if row[1] == 's')
    assert max((piece.y for piece in first), key=abs) == pytest.approx(by)
    assert any(row[1] == 's' for row in rows(fleet, 'ended')) == (by == -4.0)


def test_who_would_have_to_wait_at_a_node_looks_for_another_way(tmp_path):
    fleet = fleet_of([{'name': 'r', 'start_x': -1.0, 'start_y': 1.5}, {'name': 's', 'start_x': -10.0}], lane_price=1.0,
                     **net_of(tmp_path, DIAMOND, EDGES))
    fleet.robot('s').send(20.0, 0.0)
    fleet.at(2 * S, lambda fleet: fleet.robot('r').send(5.0, 1.5))
    fleet.run(until=100.0)
    assert [row[1] for row in rows(fleet, 'ended') if row[4] == 'SUCCEEDED'] == ['r', 's']
    assert not [row for row in rows(fleet, 'held') if row[1] == 's']
    assert [(row[0], row[4]) for row in rows(fleet, 'departed') if row[1] == 's'] == [(0.0, 0.0), (5.0, 0.0)]


def test_a_price_does_not_go_with_avoid():
    with pytest.raises(ConfigurationError, match="lane_price: got 0.5 with deadlock: 'avoid'; allowed: 0 with it"):
        make_scenario({'lane_price': 0.5, 'deadlock': 'avoid'})


# ---- all of it

@pytest.mark.parametrize('seed', range(4))
def test_with_avoid_blocks_groups_and_priorities_no_circle_closes_and_all_come_to_their_goals(tmp_path, seed):
    dice = random.Random(seed)
    nodes = {'n{}'.format(index): (10.0 * (index % 3) + dice.random(), 10.0 * (index // 3) + dice.random())
             for index in range(9)}
    pairs = [(a, b) for a, b in itertools.combinations(range(9), 2) if (b - a == 1 and b % 3) or b - a == 3]
    edges = [('n{}'.format(a), 'n{}'.format(b), {'capacity': 1, **({'group': dice.choice('gh')} if dice.random() < 0.3
                                                                    else {})}) for a, b in pairs]
    robots = [{'name': 'r{}'.format(index), 'start_x': x, 'start_y': y, 'priority': dice.randint(0, 2)}
              for index, (x, y) in enumerate(nodes.values())]
    left = {one['name']: [dice.choice(list(nodes.values())) for _ in range(6)] for one in robots}

    def send(robot):
        if left[robot]:
            fleet.robot(robot).send(*left[robot].pop(0))
    fleet = Fleet(make_scenario({**net_of(tmp_path, nodes, edges), 'robots': robots, 'deadlock': 'avoid', 'blocks': 2,
                                 'groups': {'g': 1, 'h': 2}}), on_end=lambda robot, *_: send(robot))
    for robot in fleet.names:
        send(robot)
    fleet.run(until=100_000.0)
    assert [entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == ['SUCCEEDED'] * 54
    assert not [entry for entry in fleet.trace if entry.kind == 'deadlock']


# ---- priorities that change

def queue_of(order='abcd', at=None, priority=5, **more):
    """Return when each robot comes in where ``d`` gets another priority at 3 s: it is the last in the queue then."""
    robots = {'a': 4.0, 'b': 2.0, 'c': 1.0, 'd': 0.0}
    fleet = fleet_of([{'name': name, 'start_x': robots[name] - 0.1, 'start_y': float('abcd'.index(name))}
                      for name in order], zones=[
                          {'name': 'gate', 'rectangle': [4, -50, 20, 50], 'capacity': 1}], **more)
    for name in order:
        fleet.robot(name).send(30.0, float('abcd'.index(name)))
    if at is not None:
        fleet.at(at, lambda fleet: fleet.robot('d').set_priority(priority))
    fleet.run()
    assert len(rows(fleet, 'ended')) == 4
    return fleet


def test_a_priority_holds_from_the_instant_on_at_which_it_is_set_also_where_the_robot_waits():
    assert [row[1] for row in rows(queue_of(), 'entered')] == list('abcd')
    for at in (1 * S, 3 * S):  # on its way, and in the queue
        fleet = queue_of(at=at)
        assert [row[1] for row in rows(fleet, 'entered')] == list('adbc')
        assert rows(fleet, 'priority') == [(at / S, 'd', 'priority', 5)]
    assert [row[1] for row in rows(queue_of(at=3 * S, priority=-1), 'entered')] == list('abcd')
    assert not rows(queue_of(at=3 * S, priority=0), 'priority')
    logs = [rows(queue_of(order, at=3 * S), 'entered', 'left', 'priority') for order in ('abcd', 'dcba', 'cadb')]
    assert logs[0] == logs[1] == logs[2]


def test_what_a_priority_may_be_while_it_runs():
    fleet = queue_of()
    with pytest.raises(ConfigurationError, match="robot 'a'/priority: got 0.5; allowed: a whole number of 32 bits"):
        fleet.robot('a').set_priority(0.5)


def test_a_robot_has_the_priority_of_its_order_where_that_is_higher():
    scenario = make_scenario({
        'robots': [{'name': 'a'}, {'name': 'b', 'start_x': 20.0, 'priority': 2}],
        'zones': [{'name': 'far', 'rectangle': [90, 90, 91, 91], 'capacity': 1}], 'places': [], 'dispatcher': {}})
    dispatch = Dispatch(scenario)
    for number, (x, priority) in enumerate([(1.0, 3), (2.0, 0), (21.0, 1), (22.0, 4)]):
        dispatch.fleet.at((1 + 60 * number) * S, lambda _, x=x, number=number, priority=priority: dispatch.order(
            Order('o{}'.format(number), 0, (Stop(Pose2D(x)),), None, priority)))
    dispatch.run()
    assert [row[1:] for row in rows(dispatch.fleet, 'priority')] == [
        ('a', 'priority', 3), ('a', 'priority', 0), ('b', 'priority', 4)]
    assert len(rows(dispatch.fleet, 'order_done')) == 4


def test_who_lacks_room_ahead_is_overtaken(tmp_path):
    world = net_of(tmp_path, {'a': (0, 0), 'b': (10, 0), 'c': (20, 0)}, [
        ('a', 'b', {'capacity': 1}), ('b', 'c', {'capacity': 1})])
    fleet = fleet_of([{'name': 'r'}, {'name': 's', 'start_x': 20.0}], blocks=2, **world)
    fleet.robot('r').send(20.0, 0.0)
    fleet.at(1 * S, lambda fleet: fleet.robot('s').send(0.0, 0.0))
    fleet.run()
    assert not rows(fleet, 'deadlock')
    assert [row[:2] for row in rows(fleet, 'ended')] == [(10.0, 'r'), (20.0, 's')]


def test_who_is_in_a_group_waits_in_it_for_nobody_that_still_asks_for_a_place_there(tmp_path):
    world = net_of(tmp_path, {'a': (0, 0), 'b': (10, 0), 'c': (20, 0)}, [
        ('a', 'b', {'group': 'g'}), ('b', 'c', {'group': 'g', 'capacity': 1})])
    fleet = fleet_of([{'name': 'r'}, {'name': 's', 'start_x': 20.0}], **world)
    fleet.robot('r').send(20.0, 0.0)
    fleet.at(1 * S, lambda fleet: fleet.robot('s').send(0.0, 0.0))  # asks for the second lane, and the group, first
    fleet.run()
    assert not rows(fleet, 'deadlock')
    assert [row[:2] for row in rows(fleet, 'ended')] == [(10.0, 'r'), (20.0, 's')]
