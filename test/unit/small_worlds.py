"""Worlds of a few robots and a few lanes, most with places for one or two, drawn from a seed: robots lock up there."""
import json
import math
import random

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario

POLICIES = 'wait', 'abort', 'avoid', 'retreat'


class SmallWorld:
    """A net of 5 or 6 nodes on a ring and one in the middle, and 5 to 8 robots with up to three goals at nodes each."""

    def __init__(self, seed, folder):
        dice = self.dice = random.Random(seed)
        count = dice.choice([5, 6])
        nodes = {'n{}'.format(number): (round(10.0 * math.cos(2.0 * math.pi * number / count), 1),
                                        round(10.0 * math.sin(2.0 * math.pi * number / count), 1))
                 for number in range(count)}
        nodes['c'] = (0.0, 0.0)
        ring = [('n{}'.format(number), 'n{}'.format((number + 1) % count)) for number in range(count)]
        lanes = dice.sample(ring, count - 1) + [('c', name) for name in dice.sample(list(nodes)[:count], 3)]
        edges = [self._edge(one, other) for one, other in dice.sample(lanes, dice.randint(5, len(lanes)))]
        path = folder / 'net.yaml'
        path.write_text(json.dumps({'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in nodes.items()],
                                    'edges': edges}))
        self.raw = {'lanes': str(path), 'defaults': {'routes': 'lanes'}, 'blocks': dice.choice([1, 1, 2, 3]),
                    'deadlock': POLICIES[seed % 4], 'groups': {'g': dice.choice([1, 2]), 'h': 2}}
        if dice.random() < 0.3:
            self.raw['zones'] = [{'name': 'z', 'rectangle': [-6.0, -6.0, 3.0, 5.0], 'capacity': dice.choice([1, 2, 3])}]
        self.robots, self.goals = [], {}
        for number in range(dice.randint(5, 8)):
            x, y = dice.choice(list(nodes.values()))
            self.robots.append({'name': 'r_{}'.format(number), 'start_x': x, 'start_y': y,
                                'priority': dice.choice([0, 0, 1]), 'max_speed': dice.choice([0.5, 1.0, 1.0, 2.0])})
            self.goals['r_{}'.format(number)] = [dice.choice(list(nodes.values())) for _ in range(dice.randint(1, 3))]

    def _edge(self, one, other):
        dice = self.dice
        edge = {'from': one, 'to': other}
        if dice.random() < 0.75:
            edge['capacity'] = dice.choice([1, 1, 1, 2])
        if dice.random() < 0.3:
            edge['group'] = dice.choice('ggh')
        if dice.random() < 0.15:
            edge['one_way'] = True
        return edge

    def run(self, robots=None, until=None):
        """Run the world with its robots in the order of ``robots`` (None: as drawn); return the Fleet."""
        left = {name: list(goals) for name, goals in self.goals.items()}

        def send(name, *_):
            if left[name]:
                fleet.robot(name).send(*left[name].pop(0))
        fleet = Fleet(make_scenario({**self.raw, 'robots': robots or self.robots}), start_ns=0, on_end=send)
        for robot in robots or self.robots:
            send(robot['name'])
        fleet.run(until=until)
        return fleet


class LargeWorld(SmallWorld):
    """A grid of up to 25 nodes, some lanes of it in three groups, and 12 to 28 robots with six goals each."""

    def __init__(self, seed, folder):
        dice = random.Random(seed)
        width, height = dice.choice([(4, 4), (5, 4), (5, 5), (6, 3)])
        nodes = {(x, y): ('n{}_{}'.format(x, y), 10.0 * x + dice.random(), 10.0 * y + dice.random())
                 for x in range(width) for y in range(height)}
        edges = []
        for x, y in nodes:
            for other in ((x + 1, y), (x, y + 1)):
                if other in nodes and dice.random() < 0.85:
                    edges.append({'from': nodes[x, y][0], 'to': nodes[other][0], 'capacity': dice.choice([1, 1, 1, 2])})
                    if dice.random() < 0.3:
                        edges[-1]['group'] = dice.choice('ghk')
        path = folder / 'net.yaml'
        path.write_text(json.dumps({'nodes': [{'name': name, 'x': x, 'y': y} for name, x, y in nodes.values()],
                                    'edges': edges}))
        places = [(x, y) for _, x, y in nodes.values()]
        starts = [dice.choice(places) for _ in range(dice.randint(12, 28))]
        self.robots = [{'name': 'r{}'.format(number), 'start_x': x, 'start_y': y, 'priority': dice.choice([0, 0, 1]),
                        'max_speed': 0.5 + dice.random()} for number, (x, y) in enumerate(starts)]
        self.goals = {robot['name']: [dice.choice(places) for _ in range(6)] for robot in self.robots}
        self.raw = {'lanes': str(path), 'defaults': {'routes': 'lanes'}, 'deadlock': 'retreat',
                    'blocks': dice.choice([1, 1, 2, 3]),
                    'groups': {'g': dice.choice([1, 2, 3]), 'h': dice.choice([2, 3]), 'k': 4}}
