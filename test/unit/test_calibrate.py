"""Calibration: what is fitted predicts other legs, robots simulated with it take as long, files are whole.

On the small recording that ships; on the whole one where MOVE_BASE_STAGE_LEGS names its file.
"""
import os
from pathlib import Path

import numpy as np
import pytest
import yaml
from night import times

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.approach import approach_profile
from move_base_abstract.motion.calibration import make_calibration, read_calibration
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.scenario import make_scenario
from move_base_abstract_calibration import check, command, outputs
from move_base_abstract_calibration.check import by_class
from move_base_abstract_calibration.csv_files import read_legs
from move_base_abstract_calibration.fit import fit, succeeded
from move_base_abstract_calibration.intervals import clusters, intervals
from move_base_abstract_calibration.law import Durations, approach_seconds, motion_seconds
from move_base_abstract_calibration.legs import met_no_robot, way_along, ways_of

ROOT = Path(__file__).resolve().parents[2]
SMALL = ROOT / 'examples' / 'calibration' / 'move_base_stage_legs.csv'
WHOLE = os.environ.get('MOVE_BASE_STAGE_LEGS')
SHIPPED = 'move_base_dwa_stage'
NOMINAL = 1.0  # m/s
COLUMNS = 'start_x,start_y,start_yaw,goal_x,goal_y,goal_yaw,duration_s,state'


def shipped_values():
    """Return the calibration that ships as {parameter: value}."""
    return load_yaml_file(ROOT / 'config' / 'calibrated' / (SHIPPED + '.yaml'))


@pytest.fixture(scope='module')
def pairs():
    return ways_of(read_legs(SMALL))


@pytest.fixture(scope='module')
def fitted(pairs):
    """Return what is fitted to the recording A1 alone."""
    return fit([pair for pair in pairs if pair[0].recording == 'A1'])


# ---- one law

@pytest.mark.parametrize('acceleration', [0.5, np.inf])
def test_the_law_for_many_legs_is_the_cores(acceleration):
    distances = np.array([0.0, 1e-6, 0.02, 0.1, 0.5, 1.0, 2.0, 3.0, 10.0, 50.0])
    for speed, gain, offset in ((1.0, 0.5, 0.1), (0.04, 0.5, 0.1), (2.0, 3.0, 0.5)):
        expected = [approach_profile(distance, speed, acceleration, gain, offset).seconds for distance in distances]
        assert approach_seconds(distances, speed, acceleration, gain, offset) == pytest.approx(expected, abs=1e-9)


def test_the_motion_of_each_recorded_leg_is_that_of_the_simulated_robot(pairs):
    calibration = read_calibration(SHIPPED, 'x')
    for leg, _ in pairs:
        route = PhasedRoute(leg.start, leg.goal, (), calibration.limits, calibration.phases, calibration.tolerances)
        way = way_along(leg.start, (), leg.goal)
        assert motion_seconds(shipped_values(), np.array([way]))[0] == pytest.approx(route.duration_ns / 1e9, abs=1e-6)


def test_the_distribution_adds_up():
    law = Durations(shipped_values(), [(1.5, 0.3, -1.0), (12.0, 2.6, 1.0), (40.0, -3.0, 0.0)])
    grid, step = np.linspace(-5.0, 250.0, 5101, retstep=True)
    density = np.array([law.density(law.least + at) for at in grid])
    assert density.sum(axis=0) * step == pytest.approx(1.0, abs=2e-3)
    assert density.T @ grid * step == pytest.approx(law.mean() - law.least, abs=0.05)
    for share in (0.05, 0.5, 0.95):
        assert law.share_below(law.quantile(share)) == pytest.approx(share, abs=1e-9)


# ---- predictions

def test_one_recording_predicts_another(pairs, fitted):
    predicted = check.predict(fitted, [pair for pair in pairs if pair[0].recording == 'A2'], NOMINAL)
    score = check.score('A2', predicted)
    assert score.legs == 62
    assert score.median_error < 0.035
    assert score.mean_ratio == pytest.approx(1.0, abs=0.1)
    assert score.within > 0.8  # the fit has flat directions: where it ends there is a matter of a processor's digits
    assert score.straight_error > 10 * score.median_error


