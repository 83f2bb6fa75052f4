"""Speed limits of zones and robots: how fast robots drive, how long it takes, what a change does at its instant."""
import json
import math
import random

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario
from traces import rows

S = 1_000_000_000
SLOW = {'name': 'slow', 'rectangle': [4, -5, 8, 5], 'max_speed': 0.5}


def fleet_of(zones, robots=('a',), more=None, **defaults):
    return Fleet(make_scenario({'defaults': {'max_speed': 2.0, **defaults}, 'zones': zones, **(more or {}), 'robots': [
        {'name': name, 'start_y': float(number)} for number, name in enumerate(robots)]}), start_ns=0)


@pytest.mark.parametrize('corners', ['keep', 'stop'])
def test_robots_drive_at_most_as_fast_as_the_zone_says_and_do_not_stop_at_its_border(corners):
    fleet = fleet_of([SLOW], corners=corners)
    fleet.robot('a').send(10.0, 0.0)
    fleet.run()
    assert rows(fleet, 'entered', 'left', 'ended', 'stands') == [
        (2.0, 'a', 'entered', 'zone slow'), (10.0, 'a', 'left', 'zone slow'), (11.0, 'a', 'stands', 10.0, 0.0, 0.0),
        (11.0, 'a', 'ended', 'a-1', 'SUCCEEDED', 'Goal reached.')]


def test_with_an_acceleration_nobody_stops_at_a_border_whatever_happens_at_corners():
    ended = []
    for corners in ('keep', 'stop'):
        fleet = fleet_of([SLOW], corners=corners, acceleration=1.0)
        fleet.robot('a').send(10.0, 0.0)
        fleet.run()
        ended.append(rows(fleet, 'ended')[0][0])
    assert ended[0] == ended[1] == pytest.approx(oracle([SLOW], 10.0, 2.0, 1.0), abs=0.01)


def oracle(zones, goal, top, rate, step=0.0005):
    """Return how long a drive along x takes [s], and the speed at each step: two passes over a fine grid."""
    count = round(goal / step)
    most = [top * top] * (count + 1)
    for number in range(count):
        middle = (number + 0.5) * step
        for zone in zones:
            if zone['rectangle'][0] < middle < zone['rectangle'][2]:
                for side in (number, number + 1):
                    most[side] = min(most[side], zone['max_speed'] ** 2)
    most[0] = most[-1] = 0.0
    for order in (range(count), range(count, 0, -1)):
        for number in order:
            after = number + 1 if order.step > 0 else number - 1
            most[after] = min(most[after], most[number] + 2.0 * rate * step)
    speeds = [math.sqrt(one) for one in most]
    return sum(2.0 * step / (one + other) for one, other in zip(speeds, speeds[1:]))


@pytest.mark.parametrize('seed', range(6))
def test_a_drive_takes_as_long_as_two_passes_over_a_fine_grid_say(seed):
    dice = random.Random(seed)
    zones = []
    for number in range(4):
        x = round(dice.uniform(1.0, 15.0), 2)
        zones.append({'name': 'z{}'.format(number), 'rectangle': [x, -5, x + round(dice.uniform(0.5, 6.0), 2), 5],
                      'max_speed': round(dice.uniform(0.2, 2.5), 2)})
    rate = dice.choice([0.5, 1.0, 3.0])
    fleet = fleet_of(zones, acceleration=rate)
    fleet.robot('a').send(20.0, 0.0)
    fleet.run()
    assert rows(fleet, 'ended')[0][0] == pytest.approx(oracle(zones, 20.0, 2.0, rate), abs=0.01)


def test_the_least_of_all_limits_counts_that_of_a_lane_included(tmp_path):
    path = tmp_path / 'net.yaml'
    path.write_text(json.dumps({'nodes': [{'name': 'a', 'x': 0, 'y': 0}, {'name': 'b', 'x': 10, 'y': 0}],
                                'edges': [{'from': 'a', 'to': 'b', 'speed': 1.0, 'length': 20.0, 'capacity': 1}]}))
    zones = [dict(SLOW, max_speed=0.4), dict(SLOW, name='wide', rectangle=[2, -5, 8, 5], max_speed=0.8)]
    fleet = fleet_of(zones, more={'lanes': str(path)}, routes='lanes')
    fleet.robot('a').send(10.0, 0.0)
    fleet.run()
    assert rows(fleet, 'ended')[0][0] == pytest.approx(2 / 0.5 + 2 / 0.5 + 4 / 0.4 + 2 / 0.5)
    assert [row[3] for row in rows(fleet, 'left')] == ['zone slow', 'zone wide', 'lane a - b']


