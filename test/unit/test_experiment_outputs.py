"""The folder of an experiment: what comes into it, what is never replaced, and its table."""
import io
import json
import shutil
import sys
import tarfile

import pytest

from experiment_jobs import job_of
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments import records, sweep
from move_base_abstract_experiments.description import plan as experiment_plan
from move_base_abstract_experiments.report import outcome as report_outcome
from move_base_abstract_experiments.results import outputs, progress, resumption, state, tables

ID, OTHER = '0001-abcdef', '0002-abcdef'
ABOUT = {'format': 1, 'id': ID, 'configuration': {'robots': 1}, 'replication': 0, 'seed': 3, 'status': 'complete',
         'error': None, 'metrics': {'goals': 2, 'extra': 0.5}, 'simulated_seconds': 1.5, 'wall_seconds': 0.25,
         'times_real_time': 6.0, 'repeatable': True, 'labels': ['x', 'y'], 'events': 4, 'log_sha256': 'ab',
         'verified': None, 'difference': None, 'robots': {'r': {}}, 'ended_by': 'idle', 'made_of': 'm', 'program': 'p'}
PLAN = {'format': 1, 'experiment': 'e', 'factors': {'robots': [1]}, 'metrics': {'goals': {}}, 'trials': [
    {'id': ID, 'configuration': {'robots': 1}, 'seed': 3}]}


def plan(names=(ID,)):
    return records.Plan('e', {'robots': [1]}, {'goals': {}}, trials=[
        records.Planned(name, {'robots': 1}, seed=3) for name in names])


def packed(members):
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode='w:gz') as archive:
        for name, content in members:
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return stream.getvalue()


def trial(**others):
    return [('trial.json', json.dumps({**ABOUT, **others}).encode()), ('events.jsonl', b'log'),
            ('logs/a.txt', b'text')]


def test_a_trial_comes_into_its_place_and_may_be_replaced(tmp_path):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.put(packed(trial()), 'w', 1)
        folder.put(packed(trial(seed=4)), 'w', 2)
    about = records.read_trial(str(tmp_path / 'out'), ID)
    assert (about.seed, about.worker, about.attempts) == (4, 'w', 2)
    assert (tmp_path / 'out' / 'trials' / ID / 'logs' / 'a.txt').read_bytes() == b'text'
    assert sorted(path.name for path in (tmp_path / 'out' / 'trials').iterdir()) == [ID]


def test_trials_that_are_put_together_take_their_places_once_all_are_on_the_disk(tmp_path, monkeypatch):
    seen, wait = [], outputs.on_disk
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        def names():
            return sorted(path.name for path in (tmp_path / 'out' / 'trials').iterdir())
        monkeypatch.setattr(outputs, 'on_disk', lambda part: (wait(part), seen.append(names())))
        with folder.together():
            folder.put(packed(trial()), 'w', 1)
            folder.put(packed(trial(id=OTHER)), 'w', 1)
            assert names() == [ID + '.unfinished', OTHER + '.unfinished']
    assert seen == [[ID + '.unfinished', OTHER + '.unfinished']] * 2
    assert names() == [ID, OTHER]


def test_an_interrupt_costs_no_trial_that_was_put(tmp_path, monkeypatch):
    wait, interrupts = outputs.on_disk, [KeyboardInterrupt]

    def interrupted(part):
        if interrupts:
            raise interrupts.pop()
        wait(part)
    monkeypatch.setattr(outputs, 'on_disk', interrupted)
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        with pytest.raises(KeyboardInterrupt), folder.together():
            folder.put(packed(trial()), 'w', 1)
            folder.put(packed(trial(id=OTHER)), 'w', 1)
    assert sorted(path.name for path in (tmp_path / 'out' / 'trials').iterdir()) == [ID, OTHER]


def test_the_plan_is_written_in_pieces_and_is_the_same_plan(tmp_path):
    for told in (plan(), plan([]), plan([ID, OTHER])):
        if len(told.trials) == 2:
            told.trials[0].made_of = 'a\nb'
        text = b''.join(tables.plan_text(told)).decode()
        (tmp_path / 'plan.json').write_text(text)
        assert records.read_plan(str(tmp_path)) == told
        assert json.loads(text)['format'] == 1
        assert text.endswith('}\n')
        assert len([line for line in text.splitlines() if '"id"' in line]) == len(told.trials)


