import dataclasses
import json
import math
import os
import re
import signal

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.own_files import MARKER, OutputError, whole_file
from soil_mapping.results import pictures, trial_folder
from soil_mapping.results.trial_folder import KIND, TrialFolder, is_complete, read_about, read_trial


def finish(path, result, **options):
    with TrialFolder(path) as folder:
        return folder.finish(result, **options)


def same(a, b):
    """Whether two results hold the same, NaN being like NaN."""
    return all(np.array_equal(x, y, equal_nan=True) if isinstance(x, np.ndarray) else repr(x) == repr(y)
               for x, y in ((getattr(a, field.name), getattr(b, field.name)) for field in dataclasses.fields(a)))


def test_a_written_trial_is_read_back_to_the_bit(tmp_path, result):
    path = finish(tmp_path / 'a' / 'trial', result)
    assert path == tmp_path / 'a' / 'trial'
    assert is_complete(path)
    assert same(read_trial(path), result)
    assert sorted(file.name for file in path.iterdir()) == [
        MARKER, 'events.csv', 'metrics.csv', 'prediction.npy', 'samples.csv', 'trajectories.csv', 'trial.json',
        'truth.npy', 'variance.npy']
    assert list(tmp_path.glob('a/*')) == [path]


def test_the_provenance_names_seed_configuration_versions_machine_and_phases(tmp_path, result):
    about = read_about(finish(tmp_path / 'trial', result))
    assert about['seed'] == 7
    assert about['config']['allocation'] == 'ssi'
    assert about['engine'] == {'name': 'mesa', 'motion': 'euclidean'}
    assert {'python', 'numpy', 'PyKrige', 'Mesa'} <= set(about['versions'])
    assert about['machine']['cores'] >= 1
    assert {'start_up', 'mission', 'kriging', 'allocation'} <= set(about['wall_s'])
    assert about['speed_up']['moving'] > about['speed_up']['overall'] > 0.0


def test_what_is_unknown_is_null_in_json_and_empty_in_csv(tmp_path, result):
    nothing = np.full_like(result.truth, np.nan)
    unknown = dataclasses.replace(result, metrics=result.metrics._replace(rmse_kpa=math.nan), prediction=nothing,
                                  moving_wall_s=math.nan)
    path = finish(tmp_path / 'trial', unknown)
    about = json.loads((path / 'trial.json').read_text())
    assert about['metrics']['rmse_kpa'] is None
    assert same(read_trial(path), unknown)


def test_equal_event_logs_have_equal_sums(tmp_path, result):
    first, second = (read_about(finish(tmp_path / name, result))['events_sha256'] for name in 'ab')
    changed = dataclasses.replace(result, events=result.events[:-1])
    third = read_about(finish(tmp_path / 'c', changed))['events_sha256']
    assert first == second != third


def test_pictures_are_there_if_wanted(tmp_path, result):
    path = finish(tmp_path / 'trial', result, pictures=True)
    for name in ('truth', 'prediction', 'variance', 'trajectories'):
        assert (path / f'{name}.png').read_bytes().startswith(b'\x89PNG')


def test_what_an_engine_left_in_the_folder_stays_and_an_earlier_try_does_not(tmp_path, result):
    with TrialFolder(tmp_path / 'trial') as folder:
        (folder.path / 'charge.jsonl.part').write_text('x')
    assert not is_complete(tmp_path / 'trial')
    assert (tmp_path / 'trial.unfinished' / 'charge.jsonl.part').exists()
    with TrialFolder(tmp_path / 'trial') as folder:
        assert not (folder.path / 'charge.jsonl.part').exists()
        (folder.path / 'trial.bag').write_text('x')
        folder.finish(result)
    assert (tmp_path / 'trial' / 'trial.bag').exists()


def test_only_a_complete_folder_of_this_format_is_read(tmp_path, result):
    with pytest.raises(ValueError, match='not a complete trial'):
        read_trial(tmp_path)
    path = finish(tmp_path / 'trial', result)
    (path / 'trial.json').write_text('{"format": 99}')
    with pytest.raises(ValueError, match='format 99 is unknown'):
        read_trial(path)


def put_folder(path):
    path.mkdir()
    (path / 'thesis.tex').write_text('precious')


def put_file(path):
    path.write_text('precious')


def put_link(path):
    elsewhere = path.with_name('elsewhere')
    put_folder(elsewhere)
    path.symlink_to(elsewhere)


def put_mark_and_more(path):
    KIND.make(path)
    (path / 'notes.txt').write_text('precious')


def all_that_is_there(folder):
    return {path: path.read_text() if path.is_file() else None for path in sorted(folder.rglob('*'))}


