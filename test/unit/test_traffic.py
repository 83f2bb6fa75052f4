"""Zones and lanes with place for some robots only: who waits where, for how long, in which order, and what is off."""
import itertools
import json

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.planning import StraightLinePlanner
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import check_one_process, make_scenario
from move_base_abstract.traffic.area import Area
from traces import rows

S = 1_000_000_000
NO_CONTROL = 'Failed to find a valid control. Even after executing recovery behaviors.'
GATE = {'name': 'gate', 'rectangle': [4, -50, 6, 50], 'capacity': 1}


def fleet_of(robots, zones=(GATE,), **more):
    """Return a Fleet at time 0; ``robots`` {name: (x, y)}, in the order of their indices, all at 2 m/s."""
    return Fleet(make_scenario({
        'defaults': {'max_speed': 2.0}, 'zones': list(zones), **more,
        'robots': [{'name': name, 'start_x': float(x), 'start_y': float(y)} for name, (x, y) in robots.items()]}),
        start_ns=0)


def ends(fleet):
    return {entry.robot: (entry.time_ns / S, entry.values[1]) for entry in fleet.trace if entry.kind == 'ended'}


def state(fleet, number=0):
    """Return (holders, waiting) of a zone."""
    area = fleet.zones[number]
    return area.robots, area.waiting


# ---- one zone

