"""How robots get stuck, fitted: chances of a known law come back, too few cases are said, recordings are understood."""
import gzip
import random
from pathlib import Path

import pytest
import yaml
from night import times

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.calibration import read_calibration
from move_base_abstract_calibration import command
from move_base_abstract_calibration.stuck_cases import Cases, Contact, Trial, find_cases
from move_base_abstract_calibration.stuck_fit import fit_chance, fit_stuck, score
from test_encounter_fit import write_recording

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = ROOT / 'config' / 'calibrated' / 'move_base_dwa_stage.yaml'
NO_CASES = Cases([], [], [], [], [], [], [])


def trials(near, far, count=800, seed=1):
    """Return trials up to 3 m, of 40 missions; the chance falls from ``near`` to ``far``."""
    chance = random.Random(seed)
    places = [chance.uniform(0.0, 3.0) for _ in range(count)]
    return [Trial(str(number % 40), at, chance.random() < near + at / 3.0 * (far - near))
            for number, at in enumerate(places)]


@pytest.mark.parametrize('near, far', [(0.06, 0.06), (0.2, 0.05)])
def test_a_known_chance_lies_in_the_interval(near, far):
    inside, widths = [], []
    for seed in range(times(40, 400)):
        rows = {row.name: row for row in fit_chance(trials(near, far, seed=seed), 3.0).rows('x')}
        inside += [rows['x_near'].low < near < rows['x_near'].high, rows['x_far'].low < far < rows['x_far'].high]
        widths.append(rows['x_near'].high / rows['x_near'].low)
    assert 0.88 < sum(inside) / len(inside) <= 1.0 and 1.2 < sorted(widths)[len(widths) // 2] < 4.0


def test_missions_are_predicted_by_the_others():
    same, steep = score(trials(0.06, 0.06), 3.0), score(trials(0.3, 0.01), 3.0)
    assert same.missions == 40 and same.expected == pytest.approx(same.stuck, rel=0.1)
    assert same.expected_hit == pytest.approx(same.hit, rel=0.2)
    assert same.gain < 2.0 and steep.gain > 10.0
    assert score(trials(0.06, 0.06, 100), 3.0) is None


def test_beyond_the_reach_the_distance_does_not_matter():
    far = trials(0.06, 0.06) + [Trial('m', 3.0, number % 2 == 0) for number in range(40)]
    farther = [one._replace(at=30.0) if one.at == 3.0 else one for one in far]
    assert fit_chance(farther, 3.0).table() == fit_chance(far, 3.0).table()


def test_a_fit_without_enough_cases_says_so_with_the_figure():
    few = [Trial('m', 1.0, number < 9) for number in range(500)]
    cases = NO_CASES._replace(meetings=trials(0.06, 0.06), ways=few, patience=[16.4, 16.4, 38.0],
                              gave_up=[True, False, False, False], contacts=[Contact(('a', 'b'), 10.0, 510.0, False)])
    fitted = fit_stuck(cases, 3.0)
    assert set(fitted.values) == {'patience', 'by_nearest', 'keep_chance'} and fitted.values['patience'] == 16.4
    assert fitted.values['keep_chance'] == 0.75
    about_walls, about_end = fitted.notes
    assert about_walls == ('by_clearance: not fitted: robots got stuck in 9 of 500 legs, at walls (95 %: 0.0083 to '
                           '0.034); at least 10 cases are needed')
    assert 'none of 1 pairs came free in 500 s; the mean time is at least 167 s' in about_end
    with pytest.raises(ConfigurationError, match='by_nearest: not fitted: robots got stuck in 9 of 500 encounters'):
        fit_stuck(cases._replace(meetings=few), 3.0)
    with pytest.raises(ConfigurationError, match='stuck: patience: not fitted: no robot gave up a goal'):
        fit_stuck(cases._replace(patience=[]), 3.0)
    freed = fit_stuck(cases._replace(contacts=[Contact(('a', 'b'), 0.0, 90.0, True)] * 4), 3.0)
    row = freed.rows[-1]
    assert freed.values['free_mean'] == row.value == 90.0 and row.low == pytest.approx(35.2, abs=0.1)
    assert row.high == pytest.approx(330.3, abs=0.1)


# ---- recordings


def write_poses(folder, tracks, until=100):
    """Write the poses of the mission m; ``tracks``: {robot: place(t)}, each (x, y) [m] every 0.5 s for ``until`` s."""
    lines = ['run,robot,t,x,y']
    for robot, place in tracks.items():
        lines += ['m,{},{},{},{}'.format(robot, t, *place(t)) for t in (0.5 * step for step in range(2 * until + 1))]
    (folder / 'poses.csv.gz').write_bytes(gzip.compress(('\n'.join(lines) + '\n').encode()))


HEAD_ON = [(0, 1, (2.0, 5.0, 0.0), (28.0, 5.0, 0.0), 0.0, 40.0, 4),
           (1, 1, (28.0, 5.5, 3.14), (2.0, 5.5, 3.14), 0.0, 90.0, 2)]


def cases_of(folder):
    return find_cases([folder], read_calibration('move_base_dwa_stage', 'test'), 3.0, 0.4)


@pytest.mark.parametrize('until, freed', [(100.0, False), (60.0, True)])
def test_robots_that_touch_for_long_are_stuck_since_their_encounter(tmp_path, until, freed):
    write_recording(tmp_path, HEAD_ON)
    write_poses(tmp_path, {0: lambda t: (14.8, 5.0), 1: lambda t: (15.2 if 15.0 <= t <= until else 20.0, 5.2)})
    cases = cases_of(tmp_path)
    assert cases.contacts == [Contact(('0', '1'), 15.0, until, freed)]
    (meeting,) = cases.meetings
    assert meeting.stuck and meeting.at == pytest.approx(0.5, abs=1e-3) and meeting.mission == 'hall headon 2 1  '
    assert cases.gave_up == [True, False] and not cases.unmet
    assert not any(one.stuck for one in cases.ways)


def test_a_case_belongs_to_the_latest_encounter_and_robots_that_are_stuck_do_not_meet(tmp_path):
    ends = {3: (15.2, 5.2, 0.0), 4: (15.2, 5.2, 0.0)}
    write_recording(tmp_path, [
        (0, 1, (2.0, 5.0, 0.0), (28.0, 5.0, 0.0), 0.0, 40.0, 3),
        (1, 1, (28.0, 6.5, 3.14), (2.0, 6.5, 3.14), 0.0, 40.0, 3),  # they pass at 1.5 m
        (0, 3, (28.0, 5.0, 3.14), (2.0, 5.0, 3.14), 100.0, 140.0, 4),
        (1, 2, (2.0, 5.5, 0.0), (28.0, 5.5, 0.0), 100.0, 170.0, 2),  # now they touch
        (0, 4, (15.2, 5.2, 0.0), (2.0, 5.2, 0.0), 150.0, 166.4, 4),
        (1, 5, (14.8, 5.0, 0.0), (28.0, 5.0, 0.0), 180.0, 190.0, 2)], ends)
    write_poses(tmp_path, {0: lambda t: (15.2, 5.2), 1: lambda t: (14.8 if t >= 115.0 else 20.0, 5.0)}, 200)
    cases = cases_of(tmp_path)
    assert [(one.stuck, round(one.at, 2)) for one in cases.meetings] == [(True, 0.5), (False, 1.5)]
    assert not any(one.stuck for one in cases.ways) and cases.patience == [pytest.approx(16.4)]


def test_robots_that_touch_for_a_moment_are_not_stuck(tmp_path):
    write_recording(tmp_path, HEAD_ON)
    write_poses(tmp_path, {0: lambda t: (14.8, 5.0), 1: lambda t: (15.2 if t % 30.0 < 20.0 else 20.0, 5.2)})
    cases = cases_of(tmp_path)
    assert [one.stuck for one in cases.meetings] == [False] and not cases.contacts
    assert cases.brief == [19.5] * 3  # the fourth may not have ended


def test_robots_that_never_met_by_their_ways_are_told(tmp_path):
    write_recording(tmp_path, [HEAD_ON[0], (1, 1, (28.0, 9.5, 3.14), (2.0, 9.5, 3.14), 0.0, 90.0, 2)])
    write_poses(tmp_path, {0: lambda t: (14.8, 5.0), 1: lambda t: (15.2, 5.2)})
    cases = cases_of(tmp_path)
    assert not cases.meetings and len(cases.unmet) == 1


@pytest.mark.parametrize('end, next_end, stuck', [
    ((10.0, 5.0, 0.0), (10.0, 5.0, 0.0), True),  # it gives up the next goal where it stands
    ((10.0, 5.0, 0.0), (12.0, 5.0, 0.0), False)])
def test_a_robot_that_gives_up_two_goals_in_one_place_is_stuck(tmp_path, end, next_end, stuck, plan='12.0'):
    legs = [(0, 1, (2.0, 5.0, 0.0), (28.0, 5.0, 0.0), 0.0, 40.0, 4), (0, 2, end, (2.0, 5.0, 0.0), 50.0, 66.4, 4)]
    write_recording(tmp_path, legs, {1: end, 2: next_end})
    path = tmp_path / 'legs.csv.gz'
    columns, *lines = gzip.decompress(path.read_bytes()).decode().split()
    path.write_bytes(gzip.compress('\n'.join([columns + ',plan_m,driven_m', *(f'{line},{plan},0.0' for line in lines)])
                                   .encode()))
    write_poses(tmp_path, {0: lambda t: (10.0, 5.0)})
    cases = cases_of(tmp_path)
    assert [one.stuck for one in cases.ways][0] == stuck
    assert cases.patience == ([pytest.approx(16.4)] if stuck else [])


def test_a_robot_whose_planner_finds_no_way_is_not_stuck(tmp_path):
    test_a_robot_that_gives_up_two_goals_in_one_place_is_stuck(tmp_path, (10.0, 5.0, 0.0), (10.0, 5.0, 0.0), False, '')


@pytest.mark.night
def test_the_section_that_ships_is_what_the_recordings_say(tmp_path, capsys):
    output = tmp_path / 'new.yaml'
    folders = [str(ROOT / 'examples' / 'reality' / name) for name in ('', 'ranking')]
    command.main([*folders, '--stuck', 'move_base_dwa_stage', '-o', str(output)])
    made, ships = (yaml.safe_load(path.read_text()) for path in (output, SHIPPED))
    places, chances = (list(column) for column in zip(*made['stuck'].pop('by_nearest')))
    other_places, other_chances = (list(column) for column in zip(*ships['stuck'].pop('by_nearest')))
    assert made == ships and places == other_places and chances == pytest.approx(other_chances, rel=0.01)
    said = capsys.readouterr().out
    assert '14 got stuck, predicted 14.1' in said and 'by_clearance: not fitted' in said


def test_calibrate_says_what_it_lacks(tmp_path, capsys):
    write_recording(tmp_path, HEAD_ON)
    for text in ('poses.csv.gz', 'by_nearest: not fitted: robots got stuck in 0 of 1 encounters'):
        with pytest.raises(SystemExit) as end:
            command.main([str(tmp_path), '--stuck', 'move_base_dwa_stage', '-o', str(tmp_path / 'new.yaml')])
        assert end.value.code == 2 and text in capsys.readouterr().err
        write_poses(tmp_path, {0: lambda t: (14.8, 5.0)})


def test_calibrate_adds_one_section_at_a_time(tmp_path, capsys):
    with pytest.raises(SystemExit) as end:
        command.main([str(tmp_path), '--stuck', 'move_base_dwa_stage', '--encounters', 'move_base_dwa_stage'])
    assert end.value.code == 2 and 'not allowed with argument --stuck' in capsys.readouterr().err
