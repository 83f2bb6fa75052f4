"""Processes on the clock of a fleet behave as those of SimPy, and robots can be used in them. The tests need SimPy."""
import random

import pytest
import simpy

from move_base_abstract import Environment, Fleet, make_scenario
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.tasks.arrivals import Task

S = 1_000_000_000


def make(*robots, **more):
    named = [{'name': name, 'max_speed': 2.0} for name in robots]
    return Environment(make_scenario({'robots': named, **more}))


class Shop:
    """Processes that use all parts of SimPy on each other; ``seen`` has what happened."""

    def __init__(self, env, seed):
        self.env, self.seen, self.chance = env, [], random.Random(seed)
        self.desk = simpy.PriorityResource(env, capacity=2)
        self.store = simpy.Store(env, capacity=3)
        self.tank = simpy.Container(env, capacity=10, init=5)
        self.bell = env.event()
        self.workers = [env.process(self.worker(number)) for number in range(8)]
        env.process(self.troublemaker())

    def note(self, *what):
        self.seen.append((round(self.env.now, 9), *what))

    def worker(self, number):
        while True:
            try:
                yield self.env.timeout(self.chance.randrange(4) / 4)
                with self.desk.request(priority=self.chance.randrange(3)) as mine:
                    got = yield mine | self.env.timeout(self.chance.randrange(1, 5) / 4)
                    self.note('desk', number, mine in got)
                    if mine in got:
                        yield self.env.timeout(0.5)
                yield self.store.put(number) if number % 2 else self.store.get() | self.env.timeout(0.75)
                yield self.tank.put(2) | self.env.timeout(0.25) if number % 3 else self.tank.get(1)
                self.note('done', number, self.tank.level, len(self.store.items))
                yield self.bell & self.env.timeout(0.25)
                self.note('rang', number)
            except simpy.Interrupt as interrupt:
                self.note('interrupted', number, interrupt.cause)

    def troublemaker(self):
        for count in range(40):
            yield self.env.timeout(0.5)
            bell, self.bell = self.bell, self.env.event()
            bell.succeed(count)
            victim = self.chance.choice(self.workers)
            victim.interrupt(count)
            self.env.process(self.passer_by(count))

    def passer_by(self, count):
        self.note('comes', count)
        yield self.env.timeout(0)
        self.note('goes', count)


@pytest.mark.parametrize('seed', range(20))
@pytest.mark.parametrize('until', [15, 7.25])
def test_processes_do_what_those_of_simpy_do(seed, until):
    own, theirs = Shop(make(), seed), Shop(simpy.Environment(), seed)
    for shop in (own, theirs):
        shop.env.run(until=until)
    assert len(own.seen) > 100
    assert own.seen == theirs.seen
    assert own.env.now == theirs.env.now == until


@pytest.mark.parametrize('seed', range(5))
def test_robots_and_onlookers_change_nothing_for_processes(seed):
    env = make('a', 'b')
    shop = Shop(env, seed)

    def wander(robot, chance):
        while True:
            yield robot.go(chance.uniform(-5, 5), chance.uniform(-5, 5))
    for robot in env.robots:
        env.process(wander(robot, random.Random(seed)))
    alone = Shop(make(), seed)
    for one in (shop, alone):
        one.env.run(until=10)
    assert [entry[1:] for entry in shop.seen] == [entry[1:] for entry in alone.seen]


def test_a_process_that_waits_for_goals_does_what_a_callback_does():
    env = make('bot')
    corners = [(10.0, 0.0), (10.0, 7.5), (0.0, 7.5), (0.0, 0.0)]
    outcomes = []

    def drive(bot):
        for x, y in corners:
            outcomes.append((yield bot.go(x, y)))
    env.process(drive(env.robot('bot')))
    env.run()

    left = list(corners)
    fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0}, 'robots': [{'name': 'bot'}]}), start_ns=0,
                  on_end=lambda *_: left and fleet.robot('bot').send(*left.pop(0)))
    fleet.robot('bot').send(*left.pop(0))
    fleet.run()
    assert env.fleet.trace == fleet.trace
    assert [outcome.time_ns for outcome in outcomes] == [5 * S, 5 * S + 3_750_000_000, 13_750_000_000, 17_500_000_000]
    assert all(outcome.succeeded for outcome in outcomes)


