"""Which trials a study is made of, and what its report says of those that are there."""

import base64
import re
from dataclasses import replace

import numpy as np
import pytest

from move_base_abstract.errors import ConfigurationError
from soil_mapping.comparison import differences
from soil_mapping.config import TrialConfig
from soil_mapping.result import Metrics
from soil_mapping.study import collection, pages, report, study_folder, tables, truth, wording
from soil_mapping.study import spec as spec_module
from soil_mapping.study.command import main
from soil_mapping.study.plan import plan
from soil_mapping.study.pool import path_of
from soil_mapping.study.provenance_tables import provenance
from soil_mapping.study.running import is_done
from soil_mapping.study.spec import TrialSpec
from soil_mapping.trial_folder import TrialFolder, read_about, read_trial

CONFIG = TrialConfig(budget_s=90.0, cell_m=2)
ALL = [replace(CONFIG, allocation=allocation, sampling=sampling)
       for allocation in ('ssi', 'rr') for sampling in ('random', 'dynamic')]


def run_mesa_trial(*arguments):
    pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
    from soil_mapping import mesa_model
    return mesa_model.run_mesa_trial(*arguments)


def write(folder, spec, result):
    with TrialFolder(path_of(folder, spec)) as trial:
        return trial.finish(replace(result, engine=spec.about_engine))


@pytest.fixture(scope='module')
def study(tmp_path_factory):
    """A study of two seeds: Mesa, the same as if ROS had done it in lockstep, and late by 10 % as if at 10x."""
    folder = tmp_path_factory.mktemp('study')
    for config in ALL:
        for seed in range(2):
            spec = TrialSpec(config=config, seed=seed, engine='mesa')
            result = run_mesa_trial(config, seed)
            write(folder, spec, result)
            write(folder, replace(spec, engine='ros'), result)
            write(folder, replace(spec, engine='ros', again=1), result)
            write(folder, replace(spec, engine='ros', clock='scaled'), late(result))
    return folder


def late(result):
    """Return the result with all arrivals 10 % late, and distances as much too long."""
    events = [event._replace(time_ns=event.time_ns + 100_000_000) if event.event == 'arrive' else event
              for event in result.events]
    metrics = Metrics(**dict(result.metrics._asdict(), distance_m=1.1 * result.metrics.distance_m))
    return replace(result, events=events, metrics=metrics)


def test_a_study_has_four_configurations_and_all_seeds_on_both_engines():
    specs = plan(CONFIG, 3, 1, 2)
    for group in ('mesa', 'mesa-eight', 'ros-lockstep'):
        own = [spec for spec in specs if spec.group == group]
        assert len({(spec.config.allocation, spec.config.sampling, spec.seed) for spec in own}) == len(own) == 12
    assert {spec.group for spec in specs if spec.clock == 'scaled'} == {'ros-10x', 'ros-15x', 'ros-100x'}


def test_real_time_is_run_only_when_asked_for():
    assert not [spec for spec in plan(CONFIG, 1, 1, 2) if spec.group == 'ros-1x']
    assert len([spec for spec in plan(CONFIG, 1, 1, 2, with_1x=True) if spec.group == 'ros-1x']) == 4


def test_each_trial_of_a_study_has_a_folder_of_its_own(tmp_path):
    specs = plan(CONFIG, 10, 3, 2, with_1x=True)
    assert len({path_of(tmp_path, spec) for spec in specs}) == len(specs)


@pytest.mark.parametrize(('wrong', 'text'), [
    ({'engine': 'gazebo'}, "engine must be one of ros, mesa, got 'gazebo'"),
    ({'clock': 'wall'}, 'clock must be one of lockstep, scaled'),
    ({'seed': -1}, r'seed must be a whole number in 0..2\^63-1, got -1'),
    ({'seed': 10 ** 5000}, 'got a whole number of about 5001 digits'),
    ({'charge': 'bogus'}, "charge: got 'bogus'; allowed: 'none'"),
    ({'engine': 'mesa', 'motion': 'eight', 'config': TrialConfig(cell_m=1)}, "motion 'eight' needs cell_m 2, got 1"),
    ({'factor': 0.0}, r'factor must lie in 0.01..1e6, got 0.0'),
    ({'limit': -1.0}, r'limit must be 0 \(none\) or lie in 0.01..1e6, got -1.0')])
def test_a_trial_that_cannot_be_is_refused(wrong, text):
    with pytest.raises(ConfigurationError, match=text):
        TrialSpec(**wrong)


def test_a_complete_trial_is_not_run_again_and_one_of_other_parameters_is(study):
    spec = TrialSpec(config=ALL[0], seed=1, engine='mesa')
    path = path_of(study, spec)
    assert is_done(spec, path)
    assert not is_done(replace(spec, config=replace(ALL[0], budget_s=91.0)), path)
    assert not is_done(replace(spec, seed=2), path_of(study, replace(spec, seed=2)))