@pytest.mark.parametrize('name', ['../x', '/etc/x', 'logs/../../x', 'a/b', 'logs/.hidden'])
def test_an_archive_with_other_names_is_refused(tmp_path, name):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        with pytest.raises(ConfigurationError, match='plain files'):
            folder.put(packed([*trial(), (name, b'')]), 'w', 1)
    assert not (tmp_path / 'x').exists()


def test_a_folder_of_somebody_else_stays(tmp_path):
    (tmp_path / 'mine').write_text('mine')
    with pytest.raises(ConfigurationError, match='did not make it'):
        outputs.OutputFolder(tmp_path).__enter__()
    assert [path.name for path in tmp_path.iterdir()] == ['mine']


def test_what_somebody_has_put_into_a_trial_stays(tmp_path):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.put(packed(trial()), 'w', 1)
        note = tmp_path / 'out' / 'trials' / ID / 'note'
        note.write_text('mine')
        with pytest.raises(ConfigurationError, match='note'):
            folder.put(packed(trial()), 'w', 1)
    assert note.read_text() == 'mine'


def test_a_second_run_into_the_same_folder_is_refused(tmp_path):
    with outputs.OutputFolder(tmp_path / 'out'):
        with pytest.raises(ConfigurationError, match='another process'):
            outputs.OutputFolder(tmp_path / 'out').__enter__()


def test_the_table_has_a_row_per_trial(tmp_path):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.put(packed(trial()), 'w', 1)
        tables.write(folder, plan())
    assert (tmp_path / 'out' / 'trials.csv').read_text() == (
        'id,robots,replication,seed,status,goals,extra,simulated_seconds,wall_seconds,times_real_time,repeatable,labels,'
        'events,log_sha256,verified,ended_by,error\n'
        '0001-abcdef,1,0,3,complete,2,0.5,1.5,0.25,6.0,true,x; y,4,ab,,idle,\n')
    assert records.read_plan(str(tmp_path / 'out')).metrics['extra'] == {'unit': '', 'title': 'extra', 'better': None}


def test_metrics_that_only_some_trials_have_are_columns_and_all_ends_are_counted(tmp_path, capsys):
    others = [{'metrics': {'goals': 1}}, {'metrics': {'zeal': 1, 'goals': 2, 'also': 3}},
              {'status': 'failed', 'error': 'why', 'metrics': {}, 'verified': 'identical'},
              {'verified': 'different', 'difference': 'here'},
              {'verified': 'identical', 'metrics': {'goals': 5}}]
    names = [f'{number:04d}-abcdef' for number in range(6)]
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        for name, each in zip(names, others):
            folder.put(packed(trial(id=name, **each)), 'w', 1)
        told = tables.write(folder, plan(names))
        assert sweep._tell(folder, told, sys.stdout) == 3
    rows = [line.split(',') for line in (tmp_path / 'out' / 'trials.csv').read_text().splitlines()]
    assert rows[0][5:9] == ['goals', 'also', 'extra', 'zeal']
    assert [row[5:9] for row in rows[1:]] == [['1', '', '', ''], ['2', '3', '', '1'], ['', '', '', ''],
                                              ['2', '', '0.5', ''], ['5', '', '', '']]
    said = capsys.readouterr().out.splitlines()
    assert said[:3] == ['experiment: 4 of 6 trials are complete; run twice: 2 identical, 1 different',
                        '  failed: 0002-abcdef: why', '  different: 0003-abcdef: here']
    assert list(state.lines(tmp_path / 'out'))[1] == 'run twice: 2 identical, 1 different'  # says the same


