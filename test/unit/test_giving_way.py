"""deadlock: retreat: who of a circle of waiting drives back, how far, what the others do then; random nets."""
import collections
import itertools
import json
import math
import random

import pytest

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario
from traces import rows

S = 1_000_000_000


@pytest.fixture
def row_of_lanes(tmp_path):
    """Return a function that makes a Fleet on a row of nodes 10 m apart, joined by lanes for one robot each."""
    path = tmp_path / 'lanes.yaml'
    path.write_text(json.dumps({
        'nodes': [{'name': str(number), 'x': 10 * number, 'y': 0} for number in range(4)],
        'edges': [{'from': str(number), 'to': str(number + 1), 'capacity': 1} for number in range(3)]}))

    def make(robots, **defaults):
        return Fleet(make_scenario({
            'lanes': str(path), 'deadlock': 'retreat', 'defaults': {'routes': 'lanes', 'max_speed': 2.0, **defaults},
            'robots': [{'name': name, 'start_x': float(x), **more} for name, x, more in robots]}), start_ns=0)
    return make


@pytest.mark.parametrize('law', [{}, {'xy_goal_tolerance': 0.2}, {'corners': 'stop'}])
def test_the_one_drives_back_over_its_lane_and_goes_on_when_the_other_has_passed(row_of_lanes, law):
    fleet = row_of_lanes([('a', 0, {}), ('b', 20, {})], **law)
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.run()
    assert rows(fleet, 'entered', 'left', 'deadlock', 'gave_way')[:10] == [
        (0.0, 'a', 'entered', 'lane 0 - 1'), (0.0, 'b', 'entered', 'lane 1 - 2'),
        (5.0, 'b', 'deadlock', 'a', 'lane 1 - 2', 'b', 'lane 0 - 1'), (5.0, 'b', 'gave_way', 'lane 1 - 2'),
        (10.0, 'b', 'left', 'lane 1 - 2'), (10.0, 'a', 'entered', 'lane 1 - 2'), (10.0, 'a', 'left', 'lane 0 - 1'),
        (15.0, 'a', 'entered', 'lane 2 - 3'), (15.0, 'a', 'left', 'lane 1 - 2'), (15.0, 'b', 'entered', 'lane 1 - 2')]
    assert [row[1:5:3] for row in rows(fleet, 'ended')] == [('a', 'SUCCEEDED'), ('b', 'SUCCEEDED')]
    assert not [row for row in rows(fleet, 'held') if row[1] == 'b' and 5.0 < row[0] < 10.0]


@pytest.mark.parametrize('robots, who', [
    ([('a', 0, {}), ('b', 20, {})], 'b'), ([('b', 20, {}), ('a', 0, {})], 'b'), ([('b', 0, {}), ('a', 20, {})], 'b'),
    ([('a_2', 0, {}), ('a_10', 20, {})], 'a_10'), ([('a', -2, {}), ('b', 20, {})], 'a'),
    ([('a', 0, {}), ('b', 22, {})], 'b'), ([('a', 0, {}), ('b', 20, {'priority': 1})], 'a'),
    ([('a', -2, {'priority': 1}), ('b', 20, {})], 'b')])
def test_the_lowest_priority_gives_way_then_who_asked_last_then_by_name(row_of_lanes, robots, who):
    fleet = row_of_lanes(robots)
    for name, x, _ in robots:
        fleet.robot(name).send(30.0 - x if x > 0 else 30.0, 0.0) if x <= 0 else fleet.robot(name).send(0.0, 0.0)
    fleet.run()
    assert [row[1] for row in rows(fleet, 'gave_way')] == [who]
    assert len(rows(fleet, 'ended')) == 2


def world(robots, zones):
    return Fleet(make_scenario({
        'defaults': {'max_speed': 2.0}, 'deadlock': 'retreat', 'zones': [
            {'name': name, 'rectangle': box, 'capacity': 1} for name, box in zones.items()],
        'robots': [{'name': name, 'start_x': float(x), 'start_y': float(y)} for name, (x, y) in robots.items()]}),
        start_ns=0)


CROSSING = {'west': [0, 0, 5, 5], 'east': [5, 0, 10, 5]}


