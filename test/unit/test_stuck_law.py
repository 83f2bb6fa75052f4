"""Robots that get stuck as their calibration says: beside each other, at walls, for how long, and what is refused."""
from pathlib import Path

import numpy as np
import pytest
import yaml

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.engine.chance import Chance
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import NO_CONTROL
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.encounter_law import KINDS
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.stuck_law import make_stuck_law
from move_base_abstract.scenario import make_scenario
from traces import rows

SHIPPED = yaml.safe_load(
    (Path(__file__).resolve().parents[2] / 'config' / 'calibrated' / 'move_base_dwa_stage.yaml').read_text())
ALWAYS = {'source': 'test', 'patience': 16.4, 'by_nearest': [[0.0, 1.0]]}
#: no encounter costs anything but by being stuck / each is a long block
FREE = {**SHIPPED['encounters'], **{'chance_' + kind: [[0.0, 0.0]] for kind in KINDS}}
BLOCKED = {**FREE, **{'chance_' + kind: [[0.0, 1.0]] for kind in KINDS}, 'block_chance': 1.0, 'long_chance': 1.0,
           'abort_chance': 1.0, 'block_mean': 5.0, 'block_cv': 0.01}
TWO = [{'name': 'a'}, {'name': 'b', 'start_x': 30.0, 'start_yaw': 3.14159}]
S = 1_000_000_000


def calibration(tmp_path, stuck, encounters=FREE):
    """Return the path of a calibration with these sections."""
    raw = {**SHIPPED, 'encounters': encounters, 'stuck': stuck}
    if stuck is None:
        del raw['stuck']
    (tmp_path / 'robot.yaml').write_text(yaml.safe_dump(raw))
    return str(tmp_path / 'robot.yaml')


def two(tmp_path, stuck, robots=TWO, encounters=FREE, seed=5, **settings):
    """Return a fleet of two robots that have driven at each other for at most 300 s."""
    fleet = Fleet(make_scenario({'seed': seed, 'encounters': 'calibrated', 'robots': robots, 'defaults': {
        'calibration': calibration(tmp_path, stuck, encounters), 'failure_kind': 'calibrated', **settings}}))
    fleet.robot('a').send(30.0, 0.0)
    fleet.robot('b').send(0.0, 0.0, 3.14159)
    fleet.run(300 * S)
    return fleet


def test_robots_that_meet_get_stuck_and_give_each_goal_up(tmp_path):
    fleet = two(tmp_path, ALWAYS)
    failed = rows(fleet, 'failed')
    assert [row[1:] for row in failed] == [(name, 'failed', 'stuck', 'encounter') for name in 'ab']
    assert [row[1:] for row in rows(fleet, 'encounter')][0][1:4] == ('encounter', 'b', 'head_on')
    assert rows(fleet, 'ended') == [(pytest.approx(failed[0][0] + 16.4), name, 'ended', name + '-1', 'ABORTED',
                                     NO_CONTROL.text) for name in 'ab']
    fleet.robot('a').send(0.0, 0.0)
    fleet.run(400 * S)
    assert rows(fleet, 'ended')[-1][:4] == (pytest.approx(316.4), 'a', 'ended', 'a-2') and not rows(fleet, 'repaired')


def test_some_keep_their_goals_and_stand(tmp_path):
    fleet = two(tmp_path, {**ALWAYS, 'keep_chance': 1.0})
    assert [row[1:] for row in rows(fleet, 'failed')] == [(name, 'failed', 'stall', 'encounter') for name in 'ab']
    assert not rows(fleet, 'ended') and fleet.robot('a').activity == 'failed: stall'


@pytest.mark.parametrize('keep_chance', [0.0, 1.0])
def test_one_that_is_moved_away_comes_free(tmp_path, keep_chance):
    fleet = two(tmp_path, {**ALWAYS, 'keep_chance': keep_chance})
    fleet.robot('a').place(fleet.robot('a').pose)
    assert not rows(fleet, 'repaired')
    fleet.robot('a').place(Pose2D(0.0, 50.0, 0.0))
    assert [row[1] for row in rows(fleet, 'repaired')] == ['a']
    fleet.robot('a').send(10.0, 50.0)
    fleet.run(400 * S)
    assert rows(fleet, 'ended')[-1][1:5] == ('a', 'ended', 'a-2', 'SUCCEEDED')
    assert fleet.robot('b').activity.startswith('failed')


def test_they_come_free_by_themselves_if_the_recordings_say_so(tmp_path):
    free = two(tmp_path, {**ALWAYS, 'keep_chance': 1.0, 'free_mean': 20.0})
    assert [row[1] for row in rows(free, 'repaired')] and {row[4] for row in rows(free, 'ended')} == {'SUCCEEDED'}
    own = two(tmp_path, {**ALWAYS, 'keep_chance': 1.0, 'free_mean': 20.0}, repair_distribution='fixed', repair_time=7.0)
    failed, repaired = rows(own, 'failed'), rows(own, 'repaired')
    assert [row[0] for row in repaired] == [pytest.approx(failed[0][0] + 7.0)] * 2


