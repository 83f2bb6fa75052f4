"""Nodes with place for a limited number of robots: which of lane and node a robot holds, and when it gives one back."""
import itertools
import random

import pytest
import yaml
from night import times

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.lane_map import make_lane_map
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from test_scenario_check import found, world_file

#: a corridor A - J - K - B with a siding S at J
CORRIDOR = {'A': (0.0, 0.0), 'J': (10.0, 0.0), 'K': (20.0, 0.0), 'B': (30.0, 0.0), 'S': (10.0, 5.0)}
LANES = ('AJ', 'JK', 'KB', 'JS')


def net_file(folder, nodes, pairs, lane=None, **top):
    """Write the net of ``nodes`` {name: (x, y)} or {name: (x, y, {key: value})}; return its path."""
    path = folder / 'net.yaml'
    path.write_text(yaml.safe_dump({
        'nodes': [{'name': name, 'x': at[0], 'y': at[1], **(at[2] if len(at) > 2 else {})}
                  for name, at in nodes.items()],
        'edges': [{'from': one, 'to': other, **(lane or {})} for one, other in pairs], **top}))
    return str(path)


def fleet_on(net, robots, **scenario):
    """Return a fleet on the file ``net`` at 1 m/s, of robots {name: (x, y)}."""
    on_end = scenario.pop('on_end', None)
    return Fleet(make_scenario({
        'lanes': net, 'defaults': {'routes': 'lanes', 'max_speed': 1.0}, **scenario,
        'robots': [{'name': name, 'start_x': x, 'start_y': y} for name, (x, y) in robots.items()]}), 0, on_end)


def rows(fleet, *kinds):
    return [(entry.time_ns // 10 ** 9, entry.robot, entry.kind, *entry.values) for entry in fleet.trace
            if entry.kind in kinds]


def holders(fleet):
    return {'{} {}'.format(area.kind, area.name): area.robots for area in fleet.zones if area.robots}


def test_a_robot_takes_a_lane_with_the_node_behind_it_and_gives_each_back_when_it_has_left(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, {'capacity': 1}, node_capacity=1), {'a': CORRIDOR['A']})
    assert holders(fleet) == {'node A': ('a',)}
    fleet.robot('a').send(*CORRIDOR['K'])
    fleet.run(until=5.0)
    assert holders(fleet) == {'lane A - J': ('a',), 'node J': ('a',)}
    fleet.run()
    assert rows(fleet, 'entered', 'left', 'stands') == [
        (0, 'a', 'entered', 'node A'), (0, 'a', 'entered', 'lane A - J'), (0, 'a', 'entered', 'node J'),
        (0, 'a', 'left', 'node A'), (10, 'a', 'entered', 'lane J - K'), (10, 'a', 'entered', 'node K'),
        (10, 'a', 'left', 'lane A - J'), (10, 'a', 'left', 'node J'), (20, 'a', 'left', 'lane J - K'),
        (20, 'a', 'stands', 20.0, 0.0, 0.0)]
    assert holders(fleet) == {'node K': ('a',)}


def test_a_robot_that_must_wait_at_its_node_gives_the_lane_back(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, {'capacity': 1}, node_capacity=1),
                     {'a': CORRIDOR['A'], 'k': CORRIDOR['K'], 's': CORRIDOR['S']})
    fleet.robot('a').send(*CORRIDOR['K'])
    fleet.run()
    assert holders(fleet) == {'node J': ('a',), 'node K': ('k',), 'node S': ('s',)}
    assert rows(fleet, 'held') == [(10, 'a', 'held', 'lane J - K, node K')]
    fleet.robot('k').send(*CORRIDOR['B'])
    fleet.run()
    assert rows(fleet, 'entered', 'left')[-8:] == [
        (10, 'k', 'entered', 'lane K - B'), (10, 'k', 'entered', 'node B'), (10, 'k', 'left', 'node K'),
        (10, 'a', 'entered', 'lane J - K'), (10, 'a', 'entered', 'node K'), (10, 'a', 'left', 'node J'),
        (20, 'k', 'left', 'lane K - B'), (20, 'a', 'left', 'lane J - K')]