def test_what_is_fitted_is_what_was_put_in():
    values = shipped_values()
    generator = np.random.default_rng(5)
    legs = []
    for number, (leg, way) in enumerate(ways_of(read_legs(SMALL)) * 3):
        duration = Durations(values, [way]).quantile(generator.uniform())[0]
        legs.append((leg._replace(number=number, duration=float(duration), succeeded=True, counts=True), way))
    found = fit(legs)
    assert found['max_speed'] == pytest.approx(values['max_speed'], rel=0.02)
    for name in ('spread', 'bow_length', 'tail_mean', 'braking_gain'):
        assert found[name] == pytest.approx(values[name], rel=0.4), name
    ways = np.array([way for _, way in legs])
    assert Durations(found, ways).mean() == pytest.approx(Durations(values, ways).mean(), rel=0.12)


def test_robots_simulated_with_it_take_as_long_as_the_recorded_one(pairs):
    used = succeeded(pairs)
    measured = np.array([leg.duration for leg, _ in used])
    simulated = np.array([simulate(used, seed) for seed in range(5)])
    assert np.nanmean(simulated) == pytest.approx(measured.mean(), rel=0.06)
    late = np.abs(np.nanmedian(simulated, axis=0) - measured) / measured
    assert np.median(late) < 0.04
    straight = np.array([leg.start.distance_to(leg.goal) for leg, _ in used])
    assert np.median(np.abs(straight / NOMINAL - measured) / measured) > 0.35


def simulate(used, seed):
    """Return how long a simulated robot takes for each leg [s], on a straight way as long as the recorded one."""
    fleet = Fleet(make_scenario({'seed': seed, 'defaults': {'calibration': SHIPPED}, 'robots': [{'name': 'bot'}]}),
                  start_ns=0)
    found = []
    for _, way in used:
        fleet.robot('bot').place(Pose2D(0.0, 0.0, -way.start_turn))
        begin_ns = fleet.now_ns
        fleet.robot('bot').send(way.length, 0.0, way.end_turn)
        fleet.run()
        state = fleet.trace[-1].values[1]
        found.append((fleet.now_ns - begin_ns) / 1e9 if state == 'SUCCEEDED' else np.nan)
    return found


@pytest.mark.skipif(not WHOLE, reason='MOVE_BASE_STAGE_LEGS names no file with the whole recording')
def test_one_robot_alone_predicts_three_together():
    pairs = ways_of(read_legs(WHOLE))
    values = fit([pair for pair in pairs if pair[0].recording != 'B'])
    together = [pair for pair in pairs if pair[0].recording == 'B']
    score = check.score('B', check.predict(values, together, NOMINAL))
    alone = check.score('B', check.predict(
        values, [pair for pair in together if met_no_robot(pair[0], check.MET)], NOMINAL))
    assert score.median_error <= 0.025
    assert alone.median_error <= 0.025
    assert alone.mean_ratio == pytest.approx(1.0, abs=0.02)
    assert 0.83 <= alone.within <= 0.95
    assert score.mean_ratio < alone.mean_ratio  # who meets another robot is later
    predicted, measured = check.success_rates(values, together)
    assert predicted == pytest.approx(measured, abs=0.01)


def test_folds_leave_out_what_they_ask_for(pairs):
    mapped = [(leg._replace(map='yard' if leg.number % 3 else 'hall'), way) for leg, way in pairs]
    assert list(check.by_maps(mapped)) == ['hall', 'yard']
    assert check.by_maps(pairs) == {}
    for all_pairs, folds in ((pairs, check.by_parts(pairs)), (pairs, check.by_regions(pairs)),
                         (pairs, list(check.by_recordings(pairs).values())),
                         (mapped, list(check.by_maps(mapped).values()))):
        for known, asked in folds:
            assert not {id(leg) for leg, _ in known} & {id(leg) for leg, _ in asked}
        assert sum(len(asked) for _, asked in folds) == len(all_pairs)