def test_who_came_into_a_zone_from_outside_drives_out_of_it():
    fleet = world({'a': (-1, 1), 'b': (9, 2)}, CROSSING)
    fleet.robot('a').send(9.0, 1.0)
    fleet.robot('b').send(-5.0, 2.0)
    fleet.run()
    assert rows(fleet, 'gave_way') == [(3.0, 'a', 'gave_way', 'zone west')]
    assert [row[:4] for row in rows(fleet, 'stands', 'departed') if row[1] == 'a' and 3.0 <= row[0] < 6.0][1:4] == [
        (3.0, 'a', 'departed', 0.0), (5.5, 'a', 'stands', 0.0), (5.5, 'a', 'departed', 9.0)]
    assert [row[1] for row in rows(fleet, 'ended')] == ['b', 'a']


def test_where_nobody_has_anywhere_to_go_the_circle_is_named_and_stays():
    fleet = world({'a': (1, 1), 'b': (9, 2)}, CROSSING)  # both have been inside ever since
    fleet.robot('a').send(9.0, 1.0)
    fleet.robot('b').send(1.0, 2.0)
    fleet.run(60 * S)
    assert len(rows(fleet, 'deadlock')) == 1 and not rows(fleet, 'gave_way', 'ended')
    assert [one.text for one in fleet.warnings] == [
        'Robots wait for one another in a circle: a for zone east; b for zone west. None of them can give way.']


def test_who_is_held_for_something_else_too_gives_way_when_that_is_over(row_of_lanes):
    fleet = row_of_lanes([('a', 1, {}), ('b', 20, {})])  # a has always been on its lane
    fleet.robot('b').send(0.0, 0.0)
    fleet.at(2 * S, lambda fleet: fleet.robot('a').send(30.0, 0.0))
    fleet.at(6 * S, lambda fleet: fleet.robot('b').hold('x'))
    fleet.at(8 * S, lambda fleet: fleet.robot('b').release('x'))
    fleet.run()
    assert rows(fleet, 'gave_way') == [(8.0, 'b', 'gave_way', 'lane 1 - 2')]
    assert [row[0] for row in rows(fleet, 'deadlock')] == [6.5, 8.0]
    assert [row[1] for row in rows(fleet, 'ended')] == ['a', 'b']


def test_who_cannot_give_way_because_its_way_back_is_full_does_so_when_there_is_room():
    fleet = world({'a': (-6, 1), 'b': (9, 2), 'c': (-6, 3)}, {**CROSSING, 'hall': [-4, 0, 1, 5]})
    fleet.robot('a').send(9.0, 1.0)
    fleet.at(4 * S, lambda fleet: (fleet.robot('b').send(-5.0, 2.0), fleet.robot('c').send(-2.0, 3.0)))
    fleet.at(10 * S, lambda fleet: fleet.robot('c').send(-8.0, 3.0))
    fleet.run()
    assert rows(fleet, 'gave_way') == [(11.0, 'a', 'gave_way', 'zone west')]
    assert [(row[0], row[1]) for row in rows(fleet, 'deadlock')] == [(6.0, 'b'), (11.0, 'b')]
    assert [row[1] for row in rows(fleet, 'ended')] == ['c', 'c', 'b', 'a']


@pytest.mark.parametrize('stop, go_on', [
    (lambda fleet: fleet.robot('b').hold('x'), lambda fleet: fleet.robot('b').release('x')),
    (lambda fleet: fleet.robot('b').cancel(), lambda fleet: fleet.robot('b').send(0.0, 0.0))])
def test_who_is_stopped_on_its_way_back_goes_on_from_there_and_gives_way_again(row_of_lanes, stop, go_on):
    fleet = row_of_lanes([('a', 0, {}), ('b', 20, {})])
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.at(7 * S, stop)
    fleet.at(8 * S, go_on)
    fleet.run()
    assert [row[0] for row in rows(fleet, 'gave_way')] == [5.0, 10.0]
    assert (15.0, 'b', 'left', 'lane 1 - 2') in rows(fleet, 'left')  # straight back, without its turns before
    assert [row[1] for row in rows(fleet, 'ended') if row[4] == 'SUCCEEDED'] == ['a', 'b']