def test_a_robot_that_was_stopped_on_a_lane_keeps_the_node_ahead_until_it_turns_round(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, {'capacity': 1}, node_capacity=1), {'a': CORRIDOR['A']})
    fleet.robot('a').send(*CORRIDOR['K'])
    fleet.run(until=4.0)
    fleet.robot('a').cancel()
    fleet.run()
    assert holders(fleet) == {'lane A - J': ('a',), 'node J': ('a',)}
    fleet.robot('a').send(*CORRIDOR['A'])
    fleet.run(until=5.0)
    assert holders(fleet) == {'lane A - J': ('a',), 'node A': ('a',)}
    fleet.run()
    fleet.robot('a').place(Pose2D(25.0, 0.0, 0.0))
    assert holders(fleet) == {}
    fleet.robot('a').place(Pose2D(20.0, 0.009, 0.0))
    assert holders(fleet) == {'node K': ('a',)}


def test_a_node_that_is_reached_from_off_the_net_is_taken_at_the_departure(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, node_capacity=1), {'a': (0.0, -5.0), 'b': CORRIDOR['A']},
                     zones=[{'name': 'yard', 'rectangle': [-1, -4, 1, -2]}])
    fleet.robot('a').send(10.0, 0.0)
    fleet.run()
    assert fleet.robot('a').pose.y == -5.0 and rows(fleet, 'held') == [(0, 'a', 'held', 'node A')]
    fleet.robot('b').send(10.0, 9.0)  # it leaves the net at S
    fleet.run()
    assert fleet.robot('a').pose.x == 10.0 and holders(fleet) == {'node J': ('a',)}
    assert (24 - 5, 'b', 'left', 'node S') not in rows(fleet, 'left')
    assert (15, 'b', 'left', 'node S') in rows(fleet, 'left')


def test_a_robot_whose_goal_is_at_no_node_holds_none_there(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, node_capacity=1), {'a': CORRIDOR['A'], 'b': (30.0, 5.0)})
    fleet.robot('a').send(4.0, 0.0)
    fleet.robot('b').send(35.0, 0.0)
    fleet.run(until=4.5)
    assert holders(fleet) == {'node B': ('b',)}
    fleet.run()
    assert holders(fleet) == {} and (5, 'b', 'left', 'node B') in rows(fleet, 'left')


def test_nodes_without_a_capacity_hold_any_number_and_their_robots_keep_the_lane(tmp_path):
    nodes = {**CORRIDOR, 'K': (20.0, 0.0, {'capacity': 2})}
    fleet = fleet_on(net_file(tmp_path, nodes, LANES, {'capacity': 1}), dict.fromkeys('abc', (0.0, 0.0)))
    for name in 'abc':
        fleet.robot(name).send(20.0, 0.0)
    fleet.run()
    assert holders(fleet) == {'node K': ('a', 'b'), 'lane A - J': ('c',)}  # c waits at J, which has no capacity
    assert [entry.text for entry in fleet.warnings] == []


def test_robots_do_not_pass_one_another_on_a_lane_between_two_nodes(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, node_capacity=1), {'a': CORRIDOR['J'], 'b': CORRIDOR['K']})
    fleet.robot('a').send(*CORRIDOR['K'])
    fleet.robot('b').send(*CORRIDOR['J'])
    fleet.run()
    assert rows(fleet, 'deadlock') == [(0, 'b', 'deadlock', 'a', 'node K', 'b', 'node J')]
    assert (fleet.robot('a').pose.x, fleet.robot('b').pose.x) == (10.0, 20.0)


@pytest.mark.parametrize('lane', [{}, {'capacity': 1}])
def test_a_robot_gives_way_to_the_node_from_which_it_came(tmp_path, lane):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, lane, node_capacity=1),
                     {'a': CORRIDOR['S'], 'b': CORRIDOR['K']}, deadlock='retreat')
    fleet.robot('a').send(*CORRIDOR['K'])
    fleet.run(until=5.0)
    fleet.robot('b').send(*CORRIDOR['A'])
    fleet.run()
    assert [row[1:3] for row in rows(fleet, 'gave_way')] == [('a', 'gave_way')]
    assert [row[1] for row in rows(fleet, 'ended')] == ['b', 'a']