def test_who_is_in_a_zone_or_will_be_goes_on_by_its_new_limit_at_once():
    fleet = fleet_of([SLOW, dict(SLOW, name='off', rectangle=[0, 50, 1, 51])], 'abc')
    for number, name in enumerate('ab'):
        fleet.robot(name).send(10.0, float(number))
    fleet.at(1 * S, lambda fleet: fleet.robot('c').send(3.0, 2.0))  # which never comes there
    fleet.at(4 * S, lambda fleet: fleet.set_zone_limit('slow', 0.25))  # at 5.0 m
    fleet.at(8 * S, lambda fleet: fleet.set_zone_limit('slow'))  # at 6.0 m
    fleet.at(9 * S + S // 2, lambda fleet: fleet.set_zone_limit('slow', 1.0))  # they have left it
    fleet.run()
    assert [row[:2] for row in rows(fleet, 'ended')] == [(2.5, 'c'), (10.0, 'a'), (10.0, 'b')]
    assert rows(fleet, 'zone_limit', 'paced') == [
        (4.0, 'a', 'zone_limit', 'slow', 0.25), (4.0, 'a', 'paced', 'slow', 0.25), (4.0, 'b', 'paced', 'slow', 0.25),
        (8.0, 'a', 'zone_limit', 'slow', 0.0), (8.0, 'a', 'paced', 'slow', 0.0), (8.0, 'b', 'paced', 'slow', 0.0),
        (9.5, 'a', 'zone_limit', 'slow', 1.0)]


def test_a_change_does_the_same_whatever_the_order_of_robots():
    runs = []
    for order in ('abc', 'cba', 'bac'):
        fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0, 'acceleration': 1.0}, 'zones': [SLOW], 'robots': [
            {'name': name, 'start_y': 0.5 * 'abc'.index(name)} for name in order]}), start_ns=0)
        for name in 'abc':
            fleet.robot(name).send(10.0, 0.0)
        fleet.at(5 * S, lambda fleet: fleet.set_zone_limit('slow', 0.2))
        fleet.run()
        runs.append(rows(fleet, 'zone_limit', 'paced', 'entered', 'left'))
    assert runs[0] == runs[1] == runs[2] and len([row for row in runs[0] if row[2] == 'paced']) == 3


def test_what_a_limit_may_be_and_for_whom():
    for value in (0, -1.0, 'fast', float('nan')):
        with pytest.raises(ConfigurationError, match='max_speed: got .*; allowed: a number in 1e-6..1e6'):
            make_scenario({'zones': [dict(SLOW, max_speed=value)]})
    fleet = fleet_of([SLOW])
    with pytest.raises(ConfigurationError, match="zone 'fast' is unknown; there are: slow"):
        fleet.set_zone_limit('fast', 1.0)
    with pytest.raises(ConfigurationError, match='max_speed: got -1.0; allowed: a number in 1e-6'):
        fleet.set_zone_limit('slow', -1.0)
    with pytest.raises(ConfigurationError, match="robot 'a': its law of motion, .* allows no speed limits of zones"):
        Fleet(make_scenario({'zones': [SLOW], 'robots': [{'name': 'a', 'calibration': 'move_base_dwa_stage'}]}))


MATRIX = {'places': [{'name': 'o', 'x': 0.0, 'y': 3.0}, {'name': 'p', 'x': 10.0, 'y': 0.0}],
          'times': [{'from': 'o', 'to': 'p', 'seconds': 7.0}]}
NET = {'nodes': [{'name': 'o', 'x': 0.0, 'y': 0.0}, {'name': 'p', 'x': 10.0, 'y': 0.0}],
       'edges': [{'from': 'o', 'to': 'p'}]}


