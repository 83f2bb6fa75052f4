"""A trial again: how it is looked at, what it is compared with, what cannot be run again."""
import io
import json
import os
import shutil

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments import command, records, rerun
from move_base_abstract_experiments.description import ingredients, plan, spec
from move_base_abstract_experiments.trials import execution

ID = '0001-ab12cd'


def test_rviz_shows_the_robots(monkeypatch):
    monkeypatch.setattr(shutil, 'which', lambda name: f'/bin/{name}')
    path, option, config = rerun._rviz_words()
    assert (path, option) == ('/bin/rviz', '-d')
    with open(config, encoding='utf-8') as stream:
        assert '/move_base_abstract/markers' in stream.read()
    assert os.path.basename(config) == 'simulator.rviz'


def left(metrics, *logs):
    """Return what a trial's process leaves, as rerun has it."""
    result = records.Result(ID, status='complete', metrics=metrics)
    return rerun._Left(result, b'' if logs else None)


@pytest.mark.parametrize('was, now, logs, said', [
    ({'a': 1}, {'a': 1}, (), 'the same trial, by its metrics'), ({'a': 1}, {'a': 2}, (), 'different: a: 1 / 2'),
    ({'a': 1, 'b': 2}, {'a': 1}, (), "different: b: 2 / 'none'"),
    ({}, {}, (), 'nothing to compare'),
    ({'a': 1}, {'a': 1}, (('events.jsonl', ''),), 'different: an event log the second time only')])
def test_a_function_is_compared_by_all_that_it_gave(tmp_path, was, now, logs, said):
    stream = io.StringIO()
    before = str(tmp_path / 'events.jsonl')
    code = rerun._compare_function(left(now, *logs), before, records.Result(ID, metrics=was), stream)
    assert said in stream.getvalue()
    assert code == (rerun.DIFFERENT if 'different' in said else rerun.SAME)


@pytest.mark.parametrize('ended_by, until, said', [
    ('seconds', True, 'the same trial: 1 events up to there'), ('idle', True, "'arrived' [] / no more events"),
    ('seconds', False, "'arrived' [] / no more events")])
def test_a_trial_that_ends_earlier_by_itself_is_not_the_beginning_of_the_other(tmp_path, ended_by, until, said):
    head, row = '{"event_log":1}\n', '{"time_ns":%d,"robot":"a","kind":"arrived","values":[]}\n'
    (tmp_path / 'events.jsonl').write_text(head + row % 1 + row % 2)
    result, stream = records.Result(ID, status='complete', ended_by=ended_by), io.StringIO()
    code = rerun._compare(rerun._Left(result, (head + row % 1).encode()), str(tmp_path / 'events.jsonl'), until, stream)
    assert said in stream.getvalue() and code == (rerun.SAME if 'same' in said else rerun.DIFFERENT)


def test_a_log_that_a_function_left_is_missed(tmp_path):
    (tmp_path / 'events.jsonl').write_text('')
    stream = io.StringIO()
    before = str(tmp_path / 'events.jsonl')
    assert rerun._compare_function(left({}), before, records.Result(ID), stream) == rerun.DIFFERENT
    assert 'an event log the first time only' in stream.getvalue()


def test_a_function_that_gives_less_the_second_time_is_another_one():
    assert execution.other_metrics({'a': 1, 'b': None}, {'a': 1, 'b': None}) is None
    assert execution.other_metrics({'a': 1, 'b': None}, {'a': 1}) == "b: None / 'none'"


@pytest.fixture
def folder(tmp_path):
    """An experiment's folder, of which nothing has run."""
    (tmp_path / 'plan.json').write_text(json.dumps({'format': 1, 'provenance': {}}))
    (tmp_path / 'experiment.yaml').write_text('{experiment: x, function: "model:run"}')
    return tmp_path


@pytest.mark.parametrize('change, metrics, code, said', [
    ('', {'a': 1}, rerun.SAME, ''), ('', {'a': 2}, rerun.DIFFERENT, ''),
    ('x = 1', {'a': 1}, rerun.SAME, 'model.py has changed since the trial was recorded'),
    ('x = 1', {'a': 2}, rerun.CHANGED, 'model.py has changed since the trial was recorded')])
def test_that_the_program_has_changed_since_is_said_and_is_no_word_on_repeating(
        folder, monkeypatch, change, metrics, code, said):
    (folder / 'model.py').write_text('def run(args, seed):\n    return {"a": 1}\n')
    plan.forget()
    experiment = spec.read(str(folder / 'experiment.yaml'))
    one, = plan.trials(experiment)
    made = ingredients.of_trial(one)
    (folder / 'programs.json').write_text(json.dumps({ingredients.name_of(made): made}))
    (folder / 'trials' / one.id).mkdir(parents=True)
    (folder / 'trials' / one.id / 'trial.json').write_text(json.dumps({
        'format': 1, 'id': one.id, 'status': 'complete', 'metrics': {'a': 1}, 'labels': [],
        'made_of': plan.made_of(one), 'program': ingredients.name_of(made)}))
    with open(folder / 'model.py', 'a') as stream:
        stream.write(change)
    plan.forget()
    monkeypatch.setattr(rerun, '_run', lambda job, logs, stream: left(metrics))
    stream = io.StringIO()
    assert rerun.rerun(str(folder), '1', stream=stream) == code
    assert (said in stream.getvalue()) and ('since' in stream.getvalue()) == bool(change)


def test_a_trial_that_has_not_run_cannot_be_run_again(folder, capsys):
    assert command.main(['rerun', str(folder), '1']) == command.CANNOT
    assert 'the trial has not run to its end' in capsys.readouterr().err


def test_a_folder_that_is_there_is_not_taken_for_logs(folder):
    (folder / 'logs').mkdir()
    with pytest.raises(ConfigurationError, match='--logs: .*logs is there already'):
        rerun.rerun(str(folder), '1', logs=str(folder / 'logs'))


def test_a_number_that_int_does_not_read_is_no_trial(folder):
    with pytest.raises(ConfigurationError, match='TRIAL'):
        rerun.rerun(str(folder), '\u00b2')


def test_ctrl_c_ends_it_with_a_line(monkeypatch, capsys):
    def interrupted(*_words, **_options):
        raise KeyboardInterrupt
    monkeypatch.setattr(rerun, 'rerun', interrupted)
    assert command.main(['rerun', 'x', '1']) == command.INTERRUPTED
    assert capsys.readouterr().err == 'experiment: interrupted\n'