def test_robots_stop_giving_way_where_it_does_no_good(tmp_path):
    """Each of them would have to go into the siding, which is not on the way by which it came."""
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, {'capacity': 1}, node_capacity=1),
                     {'a': CORRIDOR['A'], 'b': CORRIDOR['B']}, deadlock='retreat')
    fleet.robot('a').send(*CORRIDOR['B'])
    fleet.robot('b').send(*CORRIDOR['A'])
    fleet.run(until=1000.0)
    assert not fleet.simulation.queue.is_busy()
    assert len(rows(fleet, 'gave_way')) == 6 and fleet.warnings[-1].text.endswith('None of them can give way.')
    fleet.robot('b').send(*CORRIDOR['B'])  # with another goal it begins anew
    fleet.run(until=2000.0)
    assert [row[1] for row in rows(fleet, 'ended')][1:] == ['b'] and rows(fleet, 'ended')[0][1] == 'b'


def test_more_robots_than_places_start_at_a_node_with_a_warning(tmp_path):
    fleet = fleet_on(net_file(tmp_path, CORRIDOR, LANES, node_capacity=1), {'a': CORRIDOR['A'], 'b': CORRIDOR['A']})
    assert [one.text for one in fleet.warnings] == [
        'b stands in node A, which has no free place: 2 robots of 1 are there']