@pytest.mark.parametrize('about, primary, bad, says', [
    ({}, 'goals', 0, None), ({}, None, 0, None),
    ({'error': "metrics: KeyError: 'x'"}, None, 2, "metrics: KeyError: 'x' in 2 of 2 trials"),
    ({'error': "metrics: KeyError: 'x'"}, 'goals', 2, "metrics: KeyError: 'x' in 2 of 2 trials"),
    ({'error': "metrics: KeyError: 'x'"}, 'late', 2, "no value of late, the primary metric: metrics: KeyError: 'x'"),
    ({'metrics': {'late': None, 'b': 1, 'a': 2}}, 'late', 2, 'no value of late, the primary metric: it has a, b'),
    ({'metrics': {}}, 'late', 2, 'no value of late, the primary metric: it has no metric')])
def test_a_trial_without_the_primary_metric_is_not_complete_and_an_error_is_not_good(
        tmp_path, capsys, about, primary, bad, says):
    names, planned = (ID, OTHER), plan((ID, OTHER))
    planned.primary, planned.trials[1].replication = primary, 1
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        for number, name in enumerate(names):
            folder.put(packed(trial(id=name, replication=number, **about)), 'w', 1)
        assert sweep._tell(folder, tables.write(folder, planned), sys.stdout) == bad
    is_failed = bool(says) and says.startswith('no value')
    assert [one.status for one in report_outcome.read(tmp_path / 'out').trials] == [
        'failed' if is_failed else 'complete'] * 2
    assert f'{0 if is_failed else 2} of 2 trials complete' in next(state.lines(tmp_path / 'out'))
    for text in (capsys.readouterr().out, '\n'.join(state.lines(tmp_path / 'out'))):
        assert says is None or says in text
    table = (tmp_path / 'out' / 'trials.csv').read_text().splitlines()
    assert all(is_failed == (',failed,' in row) for row in table[1:])
    shutil.rmtree(tmp_path / 'out' / 'trials')  # the table says the same where it is alone
    assert [one.status == 'failed' for one in report_outcome.read(tmp_path / 'out').trials] == [is_failed] * 2


def test_a_trial_without_the_primary_metric_runs_again_and_another_primary_takes_none(tmp_path, monkeypatch):
    document = {'experiment': 'x', 'function': 'model:run', 'metrics': 'model:count'}
    (tmp_path / 'model.py').write_text('')
    for primary, wanted in (({}, []), ({'primary': 'goals'}, []), ({'primary': 'late'}, [ID])):
        job = job_of({**document, **primary}, str(tmp_path), id=ID, configuration={'robots': 1}, seed=3)
        planned = plan()
        with outputs.OutputFolder(tmp_path / 'out') as folder:
            made = {ID: experiment_plan.made_of(job.trial)}
            planned.trials[0].made_of = made[ID]
            folder.put(packed(trial(made_of=made[ID])), 'w', 1)
            assert [one.id for one in resumption.missing([job.trial], folder, planned, False, io.StringIO())] == wanted


def test_an_error_is_told_with_the_first_trial_that_has_it():
    stream = io.StringIO()
    told = progress.Progress(stream, 9, 0)
    for error in (None, 'a', 'a', 'b'):
        told.count(records.Result(ID, status='complete', error=error))
    assert stream.getvalue().splitlines() == ['experiment: a in 1 of 2 trials', 'experiment: b in 1 of 4 trials']


def test_a_failure_is_told(tmp_path):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        sweep._taken(folder, job_of(id=ID, configuration={'robots': 1}, seed=3), '', None, 'it was lost', 2)
        folder.write_pieces('plan.json', tables.plan_text(plan()))
    lines = list(state.lines(tmp_path / 'out'))
    assert lines[0] == 'e: 0 of 1 trials complete, 1 failed, 0 missing'
    assert 'it was lost' in lines[1]


def test_a_pyarrow_that_cannot_be_used_costs_only_its_own_file(tmp_path, monkeypatch, capsys):
    (tmp_path / 'pyarrow').mkdir()
    (tmp_path / 'pyarrow' / '__init__.py').write_text("raise ImportError('it needs NumPy 2')")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, 'pyarrow', raising=False)
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.put(packed(trial()), 'w', 1)
        tables.write(folder, plan())
    assert (tmp_path / 'out' / 'trials.csv').exists()
    assert 'no trials.parquet: ' in capsys.readouterr().err
