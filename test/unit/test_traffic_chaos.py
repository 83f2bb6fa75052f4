"""Zones under all that can be asked of robots, at any time: the rules hold after each step, and runs are repeatable."""
import random

from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000


class Chaos:
    """A fleet in which all is asked of robots at any time, and after each step the rules are looked at."""

    def __init__(self, seed):
        self._random = pick = random.Random(seed)
        zones = [{'name': 'z{}'.format(k), 'rectangle': [x, y, x + pick.randint(2, 8), y + pick.randint(2, 8)],
                  'capacity': pick.choice([1, 2])}
                 for k, (x, y) in enumerate((pick.randint(-8, 4), pick.randint(-8, 4)) for _ in range(5))]
        self.fleet = Fleet(make_scenario({
            'zones': zones, 'deadlock': pick.choice(['wait', 'abort', 'avoid', 'retreat']), 'robots': [
                {'name': 'r{}'.format(k), **dict(zip(('start_x', 'start_y'), self._place()))} for k in range(8)],
            'defaults': {'max_speed': 2.0, 'acceleration': pick.choice([0.0, 1.0]), 'turn_rate': 1.0}}), start_ns=0)
        for step in range(60):
            self.fleet.at(step * S + pick.choice([0, 0, 123456789]), self._step)
        self.fleet.run()
        self._check()
        self.held = sum(entry.kind == 'held' for entry in self.fleet.trace)

    def _place(self):
        return float(self._random.randint(-10, 10)), float(self._random.randint(-10, 10))

    def _step(self, fleet):
        name = self._random.choice(fleet.names)
        acts = [lambda: fleet.robot(name).send(*self._place())] * 6 + [
            lambda: fleet.robot(name).cancel(), lambda: fleet.robot(name).place(Pose2D(*self._place())),
            lambda: fleet.robot(name).hold('x'), lambda: fleet.robot(name).release('x'),
            lambda: fleet.close_zone('z0', self._random.random() < 0.5)]
        self._random.choice(acts)()
        self._check()

    def _check(self):
        fleet = self.fleet
        for zone, area in zip(fleet.scenario.zones, fleet.zones):
            for name in fleet.names:
                x, y = fleet.robot(name).pose.x, fleet.robot(name).pose.y
                inside = all(zone.contains(x + dx, y + dy) for dx in (-1e-5, 1e-5) for dy in (-1e-5, 1e-5))
                assert not inside or name in area.robots
                assert name not in area.robots or name not in area.waiting
        for name in fleet.names:
            waits = [area.name for area in fleet.zones if name in area.waiting]
            held = [reason for reason in fleet.robot(name).navigator.travel.held_for if reason != 'x']
            assert held == ([', '.join('zone ' + zone for zone in waits)] if waits else [])
            assert not waits or fleet.robot(name).navigator.is_active


def test_whatever_is_asked_of_robots_who_is_inside_has_a_place_and_who_waits_has_none():
    for seed in range(12):
        first, second = Chaos(seed), Chaos(seed)
        assert first.fleet.trace == second.fleet.trace and first.held > 0


def test_who_waits_and_is_put_into_the_full_zone_goes_on_from_inside():
    fleet = Fleet(make_scenario({
        'defaults': {'max_speed': 2.0}, 'zones': [{'name': 'gate', 'rectangle': [4, -1, 6, 1], 'capacity': 1}],
        'robots': [{'name': 'a', 'start_x': 5.0}, {'name': 'b'}]}))
    fleet.robot('b').send(10.0, 0.0)
    fleet.at(9 * S, lambda fleet: fleet.robot('b').place(Pose2D(5.5, 0.0)))
    fleet.run()
    assert [entry.kind for entry in fleet.trace if entry.robot == 'b' and entry.time_ns == 9 * S] == [
        'stands', 'entered', 'released', 'departed']
    assert fleet.trace[-1].values[1] == 'SUCCEEDED'
