"""The present of a simulation: it only goes forward, and everything due has happened before it moves on."""

import pytest

from move_base_abstract.common.errors import TimeError
from move_base_abstract.engine.simulation import Simulation


def test_the_present_is_where_it_began_and_then_where_it_was_advanced_to():
    simulation = Simulation(now_ns=7)
    seen = [simulation.now_ns]
    for now_ns in (7, 9, 9, 20):
        simulation.advance(now_ns)
        seen.append(simulation.now_ns)
    assert seen == [7, 7, 9, 9, 20]


def test_during_an_event_the_present_is_the_events_own_time():
    simulation = Simulation(now_ns=10)
    seen = []
    for due_ns in (12, 5, 15):
        simulation.queue.schedule(due_ns, 0, lambda due, now: seen.append((due, now, simulation.now_ns)))
    simulation.advance(20)
    assert (seen, simulation.now_ns) == ([(5, 20, 10), (12, 20, 12), (15, 20, 15)], 20)


def test_time_does_not_go_back_and_what_is_due_stays_due():
    simulation = Simulation(now_ns=10)
    lines = []
    simulation.queue.schedule(12, 0, lambda due, now: lines.append((due, now)))
    with pytest.raises(TimeError, match='time must not go back: it is 10 ns, got 9 ns'):
        simulation.advance(9)
    assert (simulation.now_ns, simulation.next_due_ns(), lines) == (10, 12, [])
    simulation.advance(12)
    assert (simulation.next_due_ns(), lines) == (None, [(12, 12)])


@pytest.mark.parametrize('frequency, period_ns', [(20.0, 50_000_000), (30.0, 33_333_333), (0.1, 10_000_000_000),
                                                  (3e9, 1)])
def test_a_series_of_a_frequency_has_the_nearest_whole_period(frequency, period_ns):
    simulation = Simulation()
    lines = []
    simulation.series(0, frequency, lambda due, _now: lines.append(due)).start(1)
    for k in range(4):
        simulation.advance(1 + k * period_ns)
    assert lines == [1, 1 + period_ns, 1 + 2 * period_ns, 1 + 3 * period_ns]


def test_a_series_is_not_started_by_itself_and_there_is_none_of_frequency_zero():
    simulation = Simulation()
    assert simulation.series(0, 0.0, lambda _due, _now: None) is None
    assert simulation.series(0, 1.0, lambda _due, _now: None) is not None
    assert simulation.next_due_ns() is None
