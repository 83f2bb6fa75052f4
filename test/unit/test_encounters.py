"""Robots that meet: what becomes of an encounter, in fleets and by the law, and what is refused."""
import math
import random
from pathlib import Path

import pytest
import yaml
from night import times

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.chance import Chance
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import NO_CONTROL
from move_base_abstract.motion.calibration import read_calibration
from move_base_abstract.motion.encounter_law import KINDS, TABLE
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import check_one_process, make_scenario

SHIPPED = Path(__file__).resolve().parents[2] / 'config' / 'calibrated' / 'move_base_dwa_stage.yaml'
MS = 1_000_000
#: no encounter costs anything / each costs one robot 4 s
FREE = {'source': 'test', 'radius': 3.0, **{'chance_' + kind: [[0.0, 0.0]] for kind in KINDS}, 'both_chance': 0.0,
        'delay_mean': 4.0, 'delay_cv': 0.01, 'block_chance': 0.0, 'block_mean': 60.0, 'block_cv': 0.01,
        'abort_chance': 0.0, 'narrow_below': 0.0, 'narrow_weight': 1.0}
DEAR = {**FREE, **{'chance_' + kind: [[0.0, 1.0]] for kind in KINDS}}


def calibration(tmp_path, law, name='robot.yaml'):
    """Return the path of a calibration with the section ``law``."""
    raw = yaml.safe_load(SHIPPED.read_text())
    raw['encounters'] = law
    if law is None:
        del raw['encounters']
    (tmp_path / name).write_text(yaml.safe_dump(raw))
    return str(tmp_path / name)


def scenario(tmp_path, law, robots, **more):
    return make_scenario({'seed': 5, 'encounters': 'calibrated', 'robots': robots, 'defaults': {
        'calibration': calibration(tmp_path, law)}, **more})


def rows(fleet, kind):
    return [(entry.time_ns, entry.robot, *entry.values) for entry in fleet.trace if entry.kind == kind]


TWO = [{'name': 'a'}, {'name': 'b', 'start_x': 30.0, 'start_yaw': math.pi}]


def two(tmp_path, law, **more):
    fleet = Fleet(scenario(tmp_path, law, TWO, **more))
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0, math.pi)
    fleet.run()
    return fleet


def drive(tmp_path, law, names, seed, steps=False):
    """Have robots drive to and fro at random, each three goals; return the fleet and {name: [(x, y), ...] each ms}."""
    chance = random.Random(seed)
    robots = [{'name': name, 'start_x': chance.uniform(0.0, 15.0), 'start_y': chance.uniform(0.0, 15.0)}
              for name in sorted(names)]
    goals = {name: [(chance.uniform(0.0, 15.0), chance.uniform(0.0, 15.0)) for _ in range(3)] for name in sorted(names)}

    def send(name, *_ended):
        if goals[name]:
            fleet.robot(name).send(*goals[name].pop())
    robots.sort(key=lambda one: names.index(one['name']))
    fleet = Fleet(scenario(tmp_path, law, robots), on_end=send)
    for name in names:
        send(name)
    places = {name: [] for name in names}
    while steps and any(fleet.robot(name).navigator.is_active for name in names):
        for name in names:
            pose = fleet.robot(name).pose
            places[name].append((pose.x, pose.y))
        fleet.run(fleet.now_ns + MS)
    fleet.run()
    return fleet, places


@pytest.mark.parametrize('seed', range(times(1, 3)))
def test_a_fleet_meets_when_its_poses_say_so(tmp_path, seed):
    names = ['a', 'b', 'c', 'd']
    fleet, places = drive(tmp_path, FREE, names, seed, steps=True)
    found = sorted((time_ns, *sorted((robot, other))) for time_ns, robot, other, *_ in rows(fleet, 'encounter'))
    assert found[::2] == found[1::2]  # a row of each of the two
    starts = {name: [0] + [row[0] for row in rows(fleet, 'departed') if row[1] == name] for name in names}
    expected = []
    for number, one in enumerate(names):
        for other in names[number + 1:]:
            met, was_near = [], True
            for step, (here, there) in enumerate(zip(places[one], places[other])):
                now_ns = fleet._start_ns + step * MS
                is_near = math.dist(here, there) <= 3.0
                goals = tuple(sum(start < now_ns for start in starts[name]) for name in (one, other))
                if is_near and not was_near and goals not in met:
                    met.append(goals)
                    expected.append((now_ns, one, other))
                was_near = is_near
    entered = [row for row in found[::2] if row[0] not in starts[row[1]] + starts[row[2]]]
    missed = [row for row in expected if not any(row[1:] == own[1:] and row[0] - MS <= own[0] <= row[0] + MS
                                                 for own in found[::2])]
    # Who met at a departure, being near already, does not meet again on the same ways.
    at_departures = [row for row in found[::2] if row not in entered]
    assert all(any(own[1:] == row[1:] for own in at_departures) for row in missed)
    assert len(entered) == len(expected) - len(missed)
    assert len(entered) > 4


