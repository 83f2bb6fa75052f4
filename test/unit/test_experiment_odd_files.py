"""Folders of experiments that hold what no program of ours has written: every sub-command says so in a line."""
import io
import json
import os
import tarfile

import pytest
from night import is_night

from move_base_abstract_experiments import command, records, sweep
from move_base_abstract_experiments.results import outputs, tables
from test_experiment_outputs import ID, PLAN, packed, trial

DEEP = '[' * 100_000 + ']' * 100_000
WHOLE = {**PLAN, 'provenance': {}, 'trials': [{'id': ID, 'configuration': {'robots': 1}, 'replication': 0, 'seed': 3}]}
TEXTS = [b'', b'{', b'null', b'[1]', b'7', b'"x"', b'\xff\xfe\x00', b'\x7fELF\x02\x01', DEEP.encode(), b'{"format": 2}',
         b'{"format": true}', b'{"format": [1]}', b'{"format": 1e999}', b'9' * 5000]
ODD = [None, 0, -1, True, 1.5, float('inf'), 10 ** 400, '', '\udcff\n', [], [None], {}, {'': None}, {'x': []}]


@pytest.fixture
def out(tmp_path):
    """An experiment's folder with one trial."""
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.put(packed(trial()), 'w', 1)
        folder.write('plan.json', json.dumps(WHOLE).encode())
        tables.write(folder, records.read_plan(str(folder.path)))
        folder.write('experiment.yaml', b'{experiment: x, function: "model:run"}')
    return tmp_path / 'out'


def files(out):
    return {'plan': out / 'plan.json', 'trial': out / 'trials' / ID / 'trial.json', 'yaml': out / 'experiment.yaml'}


def said(out, capsys, verbs=(['status'], ['report'], ['rerun', '1'])):
    """Run sub-commands: none raises, and whoever fails says why in a line."""
    for verb, *rest in verbs:
        code = command.main([verb, str(out), *rest])
        text = capsys.readouterr()
        assert 'Traceback' not in text.err, text.err
        assert code in (command.GOOD, command.BAD, command.CANNOT), code
        if code == command.CANNOT:
            assert text.err.startswith('experiment: '), text.err
            assert len(text.err.splitlines()) == 1 and len(text.err) < 1000, text.err
        yield code


def verbs_for(value, turn=None):
    """Return the sub-commands for an odd value: a report takes long, so that not each value gets one.

    ``turn``: by day, one value in turn.
    """
    reported = [None, [], 10 ** 400, '\udcff\n']
    if turn is not None and not is_night():
        reported = [reported[turn % len(reported)]]
    return (['status'], ['rerun', '1']) + ((['report'],) if value in reported else ())


@pytest.mark.parametrize('name', ['plan', 'trial', 'yaml'])
@pytest.mark.parametrize('text', TEXTS, ids=range(len(TEXTS)))
def test_a_file_that_is_none_of_ours_is_told(out, capsys, name, text):
    files(out)[name].write_bytes(text)
    codes = list(said(out, capsys))
    assert codes[0] == (command.CANNOT if name == 'plan' else command.GOOD)
    assert codes[2] == command.CANNOT


@pytest.mark.parametrize('name', ['plan', 'trial', 'yaml'])
@pytest.mark.parametrize('kind', ['pipe', 'folder', 'link', 'nothing', 'device'])
def test_what_is_no_file_is_not_read(out, capsys, name, kind):
    path = files(out)[name]
    path.unlink()
    if kind == 'pipe':
        os.mkfifo(path)
    elif kind == 'folder':
        path.mkdir()
    elif kind != 'nothing':
        path.symlink_to('/dev/zero' if kind == 'device' else path)
    codes = list(said(out, capsys, (['status'], ['report']) if name == 'yaml' and kind in ('pipe', 'device') else (
        ['status'], ['report'], ['rerun', '1'])))
    assert codes[0] == (command.CANNOT if name == 'plan' else command.GOOD)