@pytest.mark.parametrize('name', ['trial', 'trial.unfinished', 'trial.old'])
@pytest.mark.parametrize('put', [put_folder, put_file, put_link, put_mark_and_more])
def test_what_this_program_did_not_make_is_named_and_stays(tmp_path, result, name, put):
    put(tmp_path / name)
    before = all_that_is_there(tmp_path)
    with pytest.raises(ConfigurationError) as caught:
        finish(tmp_path / 'trial', result)
    assert str(caught.value).startswith(f'{tmp_path / name}: ')
    assert all_that_is_there(tmp_path) == before


def test_what_is_put_in_the_way_meanwhile_stays_too(tmp_path, result):
    with pytest.raises(ConfigurationError, match=f'{tmp_path}/trial: '), TrialFolder(tmp_path / 'trial') as folder:
        put_folder(tmp_path / 'trial')
        folder.finish(result)
    assert (tmp_path / 'trial' / 'thesis.tex').read_text() == 'precious'
    assert (tmp_path / 'trial.unfinished' / 'events.csv').exists()


def test_an_empty_folder_is_taken(tmp_path, result):
    (tmp_path / 'trial').mkdir()
    assert is_complete(finish(tmp_path / 'trial', result))


def test_two_trials_do_not_write_the_same_folder(tmp_path, result):
    with TrialFolder(tmp_path / 'trial') as folder:
        with pytest.raises(ConfigurationError, match='another process of this program is writing there'):
            finish(tmp_path / 'trial', result)
        assert is_complete(folder.finish(result))


def test_the_root_of_all_is_no_folder_for_a_trial():
    with pytest.raises(ConfigurationError, match='^/: '):
        TrialFolder('/')


def test_a_trial_is_complete_before_its_pictures_are_drawn(tmp_path, result, monkeypatch):
    recorded = []
    monkeypatch.setattr(pictures, 'write_pictures', lambda folder, result: recorded.append(is_complete(folder)))
    with TrialFolder(tmp_path / 'trial') as folder:
        folder.finish(result, True, lambda: recorded.append('told'))
    assert recorded == ['told', True]


def test_on_a_full_disk_what_was_written_stays_and_so_does_the_older_trial(tmp_path, result, monkeypatch):
    older = finish(tmp_path / 'trial', dataclasses.replace(result, seed=8))

    def full_for_maps(path, *args, **options):
        if path.name.endswith('.npy'):
            raise OutputError(f'{path}: cannot be written: the disk is full')
        return whole_file(path, *args, **options)
    monkeypatch.setattr(trial_folder, 'whole_file', full_for_maps)
    with pytest.raises(OutputError, match=r'trial.unfinished/truth.npy: cannot be written: the disk is full'):
        finish(tmp_path / 'trial', result)
    assert read_about(older)['seed'] == 8
    assert (tmp_path / 'trial.unfinished' / 'events.csv').read_text() == (older / 'events.csv').read_text()


def test_the_record_says_what_was_read_and_by_which_version(tmp_path, result):
    about = read_about(finish(tmp_path / 'trial', dataclasses.replace(result, inputs={'field': 'ab12'})))
    assert about['inputs'] == {'field': 'ab12'}
    assert re.match('[0-9]+[.]', about['package'])


@pytest.mark.parametrize('replacing', [False, True])
def test_a_kill_at_any_rename_leaves_a_complete_trial_or_none(tmp_path, result, replacing):
    path, deaths = tmp_path / 'trial', 0
    while True:
        if replacing and not is_complete(path):
            finish(path, result)
        child = os.fork()
        if child == 0:
            _die_at(deaths)
            finish(path, result)
            os._exit(0)
        _, status = os.waitpid(child, 0)
        if is_complete(path):
            assert same(read_trial(path), result)
        if os.WIFEXITED(status):
            break
        assert os.WTERMSIG(status) == signal.SIGKILL
        assert (tmp_path / 'trial.unfinished').exists()
        deaths += 1
    assert os.WEXITSTATUS(status) == 0
    assert deaths == (10 if replacing else 9)  # 8 files, and the folder once or twice
    assert is_complete(path)


def _die_at(count):
    """Let this process kill itself instead of its rename number count."""
    left = [count]

    def instead_of(rename):
        def rename_or_die(*args):
            if left[0] == 0:
                os.kill(os.getpid(), signal.SIGKILL)
            left[0] -= 1
            rename(*args)
        return rename_or_die

    trial_folder.os.replace = instead_of(os.replace)
    trial_folder.os.rename = instead_of(os.rename)