@pytest.mark.parametrize('more, arrival', [
    ({}, 2 + 6 / 0.5), ({'acceleration': 2.0}, 2 + 7 / 0.5 + 0.5 / 2), ({'duration_factor': 2.0}, 2 + 8 / 0.5 * 2),
    ({'goal_overhead': 3.0}, 3 + 10 / 0.5), ({'routes': 'lanes'}, 2 + 6 / 0.5),
    ({'xy_goal_tolerance': 1.0}, 2 + 5 / 0.5),
    ({'routes': 'matrix'}, 7.0)])
def test_a_limit_of_a_robot_that_is_set_on_the_way_counts_on_the_way(more, arrival, tmp_path):
    key = {'lanes': 'lanes', 'matrix': 'travel_matrix'}.get(more.get('routes'))
    path = tmp_path / 'file.yaml'
    path.write_text(json.dumps(MATRIX if key == 'travel_matrix' else NET))
    fleet = fleet_of([], more={key: str(path)} if key else None, **more)
    fleet.robot('a').send(10.0, 0.0)
    fleet.at(2 * S, lambda fleet: fleet.robot('a').set_limits(0.5))
    fleet.run()
    assert fleet.robot('a').pose.x == pytest.approx(10.0 - more.get('xy_goal_tolerance', 0.0))
    assert rows(fleet, 'ended')[0][0] == pytest.approx(arrival)


@pytest.mark.parametrize('law', [{'calibration': 'move_base_dwa_stage'}, {'compatible_with': 'move_base_abstract'}])
def test_a_limit_counts_on_the_way_by_each_law_of_motion(law):
    ends = []
    for speed in (None, 0.1):
        fleet = Fleet(make_scenario({'defaults': law, 'robots': [{'name': 'a'}]}), start_ns=0)
        fleet.robot('a').send(10.0, 0.0)
        fleet.at(2 * S, lambda fleet, speed=speed: fleet.robot('a').set_limits(speed))
        fleet.run()
        ends.append(rows(fleet, 'ended')[0][0])
    assert ends[1] > ends[0] + 10.0


def test_limits_that_are_set_change_nothing_but_the_speed():
    fleet = fleet_of([], 'abcd', max_speed=1.0)
    for name in 'abc':
        fleet.robot(name).send(4.0, 'abc'.index(name))
    fleet.at(1 * S, lambda fleet: fleet.robot('a').set_limits(1.0, 0.0))  # as before: it does not stop
    fleet.at(1 * S, lambda fleet: fleet.robot('b').hold('door'))
    fleet.at(2 * S, lambda fleet: fleet.robot('b').set_limits(0.5))  # it stands, and stays
    fleet.at(4 * S, lambda fleet: fleet.robot('c').set_limits(0.5))  # it is there
    fleet.at(5 * S, lambda fleet: fleet.robot('b').release('door'))
    fleet.at(6 * S, lambda fleet: fleet.robot('d').set_limits(0.25))
    fleet.at(7 * S, lambda fleet: fleet.robot('d').send(1.0, 3.0))
    fleet.run()
    assert [row[:3] for row in rows(fleet, 'ended', 'departed')] == [
        (0.0, 'a', 'departed'), (0.0, 'b', 'departed'), (0.0, 'c', 'departed'), (4.0, 'a', 'ended'),
        (4.0, 'c', 'ended'), (5.0, 'b', 'departed'), (7.0, 'd', 'departed'), (11.0, 'b', 'ended'), (11.0, 'd', 'ended')]


def test_a_reset_brings_the_limits_of_the_start_back():
    fleet = fleet_of([])
    fleet.robot('a').set_limits(0.5)
    fleet.reset()
    fleet.robot('a').send(2.0, 0.0)
    assert fleet.run() == S


def test_what_the_limits_of_a_robot_may_be():
    fleet = Fleet(make_scenario({'robots': [{'name': 'a'}, {'name': 'b', 'driven_by': 'velocities'}]}))
    for value in (0, -1.0, 'fast', float('nan')):
        with pytest.raises(ConfigurationError, match="robot 'a'/max_speed: got .*; allowed: a finite number > 0"):
            fleet.robot('a').set_limits(value)
    with pytest.raises(ConfigurationError, match='acceleration: got -1.0; allowed: a finite number >= 0'):
        fleet.robot('a').set_limits(acceleration=-1.0)
    with pytest.raises(ConfigurationError, match="robot 'b': driven_by: got 'velocities'; allowed: goals"):
        fleet.robot('b').set_limits(1.0)