@pytest.mark.parametrize('key', ['experiment', 'factors', 'metrics', 'provenance', 'trials', 'report', 'kept'])
def test_a_plan_of_odd_values_is_told(out, capsys, key):
    for value in ODD:
        files(out)['plan'].write_text(json.dumps({**WHOLE, key: value}))
        list(said(out, capsys, verbs_for(value)))


@pytest.mark.parametrize('key', ['id', 'configuration', 'replication', 'seed'])
def test_a_planned_trial_of_odd_values_is_told(out, capsys, key):
    for value in ODD:
        files(out)['plan'].write_text(json.dumps({**WHOLE, 'trials': [{**WHOLE['trials'][0], key: value}]}))
        list(said(out, capsys, verbs_for(value)))


@pytest.mark.parametrize('turn, key', enumerate([
    'id', 'configuration', 'replication', 'seed', 'status', 'error', 'metrics', 'simulated_seconds', 'repeatable',
    'labels', 'events', 'log_sha256', 'verified', 'difference', 'robots', 'made_of', 'worker', 'attempts']))
def test_a_trial_of_odd_values_is_told(out, capsys, turn, key):
    about = json.loads(files(out)['trial'].read_text())
    for value in ODD:
        for status in ('complete', 'failed'):
            files(out)['trial'].write_text(json.dumps({**about, 'status': status, key: value}))
            list(said(out, capsys, verbs_for(value, turn)))


@pytest.mark.parametrize('place', ['', 'trials', 'nothing'])
def test_a_folder_that_is_none_of_an_experiment_is_told(tmp_path, out, capsys, place):
    path = tmp_path / 'other'
    path.write_bytes(b'text') if place == '' else path.mkdir()
    for one in (path, path / 'plan.json', '/dev/null', '\0', 'x' * 300):
        assert set(said(one, capsys)) == {command.CANNOT}


def test_a_trials_folder_that_is_a_file_is_as_if_nothing_had_run(out, capsys):
    os.rename(out / 'trials', out / 'others')
    (out / 'trials').write_text('')
    assert list(said(out, capsys, (['status'],))) == [command.GOOD]


def test_half_characters_of_a_trial_stop_no_table(tmp_path):
    stream = io.BytesIO(packed(trial(error='\udcff', labels=['\ud800'], metrics={'a': float('nan')})))
    with outputs.OutputFolder(tmp_path / 'out') as folder, tarfile.open(fileobj=stream):
        about = folder.put(stream.getvalue(), 'w', 1)
        folder.write('plan.json', json.dumps(WHOLE).encode())
        tables.write(folder, records.read_plan(str(folder.path)))
    assert (about.error, about.labels, about.metrics) == ('\\udcff', ['\\ud800'], {'a': None})
    assert '\\udcff' in (tmp_path / 'out' / 'trials.csv').read_text()


@pytest.mark.parametrize('name, make', [
    ('trials', os.mkfifo), ('trials', os.mknod), ('plan.json', os.mkdir), ('experiment.yaml', os.mkdir),
    ('trials.csv', os.mkdir)])
def test_what_is_in_the_way_of_a_run_is_told_and_stays(tmp_path, capsys, monkeypatch, name, make):
    monkeypatch.setattr(sweep, 'check', lambda *_all: [])
    monkeypatch.setattr(sweep, '_run_missing', lambda *_all: None)
    (tmp_path / 'model.yaml').write_text('{experiment: x, function: "model:run"}')
    with outputs.OutputFolder(tmp_path / 'out'):
        pass
    path = tmp_path / 'out' / name
    if name == 'trials':
        path.rmdir()
    make(path)
    before = os.lstat(path)
    assert command.main(['run', str(tmp_path / 'model.yaml'), '-o', str(tmp_path / 'out')]) == command.CANNOT
    assert capsys.readouterr().err.startswith('experiment: ')
    assert os.path.samestat(os.lstat(path), before)
