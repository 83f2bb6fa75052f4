"""Robots that get stuck: where, how their goals end, what sets them free; and the distance field of a map."""
import math

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import NO_CONTROL
from move_base_abstract.maps.clearance import ClearanceField, clearance_at
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from traces import rows_of_one as rows

S = 1_000_000_000


def wall():
    """Return a map of 20 m x 10 m with one occupied cell, whose lower edge is at (10, 5.4)."""
    cells = np.zeros((100, 200), np.int8)
    cells[54, 100] = 100
    return OccupancyMap(cells, 0.1, Pose2D())


def fleet_of(occupancy=None, on_end=None, **settings):
    return Fleet(make_scenario({
        'seed': 1, 'defaults': {'max_speed': 2.0, 'failure_kind': 'stuck', **settings},
        'robots': [{'name': 'bot', 'start_x': 2.0, 'start_y': 5.0}]}), 0, on_end, occupancy=occupancy)


def test_each_goal_of_a_robot_that_is_stuck_is_given_up_after_some_seconds():
    fleet = fleet_of(failure_times=[3.0])
    fleet.robot('bot').send(18.0, 5.0)
    fleet.run()
    fleet.run(20 * S)
    fleet.robot('bot').send(2.0, 5.0)
    fleet.run()
    assert rows(fleet, 'ended') == [(9.4, 'ended', 'bot-1', 'ABORTED', NO_CONTROL.text),
                                    (26.4, 'ended', 'bot-2', 'ABORTED', NO_CONTROL.text)]
    assert fleet.robot('bot').pose == Pose2D(8.0, 5.0)
    assert rows(fleet, 'failed') == [(3.0, 'failed', 'stuck', 'script')]
    assert fleet.robot('bot').activity == 'failed: stuck' and not rows(fleet, 'repaired')


def test_a_goal_that_is_replaced_or_cancelled_is_not_given_up():
    fleet = fleet_of(failure_times=[3.0])
    fleet.robot('bot').send(18.0, 5.0)
    fleet.run(8 * S)
    fleet.robot('bot').send(2.0, 5.0)
    fleet.run(14 * S)
    assert [row[2:4] for row in rows(fleet, 'ended')] == [('bot-1', 'PREEMPTED')]
    fleet.robot('bot').cancel()
    fleet.run()
    assert [row[2:4] for row in rows(fleet, 'ended')] == [('bot-1', 'PREEMPTED'), ('bot-2', 'PREEMPTED')]


@pytest.mark.parametrize('how', ['place', 'repair', 'reset', 'time'])
def test_it_comes_free_when_it_is_moved_or_repaired(how):
    repair = {'repair_distribution': 'fixed', 'repair_time': 4.0} if how == 'time' else {}
    fleet = fleet_of(failure_times=[3.0], **repair)
    fleet.robot('bot').send(18.0, 5.0)
    fleet.run(7 * S)
    {'place': lambda: fleet.robot('bot').place(Pose2D(10.0, 5.0)), 'repair': lambda: fleet.robot('bot').repair(),
     'reset': fleet.reset, 'time': lambda: None}[how]()
    assert [row[0] for row in rows(fleet, 'repaired')] == [7.0]
    fleet.run()
    if how == 'reset':
        assert rows(fleet, 'ended')[0][3] == 'ABORTED'
    else:
        end = 11.0 if how == 'place' else 12.0
        assert rows(fleet, 'ended') == [(end, 'ended', 'bot-1', 'SUCCEEDED', 'Goal reached.')]


def test_placed_where_it_is_it_stays_stuck():
    fleet = fleet_of(failure_times=[3.0])
    fleet.robot('bot').send(18.0, 5.0)
    fleet.run(7 * S)
    fleet.robot('bot').place(Pose2D(8.0, 5.0, 1.0))
    fleet.run()
    assert not rows(fleet, 'repaired') and rows(fleet, 'ended')[0][3] == 'ABORTED'


