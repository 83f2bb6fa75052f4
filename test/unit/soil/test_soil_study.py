"""Which trials a study is made of, and what its report says of those that are there."""

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments.description import plan, spec
from move_base_abstract_experiments.report import command as report, extension, outcome
from move_base_abstract_experiments.results import tables as tables_of_trials
from soil_mapping.config import TrialConfig
from soil_mapping.ground_truth.field import load_field
from soil_mapping.results.comparison import differences
from soil_mapping.results.result import Metrics
from soil_mapping.results.trial_folder import read_trial, write_files
from soil_mapping.study import command, groups, outcomes, sections, tables, wording
from soil_mapping.study.provenance_tables import provenance
from soil_mapping.study.spec import TrialSpec

CONFIG = TrialConfig(budget_s=90.0, cell_m=2)
GROUPS = ('mesa', 'ros-lockstep', 'ros-10x')


def run_mesa_trial(*arguments):
    pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
    from soil_mapping.mesa_models import mesa_model
    return mesa_model.run_mesa_trial(*arguments)


def experiment_of(*others, **more):
    """Return the Experiment that `study run` makes, from the text of its file."""
    document = command.document(*others, **more)
    return spec.checked(yaml.safe_load(yaml.safe_dump(document, allow_unicode=True)), '/folder')


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    """A study of two seeds: Mesa, the same as if ROS had done it in lockstep, and late by 10 % as if at 10x."""
    folder = tmp_path_factory.mktemp('study')
    made = experiment_of(CONFIG, GROUPS, 2, 2)
    trials = plan.trials(made)
    (folder / 'plan.json').write_bytes(b''.join(tables_of_trials.plan_text(plan.describe(made, trials, b''))))
    results = {}
    for one in trials:
        names = {name: one.configuration[name] for name in ('allocation', 'sampling')}
        key = (*names.values(), one.seed)
        if key not in results:
            results[key] = run_mesa_trial(replace(CONFIG, **names), one.seed)
        group = one.configuration['engine']
        result = late(results[key]) if group == 'ros-10x' else results[key]
        write(folder / 'trials' / one.id, one, replace(result, engine=groups.specs_of([group], CONFIG)[0].about_engine))
    return folder


def write(path, one, result):
    """Leave a trial's folder as the runner does."""
    path.mkdir(parents=True)
    write_files(path, result)
    for file in list(path.iterdir()):
        file.rename(path / f'files-{file.name}')
    about = {'format': 1, 'id': one.id, 'configuration': one.configuration, 'replication': one.replication,
             'seed': one.seed, 'status': 'complete', 'metrics': {}, 'simulated_seconds': result.simulated_s}
    (path / 'trial.json').write_text(json.dumps(about))


@pytest.fixture(scope='module')
def study(folder):
    """The complete trials of that study, by group."""
    return outcomes.collect_trials(outcome.read(folder))


def late(result):
    """Return the result with all arrivals 10 % late, and distances as much too long."""
    events = [event._replace(time_ns=event.time_ns + 100_000_000) if event.event == 'arrive' else event
              for event in result.events]
    metrics = Metrics(**dict(result.metrics._asdict(), distance_m=1.1 * result.metrics.distance_m))
    return replace(result, events=events, metrics=metrics)


def test_a_study_has_four_configurations_and_all_seeds_on_both_engines():
    trials = plan.trials(experiment_of(CONFIG, groups.chosen(None), 3, 1))
    for group in groups.chosen(None):
        own = [one for one in trials if one.configuration['engine'] == group]
        assert len({tuple(one.configuration.values()) + (one.seed,) for one in own}) == len(own) == (
            4 if group in groups.SCALED else 12)
    assert len({one.id for one in trials}) == len(trials)


def test_the_file_that_ships_is_what_study_run_makes_without_options():
    path = Path(__file__).resolve().parents[3] / 'config' / 'experiments' / 'soil_study.yaml'
    assert spec.read(str(path), '/folder') == experiment_of(TrialConfig(), groups.chosen(None), 10, 3, 0.05)


def test_of_the_scaled_clock_there_may_be_more_seeds_too():
    trials = plan.trials(experiment_of(CONFIG, GROUPS, 1, 2))
    assert {group: sum(one.configuration['engine'] == group for one in trials) for group in GROUPS} == {
        'mesa': 4, 'ros-lockstep': 4, 'ros-10x': 8}


