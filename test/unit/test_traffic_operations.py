"""All that can be asked of robots while they are led out of jams: no error, no place too full, nobody held for ever."""
import math
import random

import pytest
import yaml
from night import times

from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from tiny_nets import APART, Instance, instance, is_solvable

S = 1_000_000_000
CLEARED_S = 150  # when nothing holds robots any more but they one another


class Operations:
    """A fleet on a tiny net, of which something is asked at random instants; then all get goals anew."""

    def __init__(self, seed, folder):
        self._dice = dice = random.Random(seed)
        self.one, path = instance(seed), folder / 'net.yaml'
        path.write_text(yaml.safe_dump(self.one.net(node_capacity=1)))
        raw = self.one.scenario(path, has_zones=False, deadlock='avoid')
        self.nodes = {name: (APART * x, APART * y) for name, (x, y) in self.one.nodes.items()}
        x, y = dice.choice(list(self.nodes.values()))
        zone = {'name': 'z', 'rectangle': [x - 4.0, y - 4.0, x + 4.0, y + 4.0]}
        self._settings = {**raw['defaults'], 'failure_kind': 'stall'}
        self.fleet = Fleet(make_scenario({**raw, 'zones': [zone], 'defaults': self._settings}), start_ns=0)
        self._lanes = str(path)
        self.concerned = {}  # {(robot, instant [ns]) of an operation: True}
        for name, (_, goal) in self.one.robots.items():
            self.fleet.robot(name).send(*self.nodes[goal])
        for _ in range(dice.randint(3, 14)):  # most of them when robots come to nodes
            self.fleet.at(dice.choice([dice.randint(1, 80) * S] * 2 + [dice.randint(S, 80 * S)]), self._operate)
        self.fleet.at(CLEARED_S * S, self._clear)
        self.fleet.run()

    def _operate(self, fleet):
        dice, point = self._dice, self._dice.choice(list(self.nodes.values()))
        robot = fleet.robot(dice.choice(fleet.names))
        self.concerned[robot.name, fleet.now_ns] = True
        dice.choice([lambda: robot.send(*point)] * 3 + [
            robot.cancel, lambda: robot.place(Pose2D(*point)), lambda: robot.hold('x'), lambda: robot.release('x'),
            lambda: robot.fail(dice.choice(['stall', 'silent', 'stuck', 'abort']), dice.choice([None, 10.0])),
            robot.repair, lambda: fleet.close_zone('z', dice.random() < 0.7), lambda: self._change(robot.name, point),
            lambda: robot.set_priority(dice.randint(0, 2)),
            lambda: fleet.set_zone_limit('z', dice.choice([0.5, None]))])()

    def _change(self, name, point):
        """Take a robot out, or add one; not the last, and at most four."""
        fleet = self.fleet
        if len(fleet.names) > 2 and self._dice.random() < 0.7:
            fleet.remove(name)
        elif len(fleet.names) < 4:
            name = 'new_{}'.format(fleet.now_ns)
            self.concerned[name, fleet.now_ns] = True
            fleet.add(name, start_x=point[0], start_y=point[1], lanes=self._lanes, **self._settings)
            fleet.robot(name).send(*self._dice.choice(list(self.nodes.values())))

    def _clear(self, fleet):
        fleet.close_zone('z', False)
        for robot in fleet.robots:
            robot.release('x')
            robot.repair()

    def overfull(self):
        """Return (instant [ns], area) of each area that holds more robots after an instant than it has room for.

        Areas count where the last robot came by an operation at that instant.
        """
        room, inside, found = {}, {}, []
        trace = self.fleet.trace
        for row, following in zip(trace, [*trace[1:], None]):
            if row.kind == 'places':
                room[row.values[0]] = row.values[1]
            elif row.kind == 'entered':
                inside.setdefault(row.values[0], []).append((row.robot, row.time_ns))
            elif row.kind == 'left':
                inside[row.values[0]] = [one for one in inside[row.values[0]] if one[0] != row.robot]
            if following is None or following.time_ns != row.time_ns:
                found += [(row.time_ns, area) for area, robots in inside.items() if len(robots) > room.get(area, 9)
                          and robots[-1] not in self.concerned]
        return found

    def stand_at(self):
        """Return {robot: its node}, or None if one is at none, or at that of another one."""
        found = {}
        for robot in self.fleet.robots:
            found[robot.name] = next((name for name, (x, y) in self.nodes.items() if math.hypot(
                x - robot.pose.x, y - robot.pose.y) < 0.01), None)
        return found if None not in found.values() and len({*found.values()}) == len(found) else None

    def errors(self):
        """Return the texts that tell an error of ours."""
        return [one.text for one in self.fleet.warnings if 'error of move_base_abstract' in one.text] + [
            row.values[2] for row in self.fleet.trace if row.kind == 'ended' and 'cannot be worked on' in row.values[2]]


# 9, 24, 28, 60: a robot with moves yet to make is placed elsewhere, on its way or while it is held
@pytest.mark.parametrize('seed', [*range(times(20, 3_000)), *times([24, 28, 60], [])])
def test_robots_come_to_their_goals_whatever_was_asked_of_them_before(tmp_path, seed):
    world = Operations(seed, tmp_path)
    starts, fleet = world.stand_at(), world.fleet
    goals = dict(zip(fleet.names, random.Random(seed).sample(list(world.nodes), len(fleet.names))))
    for name, goal in goals.items():
        fleet.robot(name).send(*world.nodes[goal])
    fleet.run()
    assert not world.errors()
    assert not world.overfull()
    if starts is not None:
        robots = {name: (start, goals[name]) for name, start in starts.items()}
        assert (world.stand_at() == goals) == is_solvable(Instance(world.one.nodes, world.one.edges, robots, False))
