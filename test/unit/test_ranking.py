"""The coordinators of examples/ranking, and what is said of a ranking."""
import itertools
import math
import random
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'examples' / 'ranking'))
import compare_rankings  # noqa: E402
from dispatching import POLICIES, Dispatcher  # noqa: E402


def places(chance, count):
    """Return places at random [m]."""
    return [(chance.uniform(0, 30), chance.uniform(0, 30)) for _ in range(count)]


def drive(policy, starts, tasks, fails=lambda task, attempt: False):
    """Return (end [s], [(robot, task)]) of a mission with robots that are as fast as the coordinator thinks."""
    dispatcher, now, busy, begun = Dispatcher(policy, starts, tasks), 0.0, [], []
    while not dispatcher.over:
        places_before = [robot.place for robot in dispatcher.robots]
        for number, task in dispatcher.begin(now):
            begun.append((number, task))
            busy.append((now + dispatcher.seconds(places_before[number], task), number, task))
        now, number, task = min(busy)
        busy.remove((now, number, task))
        dispatcher.ended(number, not fails(task, begun.count((number, task))))
    return now, begun, dispatcher


@pytest.mark.parametrize('policy', POLICIES)
@pytest.mark.parametrize('robots', [1, 2, 5])
def test_every_task_is_done_once(policy, robots):
    chance = random.Random(robots)
    for count in (1, 3, 12):
        _, begun, dispatcher = drive(policy, places(chance, robots), places(chance, count))
        assert sorted(task for _, task in begun) == list(range(count))
        assert sorted(dispatcher.done) == list(range(count))


@pytest.mark.parametrize('policy', POLICIES)
def test_a_task_that_fails_is_tried_again_and_then_given_up(policy):
    chance = random.Random(4)
    _, begun, dispatcher = drive(policy, places(chance, 2), places(chance, 6), lambda task, _: task == 3)
    assert [task for _, task in begun].count(3) == 2
    assert (dispatcher.failed, len(dispatcher.done)) == ([3], 5)


def test_a_batch_has_the_least_sum_of_all_assignments():
    chance = random.Random(2)
    for _ in range(20):
        starts, tasks = places(chance, 3), places(chance, 4)
        pairs = Dispatcher('batch', starts, tasks).begin(0.0)
        costs = [[math.dist(start, task) for task in tasks] for start in starts]
        least = min(sum(costs[robot][task] for robot, task in enumerate(chosen))
                    for chosen in itertools.permutations(range(4), 3))
        assert sum(costs[robot][task] for robot, task in pairs) == pytest.approx(least)


def test_a_batch_counts_busy_robots_from_when_they_should_be_free():
    dispatcher = Dispatcher('batch', [(0.0, 0.0), (100.0, 0.0)], [(1.0, 0.0), (99.0, 0.0), (2.0, 0.0)])
    assert dispatcher.begin(0.0) == [(0, 0), (1, 1)]
    dispatcher.ended(1, True)
    assert dispatcher.begin(1.0) == []  # the other one is about to be free beside it


def test_nearest_and_farthest_are_opposites_and_the_fixed_order_is_fixed():
    starts, tasks = [(0.0, 0.0)], [(5.0, 0.0), (1.0, 0.0), (9.0, 0.0)]
    assert [task for _, task in drive('nearest_first', starts, tasks)[1]] == [1, 0, 2]
    assert [task for _, task in drive('farthest_first', starts, tasks)[1]] == [2, 1, 0]
    assert [task for _, task in drive('fixed_order', starts, tasks)[1]] == [0, 1, 2]
    assert [task for _, task in drive('auction', starts, tasks)[1]] == [1, 0, 2]


def missions(spread, shift=0.0, seed=0, repeats=8):
    """Return a table of missions whose means are 100 to 140 s by policy, with a spread [s]."""
    chance = np.random.default_rng(seed)
    rows = [(name, robots, policy, tasks,
             base + shift * at + 5.0 * tasks - 20.0 * robots + 3.0 * (name == 'b') + chance.normal(0.0, spread), 1)
            for name, robots, tasks in itertools.product('ab', (2, 3), (1, 2, 3))
            for at, (policy, base) in enumerate(zip('pqrst', (100.0, 110.0, 120.0, 130.0, 140.0)))
            for _ in range(repeats)]
    return pd.DataFrame(rows, columns=['map', 'robots', 'policy', 'tasks', 'mission_s', 'ended'])


def test_the_same_distribution_has_a_correlation_of_one_and_no_sign_is_wrong():
    chance = np.random.default_rng(0)
    real, simulated = missions(2.0), missions(2.0, seed=1, repeats=100)
    (srcc, _), (tau, _) = compare_rankings.with_intervals(real, simulated, chance)
    assert srcc > 0.99 and tau > 0.9
    certain, same = compare_rankings.pairs(real, simulated, chance)
    assert certain == same == 40
    inside, apart = compare_rankings.distributions(real, simulated)
    assert 0.85 < inside < 0.95 and apart < 0.12


def test_a_ranking_turned_round_is_seen_in_every_figure():
    chance = np.random.default_rng(0)
    real, simulated = missions(2.0), missions(2.0, shift=-20.0, seed=1, repeats=100)
    (srcc, _), (tau, _) = compare_rankings.with_intervals(real, simulated, chance)
    assert srcc < 0.3 and tau < 0.3
    assert compare_rankings.pairs(real, simulated, chance) == (40, 0)
    inside, apart = compare_rankings.distributions(real, simulated)
    assert inside < 0.4 and apart > 0.5


@pytest.mark.night  # 200 divisions into halves
def test_halves_of_noise_do_not_agree():
    noise = missions(2.0)
    noise['mission_s'] = np.random.default_rng(5).normal(100.0, 10.0, len(noise))
    srcc, tau = compare_rankings.ceiling(noise, np.random.default_rng(0))
    assert abs(srcc) < 0.5 and abs(tau) < 0.4
    assert compare_rankings.ceiling(missions(2.0), np.random.default_rng(0))[0] > 0.98


@pytest.mark.parametrize('spread, low, high', [(100.0, 0.0, 0.15), (1.0, 0.4, 0.8)])
def test_a_right_simulator_is_told_apart_if_repetitions_differ_less_than_seeds(spread, low, high):
    chance = np.random.default_rng(2)
    cell = {'map': 'a', 'robots': 2, 'policy': 'p', 'tasks': 1, 'ended': 1}
    real, simulated = (pd.DataFrame([{**cell, 'mission_s': 500.0 + width * chance.normal()} for _ in range(count)])
                       for count, width in ((4, spread), (200, 100.0)))
    simulated.loc[0] = {**cell, 'ended': 0, 'mission_s': 1e9}
    found = np.mean([compare_rankings.told_apart_if_right(real, simulated, chance) for _ in range(5)])
    assert low <= found <= high
