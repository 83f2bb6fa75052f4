"""Capacities that can lock, with blocks and groups: against fleets that drive, and by hand."""
import itertools
import random

import pytest
from night import times

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import read_scenario
from test_scenario_check import SQUARE, locks, ring, world_file

LINE = {'a': (0, 0), 'b': (5, 0), 'c': (10, 0), 'd': (15, 0)}


def with_rules(path, **rules):
    path.write_text(path.read_text() + ''.join('{}: {}\n'.format(*rule) for rule in rules.items()))
    return path


def circles(path, goals, begin_s=0.0):
    """Return how many circles close where each robot is sent to its goal, one after the other."""
    fleet = Fleet(read_scenario(path), start_ns=0)
    for number, (name, goal) in enumerate(goals):
        robot = fleet.robot(name)
        fleet.at(round(number * begin_s * 1e9), lambda _, robot=robot, goal=goal: robot.send(*map(float, goal)))
    fleet.run()
    return sum(entry.kind == 'deadlock' for entry in fleet.trace)


def test_who_looks_a_lane_ahead_meets_nobody_head_on_in_two_lanes_but_in_three(tmp_path):
    both = [{'name': 'r'}, {'name': 's', 'start_x': 15.0}]
    edges = [(*pair, {'capacity': 1}) for pair in ('ab', 'bc', 'cd')]
    two = world_file(tmp_path, (LINE, [*edges[:2], ('c', 'd', {})]), robots=both)
    assert locks(two) == [('lane a - b', 2)]
    assert locks(with_rules(two, blocks=2)) == []
    three = with_rules(world_file(tmp_path, (LINE, edges), robots=both), blocks=2)
    assert [count for _, count in locks(three)] == [2]
    assert circles(three, [('r', LINE['d']), ('s', LINE['a'])]) == 1
    assert locks(with_rules(world_file(tmp_path, (LINE, edges), robots=both), blocks=3)) == []


def test_in_a_ring_of_four_lanes_two_lock_that_look_a_lane_ahead(tmp_path):
    robots = [{'name': 'r' + name, 'start_x': x, 'start_y': y, 'robot_radius': 0.0} for name, (x, y) in SQUARE.items()]
    path = with_rules(world_file(tmp_path, ring(capacity=1), robots=robots), blocks=2)
    assert [count for _, count in locks(path)] == [2]
    assert circles(path, [('ra', SQUARE['d']), ('rc', SQUARE['b'])]) == 1


@pytest.mark.parametrize('room, fewest', [(None, None), (1, 2), (2, 3)])
def test_lanes_of_one_group_lock_with_the_lane_between_them(tmp_path, room, fewest):
    one_way = {'one_way': True, 'capacity': 9}
    group = one_way if room is None else {**one_way, 'group': 'g'}
    path = world_file(tmp_path, (LINE, [('a', 'b', group), ('b', 'c', {**one_way, 'capacity': 1}), ('c', 'd', group)]),
                      robots=[{'name': 'r', 'count': 4, 'robot_radius': 0.0}])
    with_rules(path, groups={'g': room or 1})
    assert [count for _, count in locks(path)] == ([fewest] if fewest else [])
    assert circles(path, [('r_{}'.format(number), LINE['d']) for number in range(fewest or 4)], 0.1) == bool(fewest)


def test_a_lane_with_more_room_than_its_group_is_never_full(tmp_path):
    group = {'capacity': 2, 'group': 'g'}
    path = world_file(tmp_path, (LINE, [('a', 'b', group), ('b', 'c', {'capacity': 1}), ('c', 'd', {})]),
                      robots=[{'name': 'r', 'count': 9, 'robot_radius': 0.0}])
    assert locks(path) == [('group g', 2)]  # with the group: with the lane it would take three


@pytest.mark.parametrize('seed', range(times(8, 24)))
def test_where_nothing_is_found_nothing_locks(tmp_path, seed):
    dice = random.Random(seed)
    nodes = {'n{}'.format(index): (10.0 * (index % 3) + dice.random(), 10.0 * (index // 3) + dice.random())
             for index in range(6)}
    pairs = [(a, b) for a, b in itertools.combinations(range(6), 2) if (b - a == 1 and b % 3) or b - a == 3]
    edges = [('n{}'.format(a), 'n{}'.format(b), {
        'one_way': dice.random() < 0.5, **({'capacity': dice.choice([1, 2])} if dice.random() < 0.6 else {}),
        **({'group': dice.choice('gh')} if dice.random() < 0.4 else {})}) for a, b in pairs]
    robots = [{'name': 'r{}'.format(index), 'start_x': x, 'start_y': y, 'robot_radius': 0.0,
               'max_speed': 0.5 + dice.random()}
              for index, (x, y) in enumerate(nodes.values())]
    path = with_rules(world_file(tmp_path, (nodes, edges), robots=robots), blocks=dice.choice([1, 2, 3]),
                      groups={'g': dice.choice([1, 2])})
    assert not any(closes_a_circle(path, dice, list(nodes.values()), robots) for _ in range(6)) or locks(path)


def closes_a_circle(path, dice, goals, robots):
    """Return whether any circle closes where each robot gets ten goals one after the other."""
    left = {one['name']: [dice.choice(goals) for _ in range(10)] for one in robots}

    def send(name, *_):
        if left[name]:
            fleet.robot(name).send(*left[name].pop())
    fleet = Fleet(read_scenario(path), start_ns=0, on_end=send)
    for name in left:
        send(name)
    fleet.run(3000 * 10 ** 9)
    return any(entry.kind == 'deadlock' for entry in fleet.trace)
