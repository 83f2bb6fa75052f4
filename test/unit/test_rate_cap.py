"""Caps in wall time: how many of the ticks that come at or near the capped rate are let through."""
import random

import pytest

from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.supervision.rate_cap import RateCap


def yeses(rate, times):
    cap = RateCap(rate)
    return sum(cap.ready(now) for now in times)


def test_ticks_at_the_very_rate_all_pass_however_much_early_and_late_they_are():
    generator = random.Random(7)
    times = [0.2 * number + generator.uniform(-0.045, 0.045) for number in range(1000)]
    assert yeses(5.0, times) == 1000


def test_a_tick_that_is_a_hair_early_passes():
    assert yeses(5.0, [0.0, 0.2 - 1e-9, 0.4 - 2e-9]) == 3


@pytest.mark.parametrize('tick_rate', [5.5, 7.5, 11.0, 100.0, 1000.0])
def test_of_faster_ticks_nearly_as_many_pass_as_the_cap_allows_and_never_more(tick_rate):
    count = yeses(5.0, [number / tick_rate for number in range(int(100 * tick_rate))])
    assert 470 <= count <= 502


def test_after_a_pause_nothing_is_made_up_for():
    cap = RateCap(5.0)
    assert cap.ready(0.0)
    assert [cap.ready(100.0 + 0.01 * number) for number in range(20)].count(True) == 2


def test_the_longer_period_counts():
    cap = RateCap(5.0)
    assert sum(cap.ready(number * 0.1, shortest_period=1.0) for number in range(100)) == 11


def test_what_remains_is_how_long_the_answer_is_no():
    cap = RateCap(5.0)
    assert cap.remaining(3.0) == 0.0
    assert cap.ready(3.0)
    assert not cap.ready(3.0 + 0.99 * cap.remaining(3.0))
    assert cap.ready(3.0 + cap.remaining(3.0))


@pytest.mark.parametrize(('factor', 'expected'), [(0.5, 25), (1.0, 50), (1.02, 50), (2.0, 50), (100.0, 50)])
def test_a_series_behind_a_cap_of_its_own_rate_comes_at_that_rate_of_the_wall_or_of_the_simulation(factor, expected):
    """As the heartbeat of the status: 5 Hz simulated, at most 5 Hz of the wall; the clock is seen every 10 ms or so."""
    generator = random.Random(1)
    simulation, cap, told, wall = Simulation(), RateCap(5.0), [], 0.0

    def beat(due_ns, _now_ns):
        if cap.ready(wall):
            told.append(due_ns)
        return int(cap.remaining(wall) * factor * 1e9)

    simulation.series(0, 5.0, beat).start(0)
    while wall < 10.0:
        simulation.advance(int(wall * factor * 1e9))
        wall += generator.uniform(0.001, 0.02)
    assert expected - 1 <= len(told) <= expected + 2
