"""Places given so that no circle of waiting comes to be (deadlock: avoid): by brute force, and on nets that lock up."""
import itertools
import random
from types import SimpleNamespace

import pytest

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import read_scenario
from move_base_abstract.traffic.area import Area
from move_base_abstract.traffic.safe_states import SafeStates
from test_scenario_check import ring, world_file

SQUARE_OF = {'a': 'c', 'b': 'd', 'c': 'a', 'd': 'b'}


class Robot(SimpleNamespace):
    __hash__ = object.__hash__


def state_of(dice):
    """Return robots on areas, and one that asks for the first area that it needs, where that has room, or None."""
    areas = [Area('lane', str(number), dice.randint(1, 2)) for number in range(5)]
    robots = []
    for index in range(dice.randint(2, 5)):
        held = [area for area in dice.sample(areas, dice.randint(0, 1)) if area.has_room()]
        robots.append(Robot(index=index, request=None, wants=None, held=dict.fromkeys(held, True),
                            needs=tuple(dice.sample(areas, dice.randint(1, 3)))))
        for area in held:
            area.holders[robots[-1]] = True
    taker = next((one for one in robots if one.needs[0].has_room() and one.needs[0] not in one.held), None)
    return robots, taker


def able(robots, takes):
    """Return the largest set of robots that come to their goals one after the other in some order of all."""
    best = frozenset()
    for order in itertools.permutations(robots):
        holders = {one: [*one.held, *takes.get(one.index, ())] for one in robots}
        done = []
        for one in order:
            full = [area for area in one.needs if area not in holders[one] and area.capacity <= sum(
                area in held for other, held in holders.items() if other is not one)]
            if full:
                break
            holders[one] = []
            done.append(one.index)
        best = max(best, frozenset(done), key=len)
    return best


@pytest.mark.parametrize('seed', range(150))
def test_it_is_safe_where_some_order_brings_all_to_their_goals(seed):
    robots, taker = state_of(random.Random(seed))
    if taker is not None:
        takes = taker.needs[:1]
        before, after = able(robots, {}), able(robots, {taker.index: takes})
        assert SafeStates(robots).allows(taker, takes) == (
            before <= after and (taker.index in after or bool(taker.held)))


def run(path, policy, goals):
    """Send robots from goal to goal (x, y); return ({state: how many}, how many circles of waiting)."""
    path.write_text(path.read_text() + 'deadlock: {}\n'.format(policy))
    left = {name: list(own) for name, own in goals.items()}

    def send(robot):
        if left[robot]:
            fleet.robot(robot).send(*left[robot].pop(0))
    fleet = Fleet(read_scenario(path), on_end=lambda robot, *_: send(robot))
    for robot in fleet.names:
        send(robot)
    fleet.run(until=100_000.0)
    ended = [entry.values[1] for entry in fleet.trace if entry.kind == 'ended']
    return ended.count('SUCCEEDED'), [entry.kind for entry in fleet.trace].count('deadlock')


def test_a_ring_that_locks_up_does_not_with_avoid(tmp_path):
    places, _ = net = ring(capacity=1)
    robots = [{'name': name, 'start_x': places[name][0], 'start_y': places[name][1]} for name in 'abcd']
    goals = {name: [tuple(map(float, places[SQUARE_OF[name]]))] for name in 'abcd'}
    assert run(world_file(tmp_path, net, robots=robots), 'wait', goals) == (0, 1)
    assert run(world_file(tmp_path, net, robots=robots), 'avoid', goals) == (4, 0)


@pytest.mark.parametrize('seed', range(6))
def test_on_any_net_all_goals_at_nodes_come_to_their_end(tmp_path, seed):
    dice = random.Random(seed)
    nodes = {'n{}'.format(index): (10.0 * (index % 3) + dice.random(), 10.0 * (index // 3) + dice.random())
             for index in range(9)}
    pairs = [(a, b) for a, b in itertools.combinations(range(9), 2)
             if (b - a == 1 and b % 3) or b - a == 3]
    edges = [('n{}'.format(a), 'n{}'.format(b), {'capacity': 1}) for a, b in pairs]
    robots = [{'name': 'r{}'.format(index), 'start_x': x, 'start_y': y} for index, (x, y) in enumerate(nodes.values())]
    goals = {one['name']: [dice.choice(list(nodes.values())) for _ in range(8)] for one in robots}
    path = world_file(tmp_path, (nodes, edges), robots=robots)
    locked, circles = run(path, 'wait', goals)
    assert locked < 72 and circles  # each of these nets locks up
    assert run(world_file(tmp_path, (nodes, edges), robots=robots), 'avoid', goals) == (72, 0)