@pytest.mark.parametrize('seed', range(20))
def test_the_way_back_ends_at_the_first_place_outside_of_all_zones(seed):
    dice = random.Random(seed)
    boxes = {}
    for number in range(6):
        x, y = dice.uniform(-12.0, 6.0), dice.uniform(-3.0, 0.0)
        boxes['z{}'.format(number)] = [x, y, x + dice.uniform(1.0, 6.0), y + dice.uniform(0.5, 6.0)]
    boxes['last'] = [8.0, -5.0, 12.0, 5.0]
    fleet = world({'a': (-14.0, -1.0), 'b': (10.0, 4.0)}, boxes)
    fleet.robot('a').send(10.0, 1.0)
    fleet.run()
    traveller = fleet.robot('a')._traveller
    x, y = fleet.robot('a').pose.x, fleet.robot('a').pose.y
    assert x == pytest.approx(8.0)  # b stands in the last one
    way = traveller.circles.way_back()
    course = math.atan2(2.0, 24.0)
    for step in itertools.count(1):
        at = x - 0.01 * step * math.cos(course), y - 0.01 * step * math.sin(course)
        if not any(a < at[0] < c and b < at[1] < d for a, b, c, d in boxes.values()):
            break
    found = way and way.distance
    if not traveller.held:
        return  # it waits without a place
    assert way is not None and step * 0.01 - 0.0101 <= found <= step * 0.01 + 1e-6


class Net:
    """A net of nine nodes, lanes for one or two robots, groups, zones across lanes: nine robots with eight goals."""

    def __init__(self, seed, folder):
        dice = self.dice = random.Random(seed)
        nodes = {'n{}'.format(number): (10.0 * (number % 3) + dice.random(), 10.0 * (number // 3) + dice.random())
                 for number in range(9)}
        pairs = [(a, b) for a, b in itertools.combinations(range(9), 2) if (b - a == 1 and b % 3) or b - a == 3]
        edges = [{'from': 'n{}'.format(a), 'to': 'n{}'.format(b), 'capacity': dice.choice([1, 1, 1, 2]),
                  **({'group': dice.choice('gh')} if seed % 2 and dice.random() < 0.3 else {})} for a, b in pairs]
        path = folder / 'net.yaml'
        path.write_text(json.dumps({'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in nodes.items()],
                                    'edges': edges}))
        self.raw = {
            'lanes': str(path), 'defaults': {'routes': 'lanes'}, 'deadlock': 'retreat',
            'blocks': dice.choice([1, 1, 2]),
            'groups': {'g': dice.choice([1, 2]), 'h': 2}, 'zones': [
                {'name': 'z', 'rectangle': [3, -2, 9, 9], 'capacity': dice.choice([1, 2])}][:seed % 3]}
        self.robots = [{'name': 'r{}'.format(number), 'start_x': x, 'start_y': y, 'priority': dice.randint(0, 2),
                        'max_speed': 0.5 + dice.random()} for number, (x, y) in enumerate(nodes.values())]
        self.goals = {one['name']: [dice.choice(list(nodes.values())) for _ in range(8)] for one in self.robots}
        self.begins = {one['name']: dice.randint(0, 3 * S) for one in self.robots}

    def run(self, robots):
        left = {name: list(goals) for name, goals in self.goals.items()}

        def send(name, *_):
            if left[name]:
                fleet.robot(name).send(*left[name].pop(0))
        fleet = Fleet(make_scenario({**self.raw, 'robots': robots}), start_ns=0, on_end=send)
        for name, begin_ns in self.begins.items():
            fleet.at(begin_ns, lambda _, name=name: send(name))
        fleet.run(50_000 * S)
        return fleet


@pytest.mark.parametrize('seed', [0, 1, 2, 3, 4, 5, 18, 26, 27, 43])  # 18, 26, 27: robots gave way for ever
def test_in_any_net_each_circle_is_resolved_and_all_come_to_their_goals(seed, tmp_path):
    net = Net(seed, tmp_path)
    fleet = net.run(net.robots)
    assert [row[4] for row in rows(fleet, 'ended')] == ['SUCCEEDED'] * 72
    assert len(rows(fleet, 'deadlock')) == len(rows(fleet, 'gave_way')) > 0
    room, inside = {}, collections.Counter()
    for _, _, kind, area, *more in rows(fleet, 'places', 'entered', 'left'):
        if kind == 'places':
            room[area], = more
        inside[area] += {'entered': 1, 'left': -1}.get(kind, 0)
        assert 0 <= inside[area] <= room[area]
    shuffled = list(net.robots)
    net.dice.shuffle(shuffled)
    assert sorted(rows(fleet, 'entered', 'left', 'stands', 'gave_way', 'ended')) == sorted(
        rows(net.run(shuffled), 'entered', 'left', 'stands', 'gave_way', 'ended'))