@pytest.mark.parametrize('name', ['content', 'version'])
def test_a_trial_of_another_content_of_its_field_or_of_another_version_is_run_again(tmp_path, monkeypatch, name):
    readings = tmp_path / 'readings.csv'
    readings.write_text('lat,lon,v\n1,2,800\n1.001,2.001,805\n1.002,2,790\n')
    config = replace(ALL[0], field=f'csv:{readings}', budget_s=10.0)
    spec = TrialSpec(config=config, engine='mesa')
    truth.digests.cache_clear()
    path = write(tmp_path, spec, run_mesa_trial(config, 0))
    with study_folder.opened(tmp_path / 'study', config):
        pass
    assert is_done(spec, path)
    assert study_folder.belongs(tmp_path / 'study')(read_about(path))
    if name == 'content':
        readings.write_text('lat,lon,v\n1,2,900\n1.001,2.001,905\n1.002,2,890\n')
    else:
        monkeypatch.setattr(spec_module, 'package_version', lambda: '9.9.9')
        monkeypatch.setattr(study_folder, 'package_version', lambda: '9.9.9')
    truth.digests.cache_clear()  # as in a process that is begun now
    assert not is_done(spec, path)
    with study_folder.opened(tmp_path / 'study', config):
        pass
    assert not study_folder.belongs(tmp_path / 'study')(read_about(path))


def test_a_recorded_charge_is_an_input_by_its_content(tmp_path):
    (tmp_path / 'charge').write_text('{"time_ns": 1, "cost_ns": 1}\n')
    spec = TrialSpec(config=ALL[0], charge=f'replay:{tmp_path}/charge')
    assert set(spec.inputs) == {'charge'}
    assert replace(spec, engine='mesa').inputs == {}


def test_trials_that_are_not_of_the_study_are_left_out_of_its_report(tmp_path, result):
    for seed, field in ((0, 'hill'), (1, 'another')):
        other = replace(result, seed=seed, config=dict(result.config, field=field))
        with TrialFolder(tmp_path / 'trials' / 'mesa' / 'ssi_dynamic' / f'seed_{seed:03d}') as folder:
            folder.finish(other)
    assert len(collection.collect_trials(tmp_path)['mesa']) == 2
    with study_folder.opened(tmp_path / 'new', TrialConfig.from_dict(result.config)) as new:
        (tmp_path / study_folder.FILE).write_text((new / study_folder.FILE).read_text())
    assert [trial.seed for trial in collection.collect_trials(tmp_path)['mesa']] == [0]


@pytest.mark.parametrize(('words', 'complaint'), [
    (['trial', '--engine', 'mesa', '--charge', 'bogus'], '--charge applies to --engine ros --clock lockstep only'),
    (['trial', '--engine', 'mesa', '--clock', 'scaled'], '--clock applies to --engine ros only'),
    (['trial', '--clock', 'scaled', '--limit', '2'], '--limit applies to --engine ros --clock lockstep only'),
    (['trial', '--factor', '2'], '--factor applies to --engine ros --clock scaled only'),
    (['trial', '--motion', 'eight'], '--motion applies to --engine mesa only'),
    (['trial', '--engine', 'mesa', '--bag'], '--bag applies to --engine ros only'),
    (['trial', '--engine', 'mesa', '--motion', 'eight'], "motion 'eight' needs cell_m 2, got 1"),
    (['trial', '--charge', 'bogus'], "charge: got 'bogus'; allowed: 'none'"),
    (['trial', '--charge', 'replay:/no/such'], '/no/such cannot be read'),
    (['trial', '--field', 'x' * 5001], "field must be 'synthetic'"),
    (['trial', '--output', ''], "--output: must be the name of a folder, got ''"),
    (['trial', '--output', '/'], '/: must be a folder that can be given its name'),
    (['run', '--groups', 'mesa', 'ros_lockstep'], "--groups: there is no group 'ros_lockstep'; there are mesa,"),
    (['run', '--output', ''], '--output: must be')])
def test_arguments_that_cannot_be_used_are_refused_at_once_and_leave_nothing(tmp_path, monkeypatch, capsys, words,
                                                                             complaint):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert len(said) < 500
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('words', [['--seed', '1' * 5001], ['--robots', '9' * 5001], ['--seed', '1e3'],
                                   ['--robots', '10001'], ['--budget', '-1'], ['--speed', 'nan']])
def test_numbers_that_cannot_be_are_refused_in_a_line_or_two(capsys, words):
    with pytest.raises(SystemExit) as caught:
        main(['trial', *words])
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
        assert main(words) == 2, words
        assert f'study: {tmp_path / named}: ' in capsys.readouterr().err
    assert (tmp_path / '.ssh' / 'id').read_text() == (tmp_path / 'trial').read_text() == 'precious'
    assert len(list(tmp_path.iterdir())) == 2