def test_errors_of_classes_are_those_of_their_legs(pairs):
    used = [(leg._replace(nearest_robot=(None, 0.5, 1.0, 2.0, 9.0)[leg.number % 5]), way)
            for leg, way in succeeded(pairs)]
    predicted = check.predict(shipped_values(), used, NOMINAL)
    turns, robots = by_class(used, predicted)[:2]
    assert [turns.kind, robots.kind] == ['start turn', 'nearest other robot']
    assert sum(row.legs for _, row in turns.rows) == sum(row.legs for _, row in robots.rows) == len(used)
    assert [name for name, _ in robots.rows] == ['below 1 m', '1 to 1.5 m', '1.5 to 3 m', '5 m or more', 'not known']
    large = [pair for pair in used if abs(pair[1].start_turn) >= np.radians(150.0)]
    expected = check.score('', check.predict(shipped_values(), large, NOMINAL))
    assert turns.rows[-1][0] == '150 degrees or more'
    assert turns.rows[-1][1].median_error == pytest.approx(expected.median_error)
    assert turns.rows[-1][1].median_error > 2.0 * turns.rows[0][1].median_error
    assert [errors.kind for errors in by_class([(leg._replace(nearest_robot=None, clearance=None), way)
                                               for leg, way in used], predicted)] == ['start turn']


def test_intervals_hold_what_was_put_in_and_what_legs_say_nothing_of_is_held_by_the_prior():
    values = shipped_values()
    generator = np.random.default_rng(7)
    legs = []
    for number, (leg, recorded) in enumerate(ways_of(read_legs(SMALL))):
        way = recorded._replace(start_turn=0.0, end_turn=0.0)  # nobody turns
        duration = Durations(values, [way]).quantile(generator.uniform())[0]
        legs.append((leg._replace(number=number, duration=float(duration), succeeded=True, counts=True, failed=False),
                     way))
    samples = times(2, 8)
    found, how = intervals(legs, samples)
    assert how.startswith('90 %, the wider of {} samples of {} legs'.format(samples, len(legs)))
    assert {found[name] for name in ('turning_speed', 'turning_gain', 'start_turn_square', 'bow_length',
                                     'tail_chance_at_180_degrees')} == {'held by the prior'}
    for name in ('max_speed', 'spread', 'delay_share'):
        low, high = found[name]
        assert low < values[name] < high, name
    assert found['max_speed'][1] - found['max_speed'][0] < 0.1
    assert found['failures_per_km'][0] == 0.0 and found['failures_per_km'][1] > 0.5
    assert intervals(legs, samples) == (found, how)


def test_legs_of_many_recordings_are_drawn_by_recordings(pairs):
    assert clusters(pairs)[1] == 'legs'
    groups, words = clusters([(leg._replace(recording=str(leg.number % 12)), way) for leg, way in pairs])
    assert (len(groups), words) == (12, 'recordings')
    assert sum(map(len, groups)) == len(pairs)
    groups, words = clusters([(leg._replace(recording=str(leg.number % 5), robot=str(leg.number % 2)), way)
                              for leg, way in pairs])
    assert (len(groups), words) == (10, 'robots of recordings')


def test_a_robot_that_touched_another_one_has_met_it(pairs):
    leg = pairs[0][0]
    assert [met_no_robot(leg._replace(nearest_robot=near), 1.5) for near in (None, 0.0, 1.4, 1.5)] == [
        True, False, False, True]


# ---- the program