def test_nothing_is_delayed_where_nothing_costs_anything(tmp_path):
    fleet = two(tmp_path, FREE)
    alone = Fleet(make_scenario({'seed': 5, 'robots': TWO, 'defaults': {'calibration': calibration(tmp_path, FREE)}}))
    alone.robot('a').send(30.0, 0.0)
    alone.robot('b').send(0.0, 0.0, math.pi)
    alone.run()
    assert [entry for entry in fleet.trace if entry.kind not in ('meets', 'encounter')] == alone.trace
    assert [(entry.time_ns, entry.robot, entry.values) for entry in fleet.trace if entry.kind == 'meets'] == [
        (fleet._start_ns, name, (3.0,)) for name in 'ab']
    assert len(rows(fleet, 'encounter')) == 2


def test_one_stands_and_goes_on_and_both_rows_say_it(tmp_path):
    fleet = two(tmp_path, DEAR)
    (at_ns, one, other, kind, nearest, lost), (_, _, _, _, _, other_lost) = rows(fleet, 'encounter')
    assert {one, other} == {'a', 'b'} and kind == 'head_on' and nearest < 1e-3
    assert sorted([lost > 0.0, other_lost > 0.0]) == [False, True]
    stood = max(lost, other_lost)
    assert abs(stood - 4.0) < 0.2
    (held_ns, who, why), = rows(fleet, 'held')
    assert held_ns == at_ns and why == 'encounter with {}'.format(other if who == one else one)
    (released_ns, _), = rows(fleet, 'released')
    assert released_ns == at_ns + round(stood * 1e9)
    assert [row[3] for row in rows(fleet, 'ended')] == ['SUCCEEDED', 'SUCCEEDED']


def test_who_is_blocked_gives_up_in_upstreams_words(tmp_path):
    fleet = two(tmp_path, {**DEAR, 'block_chance': 1.0, 'abort_chance': 1.0, 'both_chance': 1.0})
    assert [row[3:] for row in rows(fleet, 'ended')] == [('ABORTED', NO_CONTROL.text)] * 2
    assert len(rows(fleet, 'released')) == 2
    fleet.robot('b').place(Pose2D(0.0, 50.0))
    fleet.robot('a').send(30.0, 0.0)
    fleet.run()
    assert rows(fleet, 'ended')[-1][3] == 'SUCCEEDED'


@pytest.mark.parametrize('what', ['cancel', 'send', 'place'])
def test_who_stands_may_be_sent_elsewhere(tmp_path, what):
    fleet = Fleet(scenario(tmp_path, {**DEAR, 'delay_mean': 1000.0, 'both_chance': 1.0}, TWO))
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0, math.pi)
    fleet.run(until=30.0)
    assert fleet.robot('a').activity == 'held: encounter with b'
    if what == 'cancel':
        fleet.robot('a').cancel()
        assert not fleet.robot('a').navigator.travel.held_for
    elif what == 'send':
        fleet.robot('a').send(0.0, 5.0)
        assert fleet.robot('a').activity == 'driving'
    else:
        fleet.robot('a').place(Pose2D(0.0, 20.0))
        assert fleet.robot('a').activity == 'held: encounter with b'
    fleet.run()
    assert not fleet.robot('a').navigator.travel.held_for
    assert [row[3] for row in rows(fleet, 'ended') if row[1] == 'b'] == ['SUCCEEDED']


