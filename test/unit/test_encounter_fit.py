"""What meeting others costs, fitted: legs by a known law give it back; recordings of several robots are understood."""
import gzip
import math
import random
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.maps.map_files import write_map
from move_base_abstract.motion.calibration import make_calibration, read_calibration
from move_base_abstract_calibration import command, encounter_fit, encounter_report
from move_base_abstract_calibration.law import Durations
from move_base_abstract_calibration.legs import Way
from move_base_abstract_calibration.meetings import Meeting, MetLeg, met_legs

SHIPPED = Path(__file__).resolve().parents[2] / 'config' / 'calibrated' / 'move_base_dwa_stage.yaml'
VALUES = yaml.safe_load(SHIPPED.read_text())
AGAIN = VALUES['max_speed'] / (2.0 * VALUES['acceleration'])  # s, to get going
COLUMNS = ('run', 'robot', 'goal', 'start_x', 'start_y', 'start_yaw', 'goal_x', 'goal_y', 'goal_yaw', 'end_x', 'end_y',
           'end_yaw', 'send_s', 'result_s', 'duration_s', 'state', 'cancelled', 'stuck_start', 'rescued')


def made_legs(count, share, mean, seed=3):
    """Return legs that each met a robot that stands, near by; ``share`` of them stood for it, ``mean`` [s]."""
    chance = random.Random(seed)
    legs = []
    for number in range(count):
        way = Way(chance.uniform(8.0, 30.0), chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0))
        alone = float(Durations(VALUES, [way]).least[0]) + chance.gauss(0.4, 0.3)
        late = AGAIN + chance.lognormvariate(math.log(mean) - 0.125, 0.5) if number < share * count else 0.0
        legs.append(MetLeg('made', way, alone + late, True, (Meeting('standing', 0.1, 3.0, True, None),)))
    return legs


def test_legs_of_a_known_law_give_it_back():
    fitted = encounter_fit.fit_encounters(made_legs(150, 0.5, 8.0), VALUES, 3.0)
    rows = {row.name: row for row in fitted.rows}
    assert rows['standing_near'].low < 0.5 < rows['standing_near'].high
    assert rows['standing_near'].high - rows['standing_near'].low < 0.35 and not rows['standing_near'].held
    assert rows['delay_mean'].low < 8.0 < rows['delay_mean'].high and not rows['delay_mean'].held
    assert rows['crossing_near'].held and fitted.counts['standing'] == 150  # of which there were none
    law = make_calibration({**VALUES, 'encounters': {**fitted.values, 'source': 'test'}}, 'test').encounters
    assert law.chance('standing', 0.0) == pytest.approx(rows['standing_near'].value)
    better, without = encounter_fit.log_likelihoods(made_legs(60, 0.5, 8.0, 4), VALUES, fitted, 3.0)
    assert better > without + 20.0  # of legs that were not fitted
    legs = made_legs(60, 0.5, 8.0, 5)
    more = sum(encounter_fit.mean_seconds(leg, fitted.values, 3.0) for leg in legs)
    measured = sum(leg.duration for leg in legs) - float(np.sum(Durations(VALUES, [leg.way for leg in legs]).mean()))
    assert more == pytest.approx(measured, rel=0.4)


def test_too_few_legs_that_met_are_refused():
    with pytest.raises(ConfigurationError, match='got 19 legs that met a robot'):
        encounter_fit.fit_encounters(made_legs(19, 0.5, 8.0), VALUES, 3.0)


def write_recording(folder, rows, ends=()):
    """Write a mission on an empty map of 30 m x 10 m; ``rows``: [(robot, goal, start, goal, send, result, state)].

    ``ends``: {number of a goal: where it ended, if not at the goal}.
    """
    (folder / 'missions.csv').write_text('run,map,kind,robots,seed,simulated_s,wall_s,legs,cycles,missed_loops,moved,'
                                         'load\nm,hall,headon,2,1,60.0,60.0,2,100,0,0,1.0\n')
    lines = [','.join(COLUMNS)]
    for robot, number, start, goal, send, result, state in rows:
        lines.append(','.join(map(str, ['m', robot, number, *start, *goal, *dict(ends).get(number, goal), send, result,
                                        result - send, state, 0, 0, 0])))
    (folder / 'legs.csv.gz').write_bytes(gzip.compress(('\n'.join(lines) + '\n').encode()))
    write_map(str(folder), 'hall', np.zeros((100, 300), bool), 0.1)


HEAD_ON = [(0, 1, (2.0, 5.0, 0.0), (28.0, 5.0, 0.0), 0.0, 40.0, 3),
           (1, 1, (28.0, 5.5, 3.14), (2.0, 5.5, 3.14), 0.0, 60.0, 3),
           (0, 2, (28.0, 5.0, 0.0), (28.0, 8.0, 0.0), 50.0, 58.0, 3)]