@pytest.mark.parametrize('seed', range(times(30, 2_000)))
def test_no_node_ever_holds_more_robots_than_it_has_places_and_no_two_stand_in_one_point(tmp_path, seed):
    dice = random.Random(seed)
    count = dice.randint(4, 8)
    nodes = {'n{}'.format(index): (10.0 * (index % 3), 10.0 * (index // 3)) for index in range(count)}
    names = list(nodes)
    pairs = [(names[index], names[dice.randrange(index)]) for index in range(1, count)]
    pairs += [pair for pair in itertools.combinations(names, 2)
              if pair not in pairs and pair[::-1] not in pairs and dice.random() < 0.2]
    starts = dice.sample(names, dice.randint(2, count - 1))
    for name in names if seed % 2 else ():  # every other net has some nodes with spots
        if dice.random() < 0.4:
            x, y = nodes[name]
            nodes[name] = x, y, {'spots': [[x + 1.0, y + number] for number in range(1, dice.randint(2, 3))]}
    xy = {name: tuple(node[:2]) for name, node in nodes.items()}
    robots = {'r{}'.format(index): xy[name] for index, name in enumerate(starts)}
    left = {name: [dice.choice(list(xy.values())) for _ in range(6)] for name in robots}

    def send(robot):
        if left[robot]:
            fleet.at(fleet.now_ns + dice.randrange(3) * 10 ** 9, lambda fleet: fleet.robot(robot).send(
                *left[robot].pop()) if left[robot] else None)
    fleet = fleet_on(net_file(tmp_path, nodes, pairs, dice.choice(({}, {'capacity': 1})), node_capacity=1), robots,
                     deadlock=dice.choice(('wait', 'abort', 'avoid', 'retreat')), blocks=dice.choice((1, 2)),
                     on_end=lambda robot, *_: send(robot))
    for robot in robots:
        send(robot)
    fleet.run(until=500.0)
    check_places(fleet, robots, xy)


def check_places(fleet, robots, nodes):
    """Count, from the log alone, who is at which node, and where robots stand between two instants."""
    inside, room, at = {}, {}, dict(robots)
    for _, instant in itertools.groupby(fleet.trace, lambda entry: entry.time_ns):
        for entry in instant:
            if entry.kind == 'places':
                room[entry.values[0]] = entry.values[1]
            elif entry.kind == 'entered':
                inside.setdefault(entry.values[0], set()).add(entry.robot)
                assert len(inside[entry.values[0]]) <= room[entry.values[0]]
            elif entry.kind == 'left':
                inside[entry.values[0]].remove(entry.robot)
            elif entry.kind == 'departed':
                at.pop(entry.robot, None)
            elif entry.kind == 'stands':
                at[entry.robot] = tuple(entry.values[:2])
        assert len(set(at.values())) == len(at)
        for robot, place in at.items():
            for name, xy in nodes.items():
                assert xy != place or robot in inside['node ' + name]


def test_the_check_finds_two_robots_that_cannot_pass(tmp_path):
    path = world_file(tmp_path, ({name: CORRIDOR[name] for name in 'AJ'}, [('A', 'J')]),
                      robots=[{'name': 'a'}, {'name': 'b', 'start_x': 10.0}])
    assert found(path) == []
    net = yaml.safe_load((tmp_path / 'net.yaml').read_text())
    (tmp_path / 'net.yaml').write_text(yaml.safe_dump({**net, 'node_capacity': 1}))
    assert ('can_lock', 'node A') in [(one.kind, one.name) for one in found(path)]


@pytest.mark.parametrize('net, words', [
    ({'node_capacity': 0}, 'lanes/node_capacity: got 0'),
    ({'nodes': [{'name': 'a', 'x': 0, 'y': 0, 'capacity': 1.5}]}, 'lanes: nodes[0]/capacity: got 1.5')])
def test_a_capacity_that_cannot_be_is_refused_in_words(net, words):
    with pytest.raises(ConfigurationError, match='allowed: a whole number >= 1') as caught:
        make_lane_map({'nodes': [{'name': 'a', 'x': 0, 'y': 0}], 'edges': [], **net})
    assert words in str(caught.value)


def test_a_robot_that_waits_for_a_full_node_keeps_nobody_from_leaving_it(tmp_path):
    nodes = {**CORRIDOR, 'J': (10.0, 0.0, {'capacity': 2})}
    fleet = fleet_on(net_file(tmp_path, nodes, LANES, {'capacity': 1}, node_capacity=1),
                     {'a': CORRIDOR['J'], 's': CORRIDOR['S']})
    fleet.robot('a').send(*CORRIDOR['S'])
    fleet.run()
    fleet.robot('s').send(*CORRIDOR['J'])  # a is in the queue of the lane before it
    fleet.run()
    assert [row[1] for row in rows(fleet, 'ended')] == ['s', 'a'] and not rows(fleet, 'deadlock')


#: three robots stand at D, on the north of the end of a lane A - D
SPOTS = ((19.0, 2.0), (20.0, 2.0), (21.0, 2.0))
DEPOT = {'A': (0.0, 0.0), 'B': (10.0, 0.0), 'D': (20.0, 0.0, {'spots': [list(spot) for spot in SPOTS]}),
         'E': (30.0, 0.0, {'capacity': 1})}


def stand(fleet):
    return {robot.name: (round(robot.pose.x, 6), round(robot.pose.y, 6)) for robot in fleet.robots}


def test_each_robot_at_a_node_with_spots_stands_at_its_own(tmp_path):
    fleet = fleet_on(net_file(tmp_path, DEPOT, ('AB', 'BD', 'DE')), dict.fromkeys('abcd', (0.0, 0.0)))
    for name in 'abcd':
        fleet.robot(name).send(20.0, 0.0)
        fleet.run_for(2.0)
    fleet.run()
    assert stand(fleet) == {**dict(zip('abc', SPOTS)), 'd': (10.0, 0.0)}  # d waits at the node before
    assert [entry.values[0] for entry in fleet.trace if entry.kind == 'places'] == ['node D']
    fleet.robot('b').send(0.0, 0.0)
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[0], 'b': (0.0, 0.0), 'c': SPOTS[2], 'd': SPOTS[1]}
    ended = [entry for entry in fleet.trace if entry.kind == 'ended']
    assert [entry.values[1] for entry in ended] == ['SUCCEEDED'] * 5


def test_a_robot_that_gets_another_spot_on_its_way_drives_there(tmp_path):
    fleet = fleet_on(net_file(tmp_path, DEPOT, ('AB', 'BD', 'DE')), {'a': (0.0, 0.0), 'b': (30.0, 0.0)})
    fleet.robot('a').send(20.0, 0.0)  # both would get the first spot at their departure; b is there first
    fleet.run(until=1.0)
    fleet.robot('b').send(20.0, 0.0)
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[1], 'b': SPOTS[0]}
    departed = [entry.values[:2] for entry in fleet.trace if (entry.robot, entry.kind) == ('a', 'departed')]
    assert departed == [SPOTS[0], SPOTS[1]]


def test_a_robot_that_must_wait_at_a_node_with_spots_waits_at_its_spot(tmp_path):
    robots = {'a': (0.0, 0.0), 'b': (10.0, 0.0), 'e': (30.0, 0.0)}
    fleet = fleet_on(net_file(tmp_path, DEPOT, ('AB', 'BD', 'DE'), {'capacity': 1}), robots)
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(30.0, 0.0)
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[1], 'b': SPOTS[0], 'e': (30.0, 0.0)}
    assert holders(fleet) == {'node D': ('a', 'b'), 'node E': ('e',)}
    fleet.robot('e').send(0.0, 0.0)
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[1], 'b': (30.0, 0.0), 'e': (0.0, 0.0)}
    entered = [entry.time_ns for entry in fleet.trace if (entry.robot, *entry.values) == ('b', 'node E')]
    left = [entry.time_ns for entry in fleet.trace if (entry.robot, *entry.values) == ('b', 'node D')]
    assert entered == left[1:]  # b asks for the lane where it departs from its spot, and gives D back there