def test_real_time_is_run_only_when_asked_for():
    assert 'ros-1x' not in groups.chosen(None)
    assert groups.chosen(['ros-1x'], with_1x=True) == ['ros-1x']
    assert command.document(CONFIG, ['ros-1x'], 1, 1)['time_limit'] > 2.0 * CONFIG.budget_s


def test_each_group_has_its_engine():
    told = {group: found.about_engine for group, found in zip(groups.ALL, groups.specs_of(groups.ALL, CONFIG))}
    assert told['mesa-eight'] == {'name': 'mesa', 'motion': 'eight'}
    assert told['ros-lockstep'] == {'name': 'ros', 'clock': 'lockstep', 'limit': 0.0, 'charge': 'none'}
    assert told['ros-15x'] == {'name': 'ros', 'clock': 'scaled', 'factor': 15.0}


def test_a_trial_of_another_content_of_its_field_is_another_trial(tmp_path):
    readings = tmp_path / 'readings.csv'
    readings.write_text('lat,lon,v\n1,2,800\n')
    made = experiment_of(replace(CONFIG, field=f'csv:{readings}'), ['mesa'], 1, 1)
    one = plan.trials(made)[0]
    before = plan.made_of(one)
    readings.write_text('lat,lon,v\n1,2,900\n')
    plan.forget()
    assert plan.made_of(one) != before


@pytest.mark.parametrize(('wrong', 'text'), [
    ({'engine': 'gazebo'}, "engine: got 'gazebo'; allowed: 'ros' or 'mesa'"),
    ({'clock': 'wall'}, "clock: got 'wall'; allowed: 'lockstep' or 'scaled'"),
    ({'seed': -1}, 'seed: got -1; allowed: a whole number in 0..9223372036854775807'),
    ({'seed': 10 ** 5000}, 'got a whole number of about 5001 digits'),
    ({'charge': 'bogus'}, "charge: got 'bogus'; allowed: 'none'"),
    ({'engine': 'mesa', 'motion': 'eight', 'config': TrialConfig(cell_m=1)}, "motion 'eight' needs cell_m 2, got 1"),
    ({'factor': 0.0}, r'factor: got 0.0; allowed: a number in 0.01..1e6'),
    ({'limit': -1.0}, r'limit: got -1.0; allowed: a number in 0.01..1e6, or 0')])
def test_a_trial_that_cannot_be_is_refused(wrong, text):
    with pytest.raises(ConfigurationError, match=text):
        TrialSpec(**wrong)


def test_a_recorded_charge_is_an_input_by_its_content(tmp_path):
    (tmp_path / 'charge').write_text('{"time_ns": 1, "cost_ns": 1}\n')
    one = TrialSpec(config=CONFIG, charge=f'replay:{tmp_path}/charge')
    assert set(one.inputs) == {'charge'}
    assert replace(one, engine='mesa').inputs == {}


@pytest.mark.parametrize(('words', 'complaint'), [
    (['trial', '--engine', 'mesa', '--charge', 'bogus'], '--charge applies to --engine ros --clock lockstep only'),
    (['trial', '--engine', 'mesa', '--clock', 'scaled'], '--clock applies to --engine ros only'),
    (['trial', '--clock', 'scaled', '--limit', '2'], '--limit applies to --engine ros --clock lockstep only'),
    (['trial', '--factor', '2'], '--factor applies to --engine ros --clock scaled only'),
    (['trial', '--motion', 'eight'], '--motion applies to --engine mesa only'),
    (['trial', '--engine', 'mesa', '--bag'], '--bag applies to --engine ros only'),
    (['trial', '--engine', 'mesa', '--motion', 'eight'], "motion 'eight' needs cell_m 2, got 1"),
    (['trial', '--charge', 'bogus'], "charge: got 'bogus'; allowed: 'none'"),
    (['trial', '--charge', 'replay:/no/such'], '/no/such: cannot be read'),
    (['trial', '--field', 'x' * 5001], "field must be 'synthetic'"),
    (['trial', '--output', ''], "--output: must be the name of a folder, got ''"),
    (['trial', '--output', '/'], '/: must be a folder that can be given its name'),
    (['run', '--groups', 'mesa', 'ros_lockstep'], "--groups: there is no group 'ros_lockstep'; there are mesa,"),
    (['run', '--output', ''], '--output: must be')])