def test_reset_and_removal_leave_nothing_behind(tmp_path):
    fleet = Fleet(scenario(tmp_path, {**DEAR, 'delay_mean': 1000.0}, TWO))
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0, math.pi)
    fleet.run(until=30.0)
    fleet.reset()
    fleet.run()
    assert fleet.now < 31.0
    fleet.robot('a').send(30.0, 0.0)
    fleet.remove('b')
    fleet.run()
    assert fleet.now < 80.0 and rows(fleet, 'ended')[-1][3] == 'SUCCEEDED'
    fleet.add('c', calibration=fleet.scenario.robots[0].parameters['calibration'], start_x=15.0)
    fleet.robot('a').send(0.0, 0.0)
    fleet.run()
    assert rows(fleet, 'encounter')[-1][2] == 'a' and rows(fleet, 'encounter')[-1][3] == 'standing'


def test_the_order_of_the_robots_does_not_matter(tmp_path):
    raw = {**FREE, **{'chance_' + kind: [[0.0, 0.9]] for kind in KINDS}, 'both_chance': 0.3, 'block_chance': 0.2,
           'abort_chance': 0.5, 'delay_cv': 1.0}
    names = ['a', 'b', 'c', 'd', 'e']
    one, other = (drive(tmp_path, raw, order, 9)[0] for order in (names, names[::-1]))
    assert len(rows(one, 'encounter')) > 20
    assert sorted(one.trace) == sorted(other.trace)


def test_when_somebody_looks_does_not_matter(tmp_path):
    law = {**DEAR, 'delay_cv': 1.0, 'both_chance': 0.3}
    one, _ = drive(tmp_path, law, ['a', 'b', 'c', 'd'], 4)
    other, _ = drive(tmp_path, law, ['a', 'b', 'c', 'd'], 4, steps=True)
    assert one.trace == other.trace and len(rows(one, 'held')) > 4


def test_the_means_of_what_is_drawn_are_those_of_the_law(tmp_path):
    law = read_calibration(calibration(tmp_path, {
        **FREE, 'chance_crossing': [[0.0, 0.6], [2.0, 0.2]], 'both_chance': 0.25, 'block_chance': 0.1, 'delay_cv': 1.0,
        'abort_chance': 0.5}), 'test').encounters
    draws = Chance(1, 'a b')
    chance = law.chance('crossing', 1.0)
    assert chance == pytest.approx(0.4)
    count = 20_000
    costs = [law.draw(chance, (0, 1), lambda purpose, place, n=n: draws.uniform(n, purpose, place), 1.0)
             for n in range(count)]
    affected = [cost for cost in costs if any(cost.seconds)]
    assert len(affected) / count == pytest.approx(0.4, abs=0.015)
    assert sum(all(cost.seconds) for cost in affected) / len(affected) == pytest.approx(0.25, abs=0.025)
    assert sum(cost.aborts for cost in affected) / len(affected) == pytest.approx(0.05, abs=0.012)
    lost = [seconds for cost in affected for seconds in cost.seconds if seconds]
    assert sum(lost) / len(lost) == pytest.approx(0.9 * 4.0 + 0.1 * 60.0, rel=0.06)
    firsts = sum(cost.seconds[0] > 0.0 for cost in affected if not all(cost.seconds))
    assert firsts / sum(not all(cost.seconds) for cost in affected) == pytest.approx(0.5, abs=0.03)


def test_how_often_robots_are_blocked_goes_by_how_near_they_come_and_some_blocks_are_long(tmp_path):
    law = read_calibration(calibration(tmp_path, {
        **FREE, 'block_chance': [[0.0, 0.8], [2.0, 0.2]], 'long_chance': 0.25, 'long_mean': 1000.0,
        'abort_chance': 0.5}), 'test').encounters
    draws, count = Chance(2, 'a b'), 10_000
    for nearest, expected in ((0.0, 0.8), (1.0, 0.5), (3.0, 0.2)):
        costs = [law.draw(1.0, (0,), lambda purpose, place, n=n: draws.uniform(n, purpose, place), nearest)
                 for n in range(count)]
        long_ones = [cost.seconds[0] for cost in costs if abs(cost.seconds[0] - 4.0) > 1.0 and (
            abs(cost.seconds[0] - 60.0) > 5.0)]
        blocked = len(long_ones) + sum(abs(cost.seconds[0] - 60.0) <= 5.0 for cost in costs)
        assert blocked / count == pytest.approx(expected, abs=0.02)
        assert len(long_ones) / blocked == pytest.approx(0.25, abs=0.03)  # a few are as long as others by chance
        assert sum(long_ones) / len(long_ones) == pytest.approx(1000.0, rel=0.1)
        assert sum(cost.aborts for cost in costs) / blocked == pytest.approx(0.75 * 0.5, abs=0.03)
        assert not any(cost.aborts for cost in costs if cost.seconds[0] > 70.0)


