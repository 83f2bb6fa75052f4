"""What is said of the second run of a trial: identical only if something was compared."""
import pytest

from experiment_jobs import FUNCTION, job_of
from move_base_abstract_experiments.trials import execution, functions, run, run_folders

HEAD = '{"event_log":1}\n'
EVENT = '{"time_ns":1,"robot":"a","kind":"arrived","values":[]}\n'
LAUNCH = {'experiment': 'x', 'launch': 'x.launch', 'until': {'seconds': 1}}
NOTHING = ['it ran twice, but there was nothing to compare: no metric, event, message or bag']


def log_of(events):
    """Return an event log as text, None without one."""
    return None if events is None else HEAD + EVENT * events + (
        '{"end":{"events":%d,"not_repeatable_because":[],"degraded_because":[]}}\n' % events)


def write(folders, events, recorded=''):
    if events is not None:
        with open(folders.log, 'w', encoding='utf-8') as stream:
            stream.write(log_of(events))
    if recorded:
        with open(folders.messages, 'w', encoding='utf-8') as stream:
            stream.write(recorded)


def verified(folder, document, monkeypatch, metrics=(), events=(None, None), recorded=''):
    """Return (verified, difference, labels) of a trial whose two runs have left so many events."""
    folders = run_folders.make_folders(str(folder / 'run'))
    write(folders, events[0], recorded)

    def again(job, place, *rest):
        write(next(one for one in (place, *rest) if isinstance(one, run_folders.Folders)), events[1], recorded)
        return functions.Returned(dict(metrics), [], 0.0, []) if document is FUNCTION else run.Ended({}, [], None)
    monkeypatch.setattr(functions, 'again', again)
    monkeypatch.setattr(run, 'run', again)
    job = job_of(document, verified_by='hash')
    result = execution.result_of(job)
    execution._verify(job, str(folder), folders, result, dict(metrics))
    return result.verified, result.difference, result.labels


@pytest.mark.parametrize('metrics, events, expected', [
    ({'a': 1}, (None, None), ('identical', None, [])), ({}, (1, 1), ('identical', None, [])),
    ({}, (None, None), (None, None, NOTHING)), ({}, (0, 0), (None, None, NOTHING)),
    ({'a': 1}, (None, 1), ('different', 'hash: an event log the second time only', [])),
    ({'a': 1}, (1, None), ('different', 'hash: an event log the first time only', []))])
def test_a_function_is_compared_by_its_numbers_and_its_log(tmp_path, monkeypatch, metrics, events, expected):
    assert verified(tmp_path, FUNCTION, monkeypatch, metrics, events) == expected


@pytest.mark.parametrize('events, recorded, expected', [
    (1, '', ('identical', None, [])), (0, 'x', ('identical', None, [])), (0, '', (None, None, NOTHING))])
def test_a_system_is_compared_by_its_log_and_its_messages(tmp_path, monkeypatch, events, recorded, expected):
    found = verified(tmp_path, LAUNCH, monkeypatch, {'goals': 0}, (events, events), recorded)
    assert found == expected