def test_the_program_writes_a_file_that_a_scenario_can_name_and_a_page(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(check, 'scores', lambda values, pairs, speed: ([check.score(
        'those', check.predict(values, pairs, speed), check.success_rates(values, pairs))], None))  # no folds: slow
    output = tmp_path / 'robot.yaml'
    command.main([str(SMALL), '-o', str(output), '--source', "a robot's first day", '--bootstrap', '2'])
    assert read_calibration(str(output), 'x').source == "a robot's first day"
    recorded = read_calibration(str(output), 'x').durations.recorded
    assert recorded.length == pytest.approx((1.207, 56.187), abs=0.001)
    assert load_yaml_file(output)['intervals']['max_speed'][0] < 1.0
    page = (tmp_path / 'robot.html').read_text()
    for text in ('start turn', '150 degrees or more', 'held by the prior', 'failures_per_km', '6 legs were moved'):
        assert text in page
    assert page.startswith('<!doctype html><!-- move_base_abstract calibration -->') and 'data:image/png' in page
    assert str(output) in capsys.readouterr().out
    assert sorted(os.listdir(tmp_path)) == ['robot.html', 'robot.yaml']


def test_a_file_predicts_a_recording_and_nothing_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in (SHIPPED, str(ROOT / 'config' / 'calibrated' / (SHIPPED + '.yaml'))):
        command.main([str(SMALL), '--predict', name])
        said = capsys.readouterr().out
        assert said.startswith(name) and '116 legs: median error' in said
    assert os.listdir(tmp_path) == []


def test_what_others_made_stays(tmp_path, capsys):
    for name in ('robot.yaml', 'robot.html'):
        path = tmp_path / name
        path.write_text('mine\n')
        with pytest.raises(SystemExit) as end:
            command.main([str(SMALL), '-o', str(tmp_path / 'robot.yaml')])
        assert end.value.code == 2
        assert 'it stays' in capsys.readouterr().err
        assert path.read_text() == 'mine\n'
        path.unlink()


def test_a_folder_that_is_not_there_is_said_before_the_fit(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, '_pairs', None)
    with pytest.raises(SystemExit) as end:
        command.main([str(SMALL), '-o', str(tmp_path / 'none' / 'robot.yaml')])
    assert end.value.code == 2
    assert 'there is no folder' in capsys.readouterr().err


@pytest.mark.parametrize(('text', 'words'), [
    (None, 'cannot be read'), ('a,b\n1,2\n', 'no column start_x'), ('', 'line 1: got no columns'),
    (COLUMNS + '\n0,0,0,1,x,0,9,3\n', "line 2: goal_y: got 'x'"),
    ('# a note\n' + COLUMNS + '\n# another\n0,0,0,1,x,0,9,3\n', "line 4: goal_y: got 'x'"),
    (COLUMNS + '\n0,0,0,1,1e12,0,9,3\n', 'goal: pose: y must be within'),
    (COLUMNS + '\n0,0,0,1,0,0,0,3\n', 'duration_s: got 0; allowed: a number > 0 [s]'),
    (COLUMNS + ',plan_m\n0,0,0,1,0,0,9,3,-1\n', 'plan_m: got -1; allowed: a number >= 0 [m]'),
    (COLUMNS + ',start_turn_rad\n0,0,0,1,0,0,9,3,-0.5\n', 'start_turn_rad: got -0.5; allowed: a number in 0..pi'),
    (COLUMNS + '\n0,0,0,1,0,0,9,3\n', 'at least 25'), ('\ufeff' + COLUMNS + '\n0,0,0,1,0,0,9,3\n', 'at least 25'),
])
def test_what_cannot_be_fitted_is_said(tmp_path, capsys, text, words):
    path = tmp_path / 'legs.csv'
    if text is not None:
        path.write_text(text, encoding='utf-8')
    with pytest.raises(SystemExit) as end:
        command.main([str(path), '-o', str(tmp_path / 'robot.yaml')])
    assert end.value.code == 2
    assert words in capsys.readouterr().err


def test_what_is_written_is_read_back_to_five_digits(pairs, fitted):
    text = outputs.yaml_text(fitted, "it's\nhere \x1b[0m")
    raw = yaml.safe_load(text)
    assert raw['source'] == "it's here \\x1b[0m"
    assert raw['max_speed'] == pytest.approx(fitted['max_speed'], rel=1e-4)
    assert make_calibration(raw, 'x').durations.spread == raw['spread']


def test_the_calibration_that_ships_is_the_programs_own_writing():
    text = (ROOT / 'config' / 'calibrated' / (SHIPPED + '.yaml')).read_text()
    values = shipped_values()
    source = values.pop('source')
    assert values.pop('format') == 1
    how = next((line.partition('# ')[2] for line in text.splitlines() if line.startswith('intervals:')), '')
    recorded, intervals_of_it = values.pop('recorded'), values.pop('intervals')
    motion = values.pop('tail_motion')
    assert outputs.yaml_text(values, source, recorded, intervals_of_it, how, motion) == text