# --- what is refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize('raw, words', [
    ({'encounters': 'sometimes'}, "'calibrated' or 'none'"),
    ({'encounters': 'calibrated', 'robots': [{'name': 'a'}]}, 'has no section encounters'),
    ({'encounters': 'calibrated'}, 'has no section encounters'),
    ({'defaults': {'encounters': 'none'}}, 'unknown'),
])
def test_what_cannot_be_is_refused(raw, words):
    with pytest.raises(ConfigurationError, match=words):
        make_scenario(raw)


def test_robots_of_two_laws_do_not_meet(tmp_path):
    one, other = calibration(tmp_path, FREE), calibration(tmp_path, DEAR, 'other.yaml')
    robots = [{'name': 'a', 'calibration': one}, {'name': 'b', 'calibration': other}]
    with pytest.raises(ConfigurationError, match='different laws'):
        make_scenario({'encounters': 'calibrated', 'robots': robots})
    fleet = Fleet(make_scenario({'encounters': 'calibrated', 'robots': robots[:1]}))
    with pytest.raises(ConfigurationError, match='all robots need the same law'):
        fleet.add('b', calibration=other)


def test_robots_of_several_processes_do_not_meet(tmp_path):
    with pytest.raises(ConfigurationError, match='cannot meet'):
        read_settings({'encounters': 'calibrated'}, '/robot_0/move_base')
    with pytest.raises(ConfigurationError, match='parts: got 2 with encounters; allowed: 1'):
        check_one_process(scenario(tmp_path, FREE, TWO), 2, '/fleet')


@pytest.mark.parametrize('change, words', [
    ({'radius': 0.0}, 'radius: got 0'), ({'chance_crossing': [[0.0, 1.5]]}, 'chance_crossing'),
    ({'speed': 1.0}, 'speed: unknown key'), ({'both_chance': None}, 'both_chance')])
def test_a_law_that_cannot_be_is_refused(tmp_path, change, words):
    with pytest.raises(ConfigurationError, match=words):
        read_calibration(calibration(tmp_path, {**FREE, **change}), 'test')


@pytest.mark.parametrize('name', [parameter.name for parameter in TABLE if not parameter.name.startswith('long')])
def test_a_law_that_lacks_something_is_refused(tmp_path, name):
    law = {key: value for key, value in FREE.items() if key != name}
    with pytest.raises(ConfigurationError, match='{} is missing'.format(name)):
        read_calibration(calibration(tmp_path, law), 'test')


@pytest.mark.parametrize('law, is_dear', [(FREE, False), (DEAR, True)])
def test_robots_that_are_driven_by_velocities_meet_on_arcs(tmp_path, law, is_dear):
    robots = [{'name': 'a', 'driven_by': 'velocities', 'cmd_vel_timeout': 0.0},
              {'name': 'b', 'driven_by': 'velocities', 'cmd_vel_timeout': 0.0, 'start_x': 20.0, 'start_y': 20.0}]
    fleet = Fleet(scenario(tmp_path, law, robots))
    a, b = (fleet.robot(name).navigator.robot for name in 'ab')
    fleet.robot('a').drive(1.0, 0.05)  # on a circle of 20 m, so that it comes to b after 31 s
    fleet.robot('b').drive(0.2, 0.1)  # on a circle of 2 m
    fleet.run(until=150.0)
    meetings = sorted({entry[0] for entry in rows(fleet, 'encounter')})
    assert meetings and all(entry[1] in 'ab' for entry in rows(fleet, 'encounter'))
    if is_dear:
        assert rows(fleet, 'held')
        return
    again = Fleet(scenario(tmp_path, law, robots))
    again.robot('a').drive(1.0, 0.05)
    again.robot('b').drive(0.2, 0.1)
    a, b = (again.robot(name).navigator.robot for name in 'ab')
    again.run(meetings[0] - 1)
    assert a.pose_at(again.now_ns).distance_to(b.pose_at(again.now_ns)) > 3.0
    again.run(meetings[0])
    assert a.pose_at(again.now_ns).distance_to(b.pose_at(again.now_ns)) <= 3.0