def test_arguments_that_cannot_be_used_are_refused_at_once_and_leave_nothing(tmp_path, monkeypatch, capsys, words,
                                                                             complaint):
    monkeypatch.chdir(tmp_path)
    assert command.main(words) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert len(said) < 500
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('words', [['--seed', '1' * 5001], ['--robots', '9' * 5001], ['--seed', '1e3'],
                                   ['--robots', '10001'], ['--budget', '-1'], ['--speed', 'nan'],
                                   ['--factor', '1_0'], ['--limit', '1_0']])
def test_numbers_that_cannot_be_are_refused_in_a_line_or_two(capsys, words):
    with pytest.raises(SystemExit) as caught:
        command.main(['trial', *words])
    assert caught.value.code == 2
    assert len(capsys.readouterr().err) < 2000


def test_no_command_touches_what_is_not_its_own(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / '.ssh').mkdir()
    (tmp_path / '.ssh' / 'id').write_text('precious')
    (tmp_path / 'trial').write_text('precious')
    mesa = ['--engine', 'mesa', '--budget', '5', '--cell', '2']
    for words, named in ((['trial', *mesa], 'trial'), (['trial', *mesa, '--output', '.'], ''),
                         (['trial', *mesa, '--output', '.ssh'], '.ssh'), (['run', '--output', '.'], ''),
                         (['run', '--output', 'trial'], 'trial')):
        assert command.main(words) == 2, words
        assert f'study: {tmp_path / named}: ' in capsys.readouterr().err
    assert (tmp_path / '.ssh' / 'id').read_text() == (tmp_path / 'trial').read_text() == 'precious'
    assert len(list(tmp_path.iterdir())) == 2


def test_an_output_that_cannot_be_written_is_named(tmp_path, capsys):
    (tmp_path / 'file').write_text('x')
    words = ['trial', '--engine', 'mesa', '--budget', '5', '--cell', '2', '--output', str(tmp_path / 'file' / 'trial')]
    assert command.main(words) == 1
    assert f'{tmp_path}/file/trial' in capsys.readouterr().err


def test_legs_of_straight_motion_have_no_error_and_late_ones_have_theirs(study):
    exact = read_trial(study['mesa'][0].path, outcomes.FILES)
    errors_ns, errors = outcomes.leg_errors(exact)
    assert len(errors) > 3
    assert set(errors_ns) == {0}
    assert set(errors) == {0.0}
    assert set(outcomes.leg_errors(late(exact))[0]) == {100_000_000}


def test_the_report_names_runs_that_are_identical_and_those_that_are_not(study):
    assert [row[0] + ': ' + row[3] for row in tables.identities(study).rows] == ['Mesa and ROS, lockstep: yes']
    changed = [replace(trial, events_sha256='another') for trial in study['mesa']]
    assert tables.identities(dict(study, mesa=changed)).rows[0][2:] == ('0', 'no')


def test_the_cosine_table_begins_with_the_published_rows_and_goes_on_with_ours(study):
    table = tables.cosines(study)
    assert table.header[:3] == ('first', 'second', 'mean_cosine_similarity')
    assert [row[2] for row in table.rows[:3]] == ['0.969960079', '0.992865229', '0.869587149']
    assert [row[:2] for row in table.rows[3:6]] == [
        ('Mesa', 'ROS, 10x'), ('ROS, 1x', 'ROS, 10x'), ('ROS, 1x', 'ROS, 15x')]
    assert re.fullmatch(r'[01]\.\d{9}', table.rows[3][2])
    assert [row[-1] for row in table.rows[4:6]] == ['not run: ROS, 1x; real time runs with STUDY_1X=1',
                                                    'not run: ROS, 1x, ROS, 15x; real time runs with STUDY_1X=1']
    ours = {row[:2]: row for row in table.rows[3:]}
    assert ours['Mesa', 'ROS, lockstep'][2] == '1.000000000'
    for column in (3, 4):  # interval, noise floor
        assert re.fullmatch(r'[01]\.\d{4} to [01]\.\d{4}', ours['Mesa', 'ROS, lockstep'][column])
    assert '0.97' not in table.note  # no fixed sentence: the floor stands in the table


def test_errors_that_a_cosine_does_not_feel_are_told(study):
    titles = {table.title: table for table in tables.scale_errors(study)}
    table = titles['ROS, 10x against ROS, lockstep']
    column = table.header.index('distance [m]')
    assert [row[column].split(';')[0] for row in table.rows] == ['+10 %'] * 4