def test_the_order_of_the_robots_does_not_matter(tmp_path):
    law = {**ALWAYS, 'by_nearest': [[0.0, 0.5]], 'keep_chance': 0.5}
    seen = set()
    for seed in range(20):
        one, other = (rows(two(tmp_path, law, robots, seed=seed), 'failed') for robots in (TWO, TWO[::-1]))
        assert sorted(one) == sorted(other)
        seen.add(tuple(row[3] for row in sorted(one)))
    assert seen == {(), ('stuck', 'stuck'), ('stall', 'stall'), ('stuck', 'stall'), ('stall', 'stuck')}


def test_how_often_is_as_the_law_says():
    law = make_stuck_law({**ALWAYS, 'by_nearest': [[0.0, 0.2], [2.0, 0.1]], 'keep_chance': 0.3}, 'test')
    draws, count = Chance(3, 'a b'), 20_000
    keeps = [law.draw(1.0, lambda purpose, place, n=n: draws.uniform(n, purpose, place)) for n in range(count)]
    keeps = [one for one in keeps if one is not None]
    assert len(keeps) / count == pytest.approx(0.15, abs=0.01)
    assert np.mean(keeps, axis=0) == pytest.approx([0.3, 0.3], abs=0.03)
    assert np.mean([all(one) for one in keeps]) == pytest.approx(0.09, abs=0.02)


def test_long_blocks_are_robots_that_are_stuck_so_there_are_none_beside_them(tmp_path):
    never = {**ALWAYS, 'by_nearest': [[0.0, 0.0]]}
    stuck = two(tmp_path, ALWAYS, encounters=BLOCKED)
    assert [row[-1] for row in rows(stuck, 'encounter')] == [0.0, 0.0]
    assert {row[3] for row in rows(stuck, 'held')} == {'failure'}
    longest = [max(row[-1] for row in rows(two(tmp_path, never, encounters=BLOCKED, failure_kind=kind), 'encounter'))
               for kind in ('calibrated', 'stall')]
    assert longest[0] < 10.0 and longest[1] > 30.0


def test_a_law_that_says_nothing_of_other_robots_leaves_encounters_as_they_are(tmp_path):
    walls = {'source': 'test', 'patience': 16.4, 'by_clearance': [[0.4, 0.0]]}
    one, other = (two(tmp_path, walls, encounters=BLOCKED, failure_kind=kind) for kind in ('calibrated', 'none'))
    assert one.trace == other.trace and max(row[-1] for row in rows(one, 'encounter')) > 30.0


def test_only_robots_that_are_to_get_stuck_do(tmp_path):
    one, other = (two(tmp_path, law, failure_kind='none') for law in (ALWAYS, None))
    assert one.trace == other.trace and not rows(one, 'failed')
    robots = [TWO[0], {**TWO[1], 'failure_kind': 'abort'}]
    assert not rows(two(tmp_path, ALWAYS, robots), 'failed')


def test_at_a_wall_the_way_has_the_calibration_s_chance_unless_the_scenario_has_its_own(tmp_path):
    cells = np.zeros((100, 200), np.int8)
    cells[54, 100] = 100
    occupancy = OccupancyMap(cells, 0.1, Pose2D())
    path = calibration(tmp_path, {**ALWAYS, 'by_clearance': [[0.46, 1.0], [0.5, 0.0]]})
    seen = []
    for own in ({}, {'stuck_by_clearance': [[0.1, 0.0]]}, {'stuck_patience': 2.0}):
        fleet = Fleet(make_scenario({
            'defaults': {'calibration': path, 'failure_kind': 'calibrated', 'use_map': True, **own},
            'robots': [{'name': 'a', 'start_x': 2.0, 'start_y': 5.0}]}), occupancy=occupancy)
        fleet.robot('a').send(18.0, 5.0)
        fleet.run()
        seen.append([row[0] for row in rows(fleet, 'failed')] + [rows(fleet, 'ended')[0][0]])
    assert seen[0][1] - seen[0][0] == pytest.approx(16.4) and seen[2][1] - seen[2][0] == pytest.approx(2.0)
    assert len(seen[1]) == 1


@pytest.mark.parametrize('settings, words', [
    ({'failure_kind': 'calibrated'}, "failure_kind: got 'calibrated'; allowed: .*a calibration that has a section"),
    ({'failure_kind': 'calibrated', 'calibration': 'x'}, 'calibration: got'),
    ({'failure_kind': 'none', 'stuck_by_clearance': [[0.1, 0.5]]}, "got 'none' with stuck_by_clearance")])
def test_what_cannot_be_is_refused(settings, words):
    with pytest.raises(ConfigurationError, match=words):
        make_scenario({'defaults': settings, 'robots': [{'name': 'a'}]})


@pytest.mark.parametrize('change, words', [
    ({'patience': None}, 'test: stuck.*patience'), ({'patience': 'long'}, "patience: got 'long'"),
    ({'by_nearest': [[0.0, 1.5]]}, 'by_nearest: got'), ({'often': 1}, 'often'), ({'free_mean': 0.0}, 'free_mean: got')])
def test_a_law_that_cannot_be_is_refused(change, words):
    raw = {key: value for key, value in {**ALWAYS, **change}.items() if value is not None}
    with pytest.raises(ConfigurationError, match=words):
        make_stuck_law(raw, 'test')