def test_a_drive_from_rest_to_rest_is_met_as_a_goal(tmp_path):
    robots = [{'name': 'a', 'driven_by': 'velocities'}, {'name': 'b', 'driven_by': 'velocities', 'start_x': 5.0}]
    fleet = Fleet(scenario(tmp_path, FREE, robots))
    for speed in (5.0, -5.0, 5.0):  # m/s, up to the watchdog's stop: 2.5 m
        fleet.robot('a').drive(speed)
        fleet.run()
    assert [time_ns for time_ns, robot, *_ in rows(fleet, 'encounter') if robot == 'a'] == [
        pytest.approx(1.4e9, abs=1), pytest.approx(2.4e9, abs=1)]


FLEET_OF_THREE = [
    {'name': 'r_8', 'start_x': 13.374, 'start_y': 11.424, 'start_yaw': 2.088},
    {'name': 'r_11', 'start_x': 13.029, 'start_y': 10.604, 'start_yaw': -2.920},
    {'name': 'r_13', 'start_x': 10.873, 'start_y': 11.710, 'start_yaw': 2.863}]


def met(robots, goals, seed):
    """Return the rows of robots that meet, those of one instant sorted by robot."""
    fleet = Fleet(make_scenario({'seed': seed, 'encounters': 'calibrated', 'robots': robots,
                                 'defaults': {'calibration': 'move_base_dwa_stage'}}))
    for robot in robots:
        fleet.robot(robot['name']).send(*goals[robot['name']])
    fleet.run()
    return sorted(fleet.trace, key=lambda row: (row.time_ns, row.robot))


def test_all_pairs_of_one_instant_are_judged_before_a_robot_stands_whatever_the_order_of_robots():
    goals = {'r_11': (6.121, 10.704), 'r_13': (12.756, 12.928), 'r_8': (1.240, 1.836)}
    first, second = met(FLEET_OF_THREE, goals, 7010), met(FLEET_OF_THREE[::-1], goals, 7010)
    assert first == second
    assert [(row.robot, row.values[0]) for row in first if row.kind == 'encounter' and row.time_ns == 10 ** 9] == [
        ('r_11', 'r_13'), ('r_13', 'r_11'), ('r_13', 'r_8'), ('r_8', 'r_13')]


@pytest.mark.parametrize('seed', range(8))
def test_encounters_do_not_depend_on_the_order_of_robots(seed):
    dice = random.Random(seed)
    robots = [{'name': 'r_{}'.format(number), 'start_x': round(dice.uniform(0, 15), 3),
               'start_y': round(dice.uniform(0, 15), 3), 'start_yaw': round(dice.uniform(-3, 3), 3)}
              for number in range(12)]
    goals = {one['name']: (round(dice.uniform(0, 15), 3), round(dice.uniform(0, 15), 3)) for one in robots}
    shuffled = dice.sample(robots, len(robots))
    assert met(robots, goals, seed) == met(shuffled, goals, seed)


@pytest.mark.parametrize('after', [lambda fleet: fleet.remove('b'),
                                   lambda fleet: fleet.robot('b').place(Pose2D(100.0, 0.0))])
def test_robots_of_which_one_is_taken_away_at_the_instant_do_not_meet(tmp_path, after):
    fleet = Fleet(scenario(tmp_path, DEAR, [{'name': 'a'}, {'name': 'b', 'start_x': 2.5, 'start_yaw': math.pi}]), 0)
    fleet.at(1, lambda fleet: (fleet.robot('a').send(30.0, 0.0), fleet.robot('b').send(-20.0, 0.0)))
    fleet.at(1, after)
    fleet.run(until=10.0)
    assert rows(fleet, 'encounter') == rows(fleet, 'held') == []
