"""Waiting for a zone against queueing theory: M/M/1, M/M/c, M/G/1, and each single wait against its recursion.

Robots come to a zone in a Poisson stream, stay as long as is drawn, and leave. Each run is a fixed row of numbers: the
intervals are of 99 %, from the means of independent replications (Student's t).
"""
import math
import random
from collections import deque
from statistics import mean, stdev

import pytest

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.traffic.area import Request

REPLICATIONS, CUSTOMERS, POOL, WARM_UP = 10, 500, 120, 50
T_99 = 3.250  # Student's, of 9 degrees of freedom, two-sided
SPEED = 1000.0  # m/s: coming in and going out takes nearly no time


def served(capacity, rate, draw, seed, late=0.0):
    """Return [(arrival [s], wait [s], service [s]), ...] of CUSTOMERS robots at a zone, in the order of arrival.

    ``rate`` [1/s] of the Poisson arrivals; ``draw(generator)`` how long [s] each stays; ``late``: how much longer [s].
    """
    idle, inside, services, now = deque(), {}, {}, 0.0
    generator = random.Random(seed)

    def come(fleet, service):
        robot = idle.popleft()
        inside[robot] = services[robot, fleet.now_ns] = service
        fleet.robot(robot).send(1.0, 0.0)

    def ended(robot, _goal, _state, _text, now_ns):
        if robot in inside:
            leave_ns = now_ns + round((inside.pop(robot) + late) * NS_PER_S)
            fleet.at(leave_ns, lambda fleet: fleet.robot(robot).send(-1.0, 0.0))
        else:
            idle.append(robot)
    fleet = Fleet(make_scenario({
        'defaults': {'max_speed': SPEED, 'start_x': -1.0}, 'robots': [{'name': 'r', 'count': POOL}],
        'zones': [{'name': 'shop', 'rectangle': [0, -5, 10, 5], 'capacity': capacity}]}), start_ns=0, on_end=ended)
    idle.extend(fleet.names)
    for _ in range(CUSTOMERS):
        now += generator.expovariate(rate)
        service = draw(generator)
        fleet.at(round(now * NS_PER_S), lambda fleet, service=service: come(fleet, service))
    fleet.run()
    return customers(fleet.trace, services)


def customers(trace, services):
    """Return what :func:`served` does, from the log."""
    found, came = [], {}
    for entry in trace:
        if (entry.robot, entry.time_ns) in services and entry.kind == 'departed':
            came[entry.robot] = entry.time_ns
        elif entry.kind == 'entered':
            arrival_ns = came[entry.robot] + round(NS_PER_S / SPEED)
            found.append((arrival_ns / NS_PER_S, (entry.time_ns - arrival_ns) / NS_PER_S,
                          services[entry.robot, came[entry.robot]]))
    return sorted(found)


def check_mean(expected, capacity, rate, draw, late=0.0):
    """Assert that the mean wait is ``expected`` [s] within 99 %."""
    means = [mean(wait for _, wait, _ in served(capacity, rate, draw, seed, late)[WARM_UP:])
             for seed in range(REPLICATIONS)]
    half = T_99 * stdev(means) / math.sqrt(len(means))
    assert abs(mean(means) - expected) <= half, (mean(means), half, expected)


def check_each(capacity, rate, draw, late=0.0):
    """Assert that each wait is that of first come, first served (Kiefer and Wolfowitz: Trans. AMS 78, 1955)."""
    free = [0.0] * capacity
    for arrival, wait, service in served(capacity, rate, draw, 1, late):
        begin = max(arrival, free[0])
        assert wait == pytest.approx(begin - arrival, abs=3.0 * CUSTOMERS / SPEED)
        free = sorted([*free[1:], begin + service])


def exponential(generator):
    return generator.expovariate(0.01)  # 100 s in the mean


def general(generator):
    return generator.uniform(0.0, 200.0)  # likewise


def erlang_c(servers, load):
    """Return the chance that a customer waits in M/M/c, ``load`` the offered one (Erlang)."""
    busy = load ** servers / math.factorial(servers) / (1.0 - load / servers)
    return busy / (sum(load ** number / math.factorial(number) for number in range(servers)) + busy)


QUEUES = {
    'M/M/1': (0.5 / 0.5 * 100.0, 1, 0.005, exponential),
    'M/M/3': (erlang_c(3, 2.1) * 100.0 / (3 - 2.1), 3, 0.021, exponential),
    # Pollaczek and Khinchine: rate E[S^2] / (2 (1 - load))
    'M/G/1': (0.005 * 200.0 ** 2 / 3.0 / (2.0 * (1.0 - 0.5)), 1, 0.005, general),
}


@pytest.mark.parametrize('queue', ['M/M/3', pytest.param('M/M/1', marks=pytest.mark.night),
                                   pytest.param('M/G/1', marks=pytest.mark.night)])
def test_the_mean_wait_is_that_of_theory(queue):
    check_mean(*QUEUES[queue])


@pytest.mark.parametrize('queue', QUEUES)
def test_each_wait_is_that_of_first_come_first_served(queue):
    check_each(*QUEUES[queue][1:])


def driven_through(rate, seed, customers_count=400):
    """Return [(arrival [s], wait [s]), ...] of robots that drive through a zone for one in 100 s, at an even speed."""
    idle, arrivals, waits = deque(), [], {}
    generator, now = random.Random(seed), 0.0

    def come(fleet):
        robot = idle.popleft()
        fleet.robot(robot).place(Pose2D(-1.0))
        arrivals.append((fleet.now_ns + NS_PER_S, robot))  # at the border
        fleet.robot(robot).send(102.0, 0.0)
    fleet = Fleet(make_scenario({
        'defaults': {'max_speed': 1.0, 'start_x': -9.0}, 'robots': [{'name': 'r', 'count': 60}],
        'zones': [{'name': 'bridge', 'rectangle': [0, -5, 100, 5], 'capacity': 1}]}), start_ns=0,
        on_end=lambda robot, *_: idle.append(robot))
    idle.extend(fleet.names)
    for _ in range(customers_count):
        now += generator.expovariate(rate)
        fleet.at(round(now * NS_PER_S), come)
    fleet.run()
    for entry in fleet.trace:
        if entry.kind == 'entered':
            waits.setdefault(entry.robot, deque()).append(entry.time_ns)
    return [(arrival_ns / NS_PER_S, (waits[robot].popleft() - arrival_ns) / NS_PER_S) for arrival_ns, robot in arrivals]


def test_robots_that_drive_through_wait_as_in_a_queue_with_even_service():
    means, free = [], 0.0
    for seed in range(REPLICATIONS):
        waits = driven_through(0.005, seed)
        means.append(mean(wait for _, wait in waits[WARM_UP:]))
        free = 0.0
        for arrival, wait in waits:
            assert wait == pytest.approx(max(0.0, free - arrival), abs=1e-5)
            free = arrival + wait + 100.0
    assert abs(mean(means) - 50.0) <= T_99 * stdev(means) / math.sqrt(len(means))  # 100 s load / (2 (1 - load))


def test_a_place_that_is_given_back_late_shows():
    for check, queue in ((check_mean, QUEUES['M/M/1']), (check_each, QUEUES['M/M/1'][1:])):
        with pytest.raises(AssertionError):
            check(*queue, late=60.0)


def test_an_order_that_is_reversed_shows(monkeypatch):
    monkeypatch.setattr(Request, '__lt__', lambda one, other: one.key > other.key)
    with pytest.raises(AssertionError):
        check_each(*QUEUES['M/M/1'][1:])
