"""The life of a task that takes a while: how it ends, how long it takes, what is told on the way."""
import pytest

from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.goals.ledger import GoalLedger
from move_base_abstract.goals.outcome import NODE_KILLED
from move_base_abstract.tasks.timed_task import DrawnDurations, TimedTaskRunner

S = 10 ** 9


class Rig:
    """One robot's tasks; ``trace`` gets (time [s], what, details)."""

    def __init__(self, duration=1.0, spread=0.0, seed=0, robot=0, progress_frequency=0.0):
        self.trace = []
        self.simulation = Simulation()
        ledger = GoalLedger(lambda: None, self._ended, 'made_{}'.format)
        self.tasks = TimedTaskRunner(
            self.simulation, robot, ledger, DrawnDurations(duration, spread, seed, robot), self._began,
            lambda _record, elapsed_ns, duration_ns, now_ns: self._note(now_ns, 'progress', elapsed_ns / duration_ns),
            progress_frequency)

    def _note(self, now_ns, *what):
        self.trace.append((now_ns / S,) + what)

    def _began(self, record, duration_ns, now_ns):
        self._note(now_ns, 'began', record.goal_id, duration_ns / S)

    def _ended(self, record, stamp_ns):
        self._note(stamp_ns, record.state.name, record.goal_id, self.tasks.elapsed_ns(stamp_ns) / S)

    def at(self, seconds):
        self.simulation.advance(seconds_to_ns(seconds))
        return seconds_to_ns(seconds)

    def send(self, seconds, goal_id='a', duration=0.0):
        now_ns = self.at(seconds)
        self.tasks.receive(goal_id, now_ns, seconds_to_ns(duration), now_ns)


def test_a_task_takes_as_long_as_its_goal_says():
    rig = Rig()
    rig.send(2.0, duration=2.5)
    rig.at(10.0)
    assert rig.trace == [(2.0, 'began', 'a', 2.5), (4.5, 'SUCCEEDED', 'a', 2.5)]


def test_a_goal_that_does_not_say_gets_the_servers_duration():
    rig = Rig(duration=3.0)
    rig.send(1.0)
    rig.at(10.0)
    assert rig.trace == [(1.0, 'began', 'a', 3.0), (4.0, 'SUCCEEDED', 'a', 3.0)]


def test_a_cancelled_task_ends_at_once_and_says_how_long_it_took():
    rig = Rig()
    rig.send(1.0, duration=5.0)
    rig.tasks.cancel('a', 0, rig.at(3.0))
    rig.at(10.0)
    assert rig.trace[1:] == [(3.0, 'PREEMPTED', 'a', 2.0)]


def test_a_newer_goal_ends_the_one_under_way():
    rig = Rig()
    rig.send(1.0, 'a', 5.0)
    rig.send(2.0, 'b', 5.0)
    rig.at(20.0)
    assert rig.trace == [(1.0, 'began', 'a', 5.0), (2.0, 'PREEMPTED', 'a', 1.0), (2.0, 'began', 'b', 5.0),
                         (7.0, 'SUCCEEDED', 'b', 5.0)]


def test_a_negative_duration_is_refused_and_ends_the_task_under_way():
    rig = Rig()
    rig.send(1.0, 'a', 5.0)
    rig.send(2.0, 'b', -1.0)
    rig.at(20.0)
    assert rig.trace[1:] == [(2.0, 'PREEMPTED', 'a', 1.0), (2.0, 'ABORTED', 'b', 0.0)]


def test_progress_is_told_at_its_frequency_and_at_the_end():
    rig = Rig(progress_frequency=2.0)
    rig.send(0.0, duration=1.0)
    for quarters in range(20):
        rig.at(0.25 * quarters)
    assert rig.trace == [(0.0, 'began', 'a', 1.0), (0.0, 'progress', 0.0), (0.5, 'progress', 0.5),
                         (1.0, 'progress', 1.0), (1.0, 'SUCCEEDED', 'a', 1.0)]


def test_a_task_that_would_end_after_the_end_of_time_is_aborted_at_once():
    for duration in (2_147_483_647 - 2.0, 2_147_483_647.0):
        rig = Rig(duration=1e18, progress_frequency=2.0)
        rig.send(3.0, duration=duration)
        rig.send(4.0, goal_id='drawn')
        assert [line[1:3] for line in rig.trace] == [('ABORTED', 'a'), ('ABORTED', 'drawn')]
        assert rig.simulation.next_due_ns() is None
    rig = Rig()
    rig.send(3.0, duration=2_147_483_644.0)
    rig.at(2_147_483_647)
    assert rig.trace[-1] == (2_147_483_647.0, 'SUCCEEDED', 'a', 2_147_483_644.0)


def test_a_killed_server_ends_its_task():
    rig = Rig()
    rig.send(1.0, duration=5.0)
    rig.tasks.shut_down(NODE_KILLED, rig.at(2.0))
    rig.at(20.0)
    assert rig.trace[1:] == [(2.0, 'ABORTED', 'a', 1.0)]


def test_drawn_durations_lie_in_their_range_and_spread_over_it():
    drawn = DrawnDurations(2.0, 0.5, 7, 0)
    values = [drawn.draw_ns() for _ in range(200)]
    assert min(values) >= 1.5 * S
    assert max(values) <= 2.5 * S
    assert max(values) - min(values) > 0.8 * S


def test_durations_depend_on_seed_and_robot_alone():
    def first(seed, robot):
        drawn = DrawnDurations(2.0, 0.5, seed, robot)
        return [drawn.draw_ns() for _ in range(5)]
    assert first(1, 0) == first(1, 0)
    assert len({tuple(first(seed, robot)) for seed in range(3) for robot in range(3)}) == 9


@pytest.mark.parametrize('spread', [-0.1, 2.1, float('nan')])
def test_a_spread_beyond_the_duration_is_refused(spread):
    with pytest.raises(ValueError, match='0..2 s'):
        DrawnDurations(2.0, spread, 0, 0)