def test_who_comes_second_waits_at_the_border_until_the_first_has_left():
    fleet = fleet_of({'a': (0, 0), 'b': (0, 1)})
    fleet.robot('a').send(10, 0)
    fleet.run(S // 2)
    fleet.robot('b').send(10, 1)
    fleet.run(11 * S // 4)
    assert (fleet.robot('b').pose.x, state(fleet)) == (pytest.approx(4.0, abs=1e-8), (('a',), ('b',)))
    fleet.run()
    assert rows(fleet, 'held', 'released', 'entered', 'left') == [
        (2.0, 'a', 'entered', 'zone gate'), (2.5, 'b', 'held', 'zone gate'), (3.0, 'a', 'left', 'zone gate'),
        (3.0, 'b', 'entered', 'zone gate'), (3.0, 'b', 'released'), (4.0, 'b', 'left', 'zone gate')]
    assert ends(fleet) == {'a': (5.0, 'SUCCEEDED'), 'b': (6.0, 'SUCCEEDED')}


def test_who_finds_a_place_does_not_stop():
    fleet = fleet_of({'a': (0, 0), 'b': (0, 1)}, [dict(GATE, capacity=2)])
    for name, y in (('a', 0), ('b', 1)):
        fleet.robot(name).send(10, y)
    fleet.run()
    assert ends(fleet) == {'a': (5.0, 'SUCCEEDED'), 'b': (5.0, 'SUCCEEDED')} and not rows(fleet, 'held')


def test_first_come_is_first_served_and_at_one_instant_by_name():
    robots = {'z': (0, 0), 'b_10': (-1, 1), 'b_2': (-1, 2), 'a': (-0.5, 3)}
    for order in itertools.permutations(robots):
        fleet = fleet_of({name: robots[name] for name in order})
        for name in order:
            fleet.robot(name).send(10, robots[name][1])
        fleet.run()
        assert [row[1] for row in rows(fleet, 'entered')] == ['z', 'a', 'b_2', 'b_10']


def test_a_place_that_is_given_back_at_an_instant_can_be_taken_in_it():
    fleet = fleet_of({'b': (-2, 1), 'a': (0, 0)})
    for name, y in (('a', 0), ('b', 1)):
        fleet.robot(name).send(10, y)
    fleet.run()
    assert not rows(fleet, 'held') and ends(fleet)['b'] == (6.0, 'SUCCEEDED')


def test_who_has_its_goal_inside_keeps_the_place_and_who_starts_inside_has_one():
    fleet = fleet_of({'a': (5, 0), 'b': (0, 1)})
    assert state(fleet) == (('a',), ())
    fleet.robot('b').send(5, 1)
    fleet.run(10 * S)
    assert state(fleet) == (('a',), ('b',))
    fleet.robot('a').send(10, 0)
    fleet.run()
    assert state(fleet) == (('b',), ()) and ends(fleet)['b'] == (11.0, 'SUCCEEDED')


def test_more_than_there_is_place_for_may_stand_inside_and_none_comes_before_they_have_left():
    fleet = fleet_of({'a': (5, 0), 'b': (5, 1), 'c': (0, 2)})
    fleet.robot('c').send(10, 2)
    fleet.robot('a').send(10, 0)
    fleet.run(5 * S)
    assert state(fleet) == (('b',), ('c',))
    fleet.robot('b').place(Pose2D(20.0))
    fleet.run(5 * S)  # it is decided at the end of the instant who comes in
    assert state(fleet) == (('c',), ())
    fleet.robot('b').place(Pose2D(5.0))
    assert state(fleet) == (('b', 'c'), ())


def test_a_robot_that_is_taken_away_gives_its_place_back():
    fleet = fleet_of({'a': (5, 0), 'b': (0, 1)})
    fleet.robot('b').send(10, 1)
    fleet.run(3 * S)
    fleet.remove('a')
    fleet.run(3 * S)
    assert state(fleet) == (('b',), ())


def test_who_is_let_in_and_has_no_way_any_more_gives_the_place_back():
    class Planner(StraightLinePlanner):
        goes_straight = False

        def corners(self, start, goal):
            return () if self.leads else None
    planner = Planner()
    planner.leads = True
    fleet = Fleet(make_scenario({'zones': [GATE], 'robots': [
        {'name': name, 'start_x': x} for name, x in (('a', 5.0), ('b', 0.0))]}), start_ns=0, planner=planner)
    fleet.robot('b').send(10, 0)
    fleet.run(20 * S)
    fleet.robot('a').send(10, 0)
    planner.leads = False
    fleet.run()
    assert ends(fleet)['b'][1] == 'ABORTED' and state(fleet) == ((), ())


@pytest.mark.parametrize('how', ['cancel', 'newer goal', 'place', 'remove', 'reset'])
def test_who_gives_up_waiting_leaves_the_queue(how):
    fleet = fleet_of({'a': (5, 0), 'b': (0, 1)})
    robot = fleet.robot('b')
    robot.send(10, 1)
    fleet.run(3 * S)
    assert state(fleet) == (('a',), ('b',))
    {'cancel': robot.cancel, 'newer goal': lambda: robot.send(0, 1), 'remove': lambda: fleet.remove('b'),
     'place': lambda: robot.place(Pose2D(8.0, 1.0)), 'reset': fleet.reset}[how]()
    fleet.run()
    assert state(fleet) == (('a',), ())
    assert how != 'cancel' or robot.pose.x == pytest.approx(4.0, abs=1e-8)
    if how in ('newer goal', 'place'):
        assert ends(fleet)['b'] == ({'newer goal': 5.0, 'place': 4.0}[how], 'SUCCEEDED')


@pytest.mark.parametrize('give_up', [lambda robot: robot.cancel(), lambda robot: robot.send(-5, 0)])
def test_who_is_let_in_while_something_else_holds_it_and_gives_up_gives_the_place_back(give_up):
    fleet = fleet_of({'a': (5, 0), 'b': (0, 0), 'c': (-20, 0)})
    fleet.robot('b').send(5, 0)
    fleet.run(3 * S)
    fleet.robot('b').hold('pause')
    fleet.robot('a').send(10, 0)
    fleet.run(8 * S)
    assert state(fleet) == (('b',), ()) and fleet.robot('b').pose.x == 4.0
    give_up(fleet.robot('b'))
    assert state(fleet) == ((), ())
    fleet.robot('c').send(5, 0)
    fleet.run()
    assert ends(fleet)['c'][1] == 'SUCCEEDED'


def test_who_is_stopped_inside_keeps_the_place_and_who_turns_round_at_the_border_leaves():
    fleet = fleet_of({'a': (0, 0), 'b': (0, 1)})
    fleet.robot('a').send(10, 0)
    fleet.run(5 * S // 2)
    fleet.robot('a').cancel()
    assert state(fleet) == (('a',), ())
    fleet.robot('a').send(4, 0)  # to the border
    fleet.run()
    assert state(fleet) == ((), ())


def test_a_closed_zone_lets_nobody_in_and_those_inside_out():
    fleet = fleet_of({'a': (5, 0), 'b': (0, 1)}, [dict(GATE, capacity=None)])
    fleet.close_zone('gate')
    fleet.robot('a').send(10, 0)
    fleet.robot('b').send(10, 1)
    fleet.run(10 * S)
    assert (state(fleet), fleet.zones[0].closed) == (((), ('b',)), True)
    fleet.close_zone('gate', closed=False)
    fleet.run()
    assert ends(fleet) == {'a': (2.5, 'SUCCEEDED'), 'b': (13.0, 'SUCCEEDED')}
    with pytest.raises(ConfigurationError, match="zone 'gaet' is unknown; there are: gate"):
        fleet.close_zone('gaet')


def test_a_robot_that_fails_on_its_way_fails_at_the_same_place_however_often_it_is_held():
    driven = []
    for zones in ((), (GATE,)):
        fleet = fleet_of({'a': (5, 0), 'b': (0, 1)}, zones)
        fleet.add('c', start_y=2.0, max_speed=2.0, failure_by_length=[[0.0, 1.0]], seed=5)
        fleet.robot('c').send(100, 2)
        if zones:  # it asks again at once
            fleet.at(10 * S, lambda fleet: fleet.robot('c').place(Pose2D(4.0, 2.5)))
        fleet.at(20 * S, lambda fleet: fleet.robot('a').send(20, 0))
        fleet.run()
        driven.append(fleet.robot('c').distance)
        assert ends(fleet)['c'][1] == 'ABORTED'
    assert len(rows(fleet, 'held')) == 2
    assert driven[0] == pytest.approx(driven[1], abs=1e-6) and driven[0] > 8.0


# ---- several zones

ROW = [dict(GATE, name=name, rectangle=[x, -50, x + 2, 50]) for name, x in (('one', 2), ('two', 4), ('three', 6))]


def test_who_waits_at_the_end_of_a_zone_for_the_next_one_keeps_its_place():
    fleet = fleet_of({'a': (5, 0), 'b': (0, 1), 'c': (-2, 2)}, ROW)
    fleet.robot('b').send(10, 1)
    fleet.robot('c').send(10, 2)
    fleet.run(10 * S)
    assert [state(fleet, number) for number in range(3)] == [(('b',), ('c',)), (('a',), ('b',)), ((), ())]
    fleet.robot('a').send(10, 0)
    fleet.run()
    assert ends(fleet) == {'a': (12.5, 'SUCCEEDED'), 'b': (13.5, 'SUCCEEDED'), 'c': (14.5, 'SUCCEEDED')}


def test_zones_that_begin_at_the_same_place_are_entered_together_or_not_at_all():
    both = [GATE, dict(GATE, name='wide', rectangle=[4, -50, 8, 50])]
    fleet = fleet_of({'a': (7, 0), 'b': (0, 1)}, both)
    fleet.robot('b').send(10, 1)
    fleet.run(10 * S)
    assert rows(fleet, 'held') == [(2.0, 'b', 'held', 'zone gate, zone wide')]
    assert state(fleet, 0) == ((), ('b',)) and state(fleet, 1) == (('a',), ('b',))


def test_nobody_overtakes_also_where_the_first_one_waits_for_another_zone_as_well():
    zones = [GATE, dict(GATE, name='low', rectangle=[4, -50, 8, 3]), dict(GATE, name='high', rectangle=[4, 5, 8, 50])]
    fleet = fleet_of({'g': (5, 4), 'l': (7, 0), 'h': (7, 10), 'c': (0, 10), 'b': (-2, 0), 'd': (-4, 4)}, zones)
    for name, y in (('c', 10), ('b', 0)):
        fleet.robot(name).send(20, y)
    fleet.run(5 * S)
    fleet.robot('g').send(20, 4)  # the gate is free, but c, who is first there, waits for h
    fleet.robot('d').send(20, 4)
    fleet.run(10 * S)
    fleet.robot('l').send(30, 0)
    fleet.run(20 * S)
    assert state(fleet) == ((), ('c', 'b', 'd')) and [row[1] for row in rows(fleet, 'held')] == ['c', 'b', 'd']
    fleet.robot('h').send(20, 10)
    fleet.run()
    assert [row[1] for row in rows(fleet, 'entered') if row[3] == 'zone gate'] == ['g', 'c', 'b', 'd']


def test_states_are_those_of_all_areas_and_made_anew_only_where_anything_has_changed(monkeypatch):
    row = [dict(GATE, name='z{}'.format(k), rectangle=[2 * k, -1, 2 * k + 2, 1]) for k in range(100)]
    fleet = fleet_of({'a': (-2, 0), 'b': (-4, 0)}, row)
    made, make, looks = [], Area.state, []

    def look():
        made.clear()
        looks.append(fleet.zones)
        assert len(made) <= 4 and looks[-1] == [make(area) for area in fleet.traffic.areas()]
    assert len(fleet.zones) == 100
    monkeypatch.setattr(Area, 'state', lambda area: made.append(area) or make(area))
    fleet.traffic.follow(look)
    for name in ('a', 'b'):
        fleet.robot(name).send(300, 0)
    fleet.run()
    assert len(looks) > 100 and len(ends(fleet)) == 2


# ---- lanes

@pytest.fixture
def lanes_fleet(tmp_path):
    """Return a function that makes a Fleet on a row of nodes 10 m apart, joined by lanes for one robot each."""
    def make(robots, *edges):
        nodes = [{'name': str(k), 'x': 10 * k, 'y': 0} for k in range(4)]
        pairs = [{'from': str(k), 'to': str(k + 1), 'capacity': 1} for k in range(3)]
        path = tmp_path / 'lanes.yaml'
        path.write_text(json.dumps({'nodes': nodes, 'edges': [*pairs, *edges]}))
        return fleet_of(robots, (), lanes=str(path), defaults={'routes': 'lanes', 'max_speed': 2.0})
    return make


def test_a_lane_for_one_is_driven_by_one_in_whichever_direction(lanes_fleet):
    fleet = lanes_fleet({'a': (0, 0), 'b': (10, 0)})
    fleet.robot('a').send(10, 0)
    fleet.robot('b').send(0, 0)
    fleet.run()
    assert rows(fleet, 'entered', 'left', 'held') == [
        (0.0, 'a', 'entered', 'lane 0 - 1'), (0.0, 'b', 'held', 'lane 0 - 1'), (5.0, 'a', 'left', 'lane 0 - 1'),
        (5.0, 'b', 'entered', 'lane 0 - 1'), (10.0, 'b', 'left', 'lane 0 - 1')]
    assert ends(fleet) == {'a': (5.0, 'SUCCEEDED'), 'b': (10.0, 'SUCCEEDED')}


def test_who_waits_at_a_node_for_the_next_lane_keeps_the_one_behind(lanes_fleet):
    fleet = lanes_fleet({'a': (10, 0), 'b': (0, 0), 'c': (-1, 0)})
    fleet.robot('a').send(15, 0)  # in the middle of a lane, where it stays
    fleet.robot('b').send(30, 0)
    fleet.robot('c').send(10, 0)
    fleet.run(20 * S)
    assert [state(fleet, number) for number in range(3)] == [(('b',), ('c',)), (('a',), ('b',)), ((), ())]
    fleet.robot('a').place(Pose2D(50.0))
    fleet.run()
    assert ends(fleet) == {'a': (2.5, 'SUCCEEDED'), 'b': (30.0, 'SUCCEEDED'), 'c': (25.0, 'SUCCEEDED')}


def test_who_turns_where_it_stands_on_a_lane_keeps_its_place(lanes_fleet):
    fleet = lanes_fleet({'a': (0, 0)})
    for yaw in (0.0, 1.0):
        fleet.robot('a').send(5, 0, yaw)
        fleet.run()
    assert state(fleet) == (('a',), ())


def test_head_on_in_a_row_of_lanes_is_a_circle(lanes_fleet):
    fleet = lanes_fleet({'a': (0, 0), 'b': (20, 0)})
    fleet.robot('a').send(20, 0)
    fleet.robot('b').send(0, 0)
    fleet.run()
    assert rows(fleet, 'deadlock') == [(5.0, 'b', 'deadlock', 'a', 'lane 1 - 2', 'b', 'lane 0 - 1')]


# ---- what is off, and what is refused

def test_without_zones_the_log_is_the_same_to_the_byte():
    def log(**more):
        fleet = fleet_of({'a': (0, 0), 'b': (10, 0)}, **more)
        for number in range(20):
            fleet.at(number * S, lambda fleet, number=number: fleet.robot('ab'[number % 2]).send(number, number % 3))
        fleet.run()
        return fleet.trace
    assert log(zones=()) == log(zones=[dict(GATE, rectangle=[100, 100, 101, 101])])


def test_places_are_counted_in_one_process(lanes_fleet):
    for scenario in (make_scenario({'zones': [GATE]}), lanes_fleet({'a': (0, 0)}).scenario):
        check_one_process(scenario, 1, '/fleet')
        with pytest.raises(ConfigurationError, match='/fleet/parts: got 3 with .*; allowed: 1'):
            check_one_process(scenario, 3, '/fleet')
    check_one_process(make_scenario({}), 3, '/fleet')
    driven = make_scenario({'robots': [{'name': 'a', 'count': 2, 'driven_by': 'velocities'}]})
    with pytest.raises(ConfigurationError, match='robots that are driven by velocities stop one another'):
        check_one_process(driven, 3, '/fleet')


def test_what_deadlock_may_be():
    with pytest.raises(ConfigurationError, match="'push'; allowed: 'wait', 'abort', 'avoid' or 'retreat'"):
        make_scenario({'deadlock': 'push'})