def test_goals_that_fail_or_are_replaced_say_so():
    env = make('bot')
    bot = env.robot('bot')

    def drive():
        first = bot.go(10.0, 0.0)
        yield env.timeout(1.0)
        second = bot.go(float('nan'), 0.0)
        both = yield first & second
        return [both[one].state for one in (first, second)] + [(yield bot.go(2.0, 0.0)).succeeded]
    assert env.run(env.process(drive())) == [GoalState.PREEMPTED, GoalState.ABORTED, True]
    assert env.now == 1.0
    assert (bot.pose.x, bot.activity, bot.state_of_charge, bot.distance_to(2.0, 3.0)) == (2.0, 'idle', None, 3.0)


def test_tasks_at_places_and_zones_can_be_waited_for():
    env = make('bot', places=[{'name': 'dock', 'x': 4.0, 'y': 0.0}],
               zones=[{'name': 'gate', 'polygon': [[1, -1], [2, -1], [2, 1], [1, 1]], 'capacity': 1}])
    bot = env.robot('bot')
    seen = []

    def watch():
        entry = yield bot.when('entered', 'zone gate')
        seen.append((env.now, entry.kind, entry.values))
        entry = yield bot.when('left')
        seen.append((env.now, entry.kind, entry.values))

    def drive():
        yield bot.go(4.0, 0.0)
        outcome = yield bot.work(Task('t1', 0, 'dock', bot.pose, 3 * S))
        seen.append((env.now, outcome.goal_id, outcome.state))
    env.process(watch())
    env.run(env.process(drive()))
    assert seen == [(0.5, 'entered', ('zone gate',)), (1.0, 'left', ('zone gate',)), (5.0, 't1', GoalState.SUCCEEDED)]
    with pytest.raises(ConfigurationError, match="robot 'bot': when: enterd: .*did you mean 'entered'"):
        bot.when('enterd')


def test_until_is_a_time_to_come_an_event_or_the_end():
    env = make('bot')
    for until in (0, -1.0, 'soon'):
        with pytest.raises((ValueError, ConfigurationError)):
            env.run(until=until)
    with pytest.raises(RuntimeError, match='has not happened'):
        env.run(env.event())
    timeout = env.timeout(2.0, 'value')
    assert (env.run(timeout), env.run(timeout), env.now) == ('value', 'value', 2.0)
    env.robot('bot').go(2.0, 0.0)
    env.step()  # it has departed
    assert (env.peek(), env.run(), env.now, env.peek()) == (3.0, None, 3.0, float('inf'))
    with pytest.raises(simpy.core.EmptySchedule):
        env.step()


def test_what_a_process_raises_comes_out_of_run_and_leaves_the_rest_in_order():
    env = make('bot')

    def fails():
        yield env.robot('bot').go(2.0, 0.0)
        raise LookupError('of a process')
    env.process(fails())
    with pytest.raises(LookupError, match='of a process'):
        env.run()
    assert env.now == 1.0
    assert env.run(env.timeout(1.0)) is None
    assert env.now == 2.0


def test_times_are_kept_to_the_nanosecond():
    env = make()

    def third():
        for _ in range(1000):
            yield env.timeout(1 / 3)
    env.run(env.process(third()))
    assert env.fleet.now_ns == 1000 * 333_333_333
    with pytest.raises(ValueError, match='simulated time ends'):
        env.timeout(1e18)
    with pytest.raises(ValueError):
        env.timeout(float('inf'))


def test_a_robot_that_is_removed_ends_its_goal_and_does_nothing_more():
    env = make('bot')
    robot = env.robot('bot')
    going = robot.go(9.0, 0.0)
    env.run(until=1.0)
    env.fleet.remove('bot')
    assert env.run(going).state is GoalState.ABORTED
    for use in (lambda: robot.go(1.0, 0.0), lambda: robot.when('ended')):
        with pytest.raises(ConfigurationError, match="robot 'bot' was removed from its fleet"):
            use()