def test_who_meets_whom_follows_from_ways_and_times(tmp_path):
    write_recording(tmp_path, HEAD_ON)
    calibration = read_calibration('move_base_dwa_stage', 'test')
    first, again, other = met_legs(tmp_path, calibration, 3.0, 0.4)
    assert (first.map, first.way.length, first.duration, first.succeeded) == ('hall', 26.0, 40.0, True)
    (meeting,), (back,) = first.meetings, other.meetings
    assert (meeting.kind, meeting.may_yield, meeting.other) == ('head_on', True, 2) and back.other == 0
    assert meeting.nearest == back.nearest == pytest.approx(0.5, abs=1e-3)
    assert meeting.after == pytest.approx(13.5, abs=1.0)
    assert again.meetings == ()


def test_a_robot_that_stands_after_its_last_goal_is_met(tmp_path):
    write_recording(tmp_path, [(0, 1, (2.0, 5.0, 0.0), (15.0, 5.0, 0.0), 0.0, 20.0, 3),
                               (1, 1, (28.0, 5.5, 3.14), (2.0, 5.5, 3.14), 30.0, 60.0, 3)])
    first, other = met_legs(tmp_path, read_calibration('move_base_dwa_stage', 'test'), 3.0, 0.4)
    (meeting,) = other.meetings
    assert (meeting.kind, meeting.may_yield, meeting.other) == ('standing', True, None) and first.meetings == ()
    assert meeting.nearest == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize('old, new, message', [
    (b'm,1,1', b'other,1,1', "legs.csv.gz: run: got 'other'; allowed: one that missions.csv has"),
    (b'0.0,60.0,60.0', b',60.0,60.0', 'legs.csv.gz: run m, robot 1, goal 1: no number in send_s'),
    (b'send_s', b'sent', 'legs.csv.gz: run m, robot 0, goal 1: no number in send_s'),
    (b'28.0', b'x', "legs.csv.gz: line 2: goal_x: got 'x'"), (b'run,', b'', 'legs.csv.gz: line 2: got')])
def test_what_is_wrong_with_a_recording_is_named(tmp_path, old, new, message):
    write_recording(tmp_path, HEAD_ON)
    path = tmp_path / 'legs.csv.gz'
    path.write_bytes(gzip.compress(gzip.decompress(path.read_bytes()).replace(old, new, 1)))
    with pytest.raises(ConfigurationError, match=message):
        met_legs(tmp_path, read_calibration('move_base_dwa_stage', 'test'), 3.0, 0.4)
    path.write_bytes(path.read_bytes()[:-6])
    with pytest.raises(ConfigurationError, match='legs.csv.gz: cannot be read as CSV'):
        met_legs(tmp_path, read_calibration('move_base_dwa_stage', 'test'), 3.0, 0.4)


def test_calibrate_says_what_it_lacks(tmp_path, capsys):
    write_recording(tmp_path, HEAD_ON)
    with pytest.raises(SystemExit) as end:
        command.main([str(tmp_path), '--encounters', 'move_base_dwa_stage', '-o', str(tmp_path / 'new.yaml')])
    assert end.value.code == 2 and 'got 2 legs that met a robot' in capsys.readouterr().err


def test_legs_of_several_folders_meet_those_of_their_own_folder(tmp_path, monkeypatch):
    for name in ('monday', 'tuesday'):
        (tmp_path / name).mkdir()
        write_recording(tmp_path / name, HEAD_ON)
    fitted = SimpleNamespace(values={}, counts={'head_on': 4})
    monkeypatch.setattr(encounter_report, 'fit_encounters', lambda *_: fitted)
    monkeypatch.setattr(encounter_report, 'map_scores', lambda *_: [])
    folders = [str(tmp_path / name) for name in ('monday', 'tuesday')]
    values, _, _, legs = encounter_report.calibrate_encounters(folders, 'move_base_dwa_stage', 0.4)
    assert [[one.other for one in leg.meetings] for leg in legs] == [[2], [], [0], [5], [], [3]]
    assert values['encounters']['source'] == '4 encounters on 4 of 6 legs of 1 maps'


def test_what_else_the_calibration_says_stays(tmp_path, monkeypatch):
    values = {key: value for key, value in VALUES.items() if key != 'format'}
    monkeypatch.setattr(encounter_report, 'calibrate_encounters', lambda *_: (values, None, None, None))
    monkeypatch.setattr(encounter_report, 'lines', lambda *_: [])
    command.main([str(tmp_path), '--encounters', 'move_base_dwa_stage', '-o', str(tmp_path / 'new.yaml')])
    assert {'recorded', 'intervals', 'tail_motion', 'encounters'} <= set(VALUES)
    assert yaml.safe_load((tmp_path / 'new.yaml').read_text()) == VALUES