def test_a_report_does_not_replace_a_page_of_somebody_elses(study, tmp_path):
    page = study / 'report.md'
    kept = page.read_bytes() if page.exists() else None
    page.write_text('# Mine\n')
    try:
        with pytest.raises(ConfigurationError, match='report.md: is there already'):
            report.write(study)
        assert page.read_text() == '# Mine\n'
    finally:
        page.unlink()
        if kept:
            page.write_bytes(kept)


def test_an_output_that_cannot_be_written_is_named(tmp_path, capsys):
    (tmp_path / 'file').write_text('x')
    words = ['trial', '--engine', 'mesa', '--budget', '5', '--cell', '2', '--output', str(tmp_path / 'file' / 'trial')]
    assert main(words) == 1
    assert f'{tmp_path}/file/trial' in capsys.readouterr().err


def test_trial_json_tells_the_spec(study):
    for spec in (TrialSpec(config=ALL[2], engine='mesa'), TrialSpec(config=ALL[2], again=1),
                 TrialSpec(config=ALL[2], clock='scaled')):
        about = read_about(path_of(study, spec))
        assert spec.is_of(about)
        assert not replace(spec, load=3).is_of(about)


def test_legs_of_straight_motion_have_no_error_and_late_ones_have_theirs(study):
    exact = read_trial(path_of(study, TrialSpec(config=ALL[0], engine='mesa')))
    errors_ns, errors = collection.leg_errors(exact)
    assert len(errors) > 3
    assert set(errors_ns) == {0}
    assert set(errors) == {0.0}
    assert set(collection.leg_errors(late(exact))[0]) == {100_000_000}


def test_the_report_names_runs_that_are_identical_and_those_that_are_not(study):
    groups = collection.collect_trials(study)
    assert [row[0] + ': ' + row[3] for row in tables.identities(groups).rows] == [
        'Mesa and ROS, lockstep: yes', 'ROS, lockstep again 1 and ROS, lockstep: yes']
    changed = [replace(trial, events_sha256='another') for trial in groups['mesa']]
    assert tables.identities(dict(groups, mesa=changed)).rows[0][2:] == ('0', 'no')


def test_the_cosine_table_begins_with_the_published_rows_and_goes_on_with_ours(study):
    table = tables.cosines(collection.collect_trials(study))
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
    titles = {table.title: table for table in tables.scale_errors(collection.collect_trials(study))}
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
    rows = {row[0]: row for row in tables.legs(collection.collect_trials(study)).rows}
    assert rows['ROS, lockstep'][-1] == '0: exact'
    assert rows['ROS, 10x'][-2:] == ('100 ms', '100 ms')


def test_means_have_their_confidence_interval():
    values = [1.0, 2.0, 3.0, float('nan')]
    assert wording.mean_with_interval(values) == '2 ± 1; -0.4841 to 4.484 (3)'  # t(0.975, 2) is 4.303
    assert wording.mean_with_interval([2.0]) == '2 (1)'
    assert wording.mean_with_interval([float('nan')]) == 'unknown (0)'


def test_the_report_says_where_its_figures_come_from(study):
    parameters, trials, programs = provenance(collection.collect_trials(study))
    values = {row[0]: row[1:] for row in parameters.rows}
    assert values['budget_s'] == ('90.0', 'all')
    assert values['field'] == ('synthetic, 324 x 220 m', 'all')
    assert trials.rows[0][:2] == ('Mesa', 'name mesa, motion euclidean')
    assert 'SSI random: 0, 1' in trials.rows[0][2]
    assert [row[0] for row in programs.rows] == ['versions', 'machine']
    assert 'numpy' in programs.rows[0][1]


def test_the_report_is_one_page_that_holds_all_that_it_shows(study):
    page, text = report.write(study)
    html = page.read_text()
    pictures = re.findall(r'src="([^"]*)"', html)
    assert len(pictures) == 6
    for picture in pictures:
        kind, _, data = picture.partition(',')
        assert kind == 'data:image/png;base64'
        assert base64.b64decode(data).startswith(b'\x89PNG')
    assert 'http' not in html
    assert '| TAROS 22 Mesa trials |' in text.read_text()
    assert not list(study.glob('*.part'))


def test_a_folder_without_trials_is_an_error_that_says_what_makes_them(tmp_path, capsys):
    assert main(['report', '--output', str(tmp_path)]) == 2
    assert 'there is no complete trial; `study run` makes them' in capsys.readouterr().err


def test_texts_of_users_are_no_markup_in_the_report():
    table = tables.Table('a title', ('field',), (('csv:<script>x</script>|a\\b\nc & "d"',),), 'note <b>')
    sections = [pages.Section('<i>', (table, pages.Picture('"><b>', b'png')))]
    html, text = (pages.render(name, 'T', sections) for name in ('report.html', 'report.md'))
    for tag in ('<script', '<b>', '<i>'):
        assert tag not in html
        assert tag not in text
    assert '<td>csv:&lt;script&gt;x&lt;/script&gt;|a\\b\nc &amp; &#34;d&#34;</td>' in html
    assert '\n| csv:&lt;script>x&lt;/script>\\|a\\\\b c &amp; "d" |\n' in text