def test_it_gets_stuck_where_its_way_is_nearest_to_what_is_occupied():
    own = {'use_map': True, 'stuck_by_clearance': [[0.46, 1.0], [0.5, 0.0]]}
    fleet = fleet_of(wall(), **own)
    fleet.robot('bot').send(18.0, 5.0)
    fleet.run()
    (at, _, *why), = rows(fleet, 'failed')
    assert why == ['stuck', 'clearance'] and at == pytest.approx(4.0, abs=0.06)
    fleet.robot('bot').repair()
    fleet.robot('bot').send(18.0, 4.0)  # further off
    fleet.run()
    assert rows(fleet, 'ended')[-1][3] == 'SUCCEEDED'


def test_set_free_on_its_way_it_is_not_stuck_there_again():
    fleet = fleet_of(wall(), use_map=True, stuck_by_clearance=[[0.46, 1.0], [0.5, 0.0]])
    fleet.robot('bot').send(18.0, 5.0)
    fleet.run(6 * S)
    fleet.robot('bot').repair()
    fleet.run()
    assert len(rows(fleet, 'failed')) == 1 and rows(fleet, 'ended')[0][3] == 'SUCCEEDED'


def test_how_often_it_comes_is_the_chance_of_the_clearance():
    left = list(range(400))
    stuck = []

    def send(*_ended):
        if left:
            fleet.robot('bot').place(Pose2D(2.0, 5.0))
            stuck.append(len(rows(fleet, 'failed')))
            left.pop()
            fleet.robot('bot').send(18.0, 5.0)
    fleet = fleet_of(wall(), send, use_map=True, stuck_by_clearance=[[0.0, 0.8], [0.8, 0.0]])  # 0.45 m: 0.35
    send()
    fleet.run()
    assert len(rows(fleet, 'failed')) / 400 == pytest.approx(0.35, abs=0.06)


@pytest.mark.parametrize('settings, words', [
    ({'stuck_by_clearance': [[0.4, 1.0]]}, 'use_map: false'),
    ({'stuck_by_clearance': [[0.4, 1.0]], 'failure_kind': 'stall', 'use_map': True}, 'failure_kind: stall'),
    ({'stuck_by_clearance': [[0.4, 1.0]], 'failure_kind': 'none', 'use_map': True},
     "got 'none' with stuck_by_clearance"),
    ({'stuck_by_clearance': [[0.4, 1.1]], 'use_map': True}, 'chance in 0..1'), ({'stuck_patience': -1.0}, 'patience')])
def test_what_does_not_fit_together_is_refused(settings, words):
    with pytest.raises(ConfigurationError, match=words):
        fleet_of(**settings)


# ---- the distance field


@pytest.mark.parametrize('seed', range(6))
def test_the_field_is_the_distance_to_the_nearest_occupied_cell(seed):
    chance = np.random.default_rng(seed)
    cells = np.where(chance.random((17, 23)) < 0.03, 100, 0).astype(np.int8)
    cells[chance.random((17, 23)) < 0.1] = -1
    occupancy = OccupancyMap(cells, 0.5, Pose2D(3.0, -2.0, 0.0))
    limit = 2.3
    field = ClearanceField(occupancy, limit)
    occupied = list(zip(*np.nonzero(cells == 100)))
    for row in range(17):
        for column in range(23):
            x, y = occupancy.from_cells(column + 0.5, row + 0.5)
            wanted = min([limit] + [0.5 * math.hypot(*(max(0.0, abs(off) - 0.5) for off in (column - one, row - other)))
                                    for other, one in occupied])
            assert field._field[row, column] == pytest.approx(wanted, abs=1e-5)
            assert clearance_at(occupancy, x, y, limit) == pytest.approx(wanted, abs=1e-9)


def test_the_least_clearance_of_a_way_and_where_it_is():
    field = ClearanceField.on(wall(), 1.0)
    assert field.least_along([(2.0, 5.05), (10.05, 5.05), (10.05, 1.0)]) == (
        pytest.approx(0.35, abs=1e-6), pytest.approx(8.05, abs=0.06))
    assert field.least_along([(2.0, 1.0), (18.0, 1.0)]) == (1.0, 0.0)
    assert field.least_along([(-1e6, 5.45), (1e6, 5.45)])[0] == 0.0
    assert field.least_along([(2.0, 50.0), (18.0, 50.0)]) == (1.0, 0.0)