def test_a_robot_that_was_stopped_between_the_point_of_a_node_and_its_spot_keeps_its_place(tmp_path):
    fleet = fleet_on(net_file(tmp_path, DEPOT, ('AB', 'BD', 'DE')), {'a': (10.0, 0.0)})
    fleet.robot('a').send(20.0, 0.0)
    fleet.run(until=11.0)
    fleet.robot('a').cancel()
    fleet.robot('a').send(20.0, 0.0)
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[0]} and holders(fleet) == {'node D': ('a',)}
    assert rows(fleet, 'left') == []


def test_a_robot_that_starts_at_a_spot_keeps_it_and_goes_back_to_it(tmp_path):
    fleet = fleet_on(net_file(tmp_path, DEPOT, ('AB', 'BD', 'DE')), {'a': (0.0, 0.0), 's': SPOTS[0]})
    fleet.robot('s').send(20.0, 0.0)  # it is there
    fleet.robot('a').send(*SPOTS[0])
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[1], 's': SPOTS[0]}
    assert [row[:2] for row in rows(fleet, 'ended')] == [(0, 's'), (22, 'a')]
    fleet.robot('a').send(0.0, 0.0)
    fleet.run()
    fleet.robot('a').send(*SPOTS[2])
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[2], 's': SPOTS[0]}


def test_a_robot_at_the_point_of_a_node_drives_to_its_spot_and_one_that_is_placed_at_a_spot_has_that_one(tmp_path):
    fleet = fleet_on(net_file(tmp_path, DEPOT, ('AB', 'BD', 'DE')), {'a': (0.0, 0.0), 'd': (20.0, 0.0)})
    fleet.robot('d').send(20.0, 0.0)
    fleet.robot('a').send(20.0, 0.0)
    fleet.run(until=15.0)
    fleet.robot('a').place(Pose2D(*SPOTS[2]))
    fleet.run()
    assert stand(fleet) == {'a': SPOTS[2], 'd': SPOTS[0]}
    assert [row[:2] for row in rows(fleet, 'ended')] == [(2, 'd'), (15, 'a')]


@pytest.mark.parametrize('spots, words', [
    ([[0, 1], [0, 1.01]], 'a spot more than 0.02 m from the other spots'),
    ([[9, 0]], 'to which no other node is nearer'), ([[0, 1, 2]], 'a list of [x, y]')])
def test_spots_that_cannot_be_are_refused_in_words(spots, words):
    nodes = [{'name': 'a', 'x': 0, 'y': 0, 'spots': spots}, {'name': 'b', 'x': 10, 'y': 0}]
    with pytest.raises(ConfigurationError) as caught:
        make_lane_map({'nodes': nodes, 'edges': []})
    assert words in str(caught.value)


def test_there_are_as_many_spots_as_places():
    with pytest.raises(ConfigurationError, match='allowed: 2 spots'):
        make_lane_map({'nodes': [{'name': 'a', 'x': 0, 'y': 0, 'spots': [[0, 1]], 'capacity': 2}], 'edges': []})
