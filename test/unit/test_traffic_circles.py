"""Circles of robots that wait for one another in zones: when they are named, and when there is none."""
import pytest

from move_base_abstract.traffic import circles
from test_traffic import GATE, NO_CONTROL, S, ends, fleet_of, state
from traces import rows


def test_who_waits_behind_one_that_waits_for_it_is_in_a_circle():
    zones = [CROSSING[0], dict(GATE, name='north', rectangle=[5, 0, 10, 10]),
             dict(GATE, name='south', rectangle=[5, -5, 10, 2.5])]
    fleet = fleet_of({'a': (6, -2), 'b': (1, 2)}, zones)
    fleet.robot('b').send(9, 2)
    fleet.run(5 * S)
    fleet.robot('a').send(6, 5)
    fleet.run(10 * S)
    assert rows(fleet, 'deadlock') == [(6.0, 'a', 'deadlock', 'a', 'zone north', 'b', 'zone south')]


CROSSING = [dict(GATE, name='west', rectangle=[0, 0, 5, 5]), dict(GATE, name='east', rectangle=[5, 0, 10, 5])]


@pytest.mark.parametrize('policy', ['wait', 'abort'])
def test_a_circle_of_waiting_is_named_once(policy):
    fleet = fleet_of({'a': (1, 1), 'b': (9, 2), 'c': (-3, 3)}, CROSSING, deadlock=policy)
    fleet.robot('a').send(9, 1)
    fleet.robot('b').send(1, 2)
    fleet.robot('c').send(3, 3)
    fleet.run(20 * S)
    assert rows(fleet, 'deadlock') == [(2.0, 'b', 'deadlock', 'a', 'zone east', 'b', 'zone west')]
    if policy == 'wait':
        assert ends(fleet) == {} and state(fleet, 0) == (('a',), ('c', 'b'))
        return
    assert ends(fleet) == {'b': (2.0, 'ABORTED')} and rows(fleet, 'ended')[0][5] == NO_CONTROL
    fleet.robot('b').send(20, 2)
    fleet.run()
    assert ends(fleet)['a'][1] == ends(fleet)['c'][1] == 'SUCCEEDED'


def test_no_circle_is_seen_where_one_may_go_on():
    room = [CROSSING[0], dict(CROSSING[1], capacity=2)]
    fleet = fleet_of({'a': (1, 1), 'b': (9, 2), 'd': (8, 4)}, room)
    fleet.robot('a').send(9, 1)
    fleet.robot('b').send(1, 2)
    fleet.run(10 * S)
    assert not rows(fleet, 'deadlock') and state(fleet, 1) == (('b', 'd'), ('a',))
    fleet.robot('d').send(20, 4)
    fleet.run()
    assert {state for _, state in ends(fleet).values()} == {'SUCCEEDED'}


def test_a_circle_that_closes_when_a_zone_is_opened_is_named_then():
    fleet = fleet_of({'a': (1, 1), 'b': (9, 2)}, CROSSING)
    fleet.close_zone('east')
    fleet.robot('a').send(9, 1)
    fleet.robot('b').send(1, 2)
    fleet.run(10 * S)
    assert not rows(fleet, 'deadlock')
    for closed in (False, True, False):
        fleet.close_zone('east', closed)
        fleet.run(10 * S)
    assert rows(fleet, 'deadlock') == [(10.0, 'a', 'deadlock', 'a', 'zone east', 'b', 'zone west')]


def test_a_circle_that_one_robot_too_many_cannot_open_by_leaving_is_named_when_it_closes():
    fleet = fleet_of({'a': (1, 1), 'b': (9, 2), 'c': (8, 4)}, CROSSING)  # one more in the east than there is place for
    for robot, x, y in (('a', 9, 1), ('b', 1, 2), ('c', 20, 4)):
        assert len(rows(fleet, 'deadlock')) == (robot == 'c')
        fleet.robot(robot).send(x, y)
        fleet.run_for(10.0)
    assert len(rows(fleet, 'deadlock')) == 1


def test_a_long_row_of_robots_goes_on_at_one_instant():
    row = [dict(GATE, name='z{}'.format(k), rectangle=[2 * k, -1, 2 * k + 2, 1]) for k in range(400)]
    fleet = fleet_of({'r{}'.format(k): (2 * k + 1, 0) for k in range(400)}, row)
    for k in range(399):
        fleet.robot('r{}'.format(k)).send(2 * k + 3, 0)
    fleet.run(10 * S)
    assert not ends(fleet)
    fleet.robot('r399').send(900, 0)
    fleet.run(12 * S)
    assert len(ends(fleet)) == 399 and set(ends(fleet).values()) == {(11.0, 'SUCCEEDED')}


def test_no_graph_is_made_for_a_robot_if_none_before_it_can_wait_for_it(monkeypatch):
    row = [dict(GATE, name='z{}'.format(k), rectangle=[2 * k, -1, 2 * k + 2, 1]) for k in range(20)]
    fleet = fleet_of({'r{}'.format(k): (2 * k + 1, 0) for k in range(20)}, row)
    graphs, make = [], circles.WaitingGraph
    monkeypatch.setattr(circles, 'WaitingGraph', lambda *arguments: graphs.append(arguments) or make(*arguments))
    for k in range(19):
        fleet.robot('r{}'.format(k)).send(2 * k + 3, 0)
    fleet.run()
    assert len(rows(fleet, 'held')) == 19 and len(graphs) == 1  # that of the standstill