def test_a_difference_from_nothing_is_told_by_its_values_and_not_as_none():
    study = {'ssi_random': np.array([[1.0] * 6] * 3)}
    nothing = {'ssi_random': np.array([[0.0] + [1.0] * 5] * 3)}
    first, second = differences(nothing, study)[:2]
    assert wording.change(first) == '0 became 1'
    assert wording.in_deviations(first) == 'no scatter'
    assert wording.change(second) == '0 %'
    assert wording.number(float('nan')) == 'unknown'
    assert wording.number(5.3e-14) == '0'


def test_errors_of_legs_are_told_in_units_that_are_read(study):
    assert [wording.duration(ns) for ns in (0, 12, 1_500, -2_500_000, 3_210_000_000)] == [
        '0 ns', '12 ns', '1.5 µs', '-2.5 ms', '3.21 s']
    rows = {row[0]: row for row in tables.legs(study).rows}
    assert rows['ROS, lockstep'][-1] == '0: exact'
    assert rows['ROS, 10x'][-2:] == ('100 ms', '100 ms')


def test_the_report_says_where_its_figures_come_from(study):
    parameters, trials, programs = provenance(study)
    values = {row[0]: row[1:] for row in parameters.rows}
    assert values['budget_s'] == ('90.0', 'all')
    assert values['field'] == ('synthetic, 324 x 220 m', 'all')
    assert trials.rows[0][:2] == ('Mesa', 'name mesa, motion euclidean')
    assert 'SSI random: 0, 1' in trials.rows[0][2]
    assert [row[0] for row in programs.rows] == ['versions', 'machine']
    assert 'numpy' in programs.rows[0][1]


def test_the_report_has_the_studys_sections_and_needs_no_other_file(folder):
    html = report.write(folder)[0].read_text()
    for heading in ('Is it the same?', 'How much does it differ?', 'Error against speed-up', 'Maps of one trial: ROS'):
        assert heading in html
    assert html.count('data:image/png;base64,') == 4
    assert 'TAROS 22 Mesa trials' in html
    assert 'They could not be made' not in html
    assert not re.search(r'(src|href)="(?!data:|#|\.|trials/|replays/)', html)


def test_without_a_complete_trial_the_study_adds_nothing(tmp_path):
    made = experiment_of(CONFIG, GROUPS, 1, 1)
    described = plan.describe(made, plan.trials(made), b'')
    (tmp_path / 'plan.json').write_bytes(b''.join(tables_of_trials.plan_text(described)))
    assert sections.sections(extension.Tables(outcome.read(tmp_path), *[None] * 5)) == []


def test_a_folder_without_a_study_is_an_error_that_says_what_makes_one(tmp_path, capsys):
    assert command.main(['report', '--output', str(tmp_path)]) == 2
    assert '`experiment run FILE -o OUT` makes it' in capsys.readouterr().err


AHEAD = """
import os, signal, sys
sys.path.insert(0, {source!r})
from move_base_abstract.common import processes
from soil_mapping.config import TrialConfig
from soil_mapping.study import field_cache
field = field_cache.truth_of(TrialConfig(field='synthetic:3'))
draw = field.draw
field.draw_by(lambda: print('drawn by', 'me' if os.getpid() == me else 'another', flush=True) or draw())
me, output = os.getpid(), os.fdopen(os.dup(1), 'w')
os.devnull = '/dev/stdout'  # so that what the other process prints is seen
fork = processes.fork
processes.fork = lambda *words: children.append(fork(*words))
children = []
field_cache.draw_ahead(TrialConfig(field='synthetic:3'))
if {killed}:
    os.kill(children[0], signal.SIGKILL)
print(field.values[3, 4])
"""


@pytest.mark.parametrize('killed, who', [(False, ['another']), (True, ['me'])])
def test_a_field_that_another_process_draws_is_the_same_also_where_that_is_killed(killed, who):
    source = str(Path(__file__).resolve().parents[3] / 'src')
    done = subprocess.run([sys.executable, '-c', AHEAD.format(source=source, killed=killed)], stdout=subprocess.PIPE,
                          timeout=60, check=True, text=True,
                          env={**os.environ, 'OPENBLAS_NUM_THREADS': '1'})
    *lines, value = done.stdout.split('\n')[:-1]
    assert float(value) == load_field('synthetic:3').values[3, 4]
    assert [line.split()[-1] for line in lines][-1:] == who
