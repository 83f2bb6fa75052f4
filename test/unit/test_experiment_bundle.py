"""What a trial leaves, whatever its files are called and are: it costs no other trial anything."""
import os

import pytest

from experiment_jobs import job_of
from move_base_abstract_experiments import records, sweep
from move_base_abstract_experiments.results import outputs, tables
from move_base_abstract_experiments.trials import bundle, run_folders
from test_experiment_outputs import ABOUT, ID, packed, plan, trial

NAMES = ['result 0.csv', 'a\nb.csv', '\u00fc.csv', '[1](2){3}.csv', b'\xff\xfe.csv', '-rf.csv', '.hidden.csv',
         '%20.csv', 'x' * 250 + '.csv', '\u00fc' * 120 + '.csv', '~.csv', '.made_by_move_base_abstract', 'x.part',
         "';$(x)&|.csv", 'a\\b.csv', '*?.csv', 'a.made_by_move_base_abstract', ' ', 'CON']


@pytest.fixture
def folders(tmp_path):
    (tmp_path / 'run').mkdir()
    return run_folders.make_folders(str(tmp_path / 'run'))


def taken(tmp_path, folders, patterns=('*',), **about):
    """Pack what is there, take it as the client does; return (trial.json's content, names in its folder)."""
    bundle.pack(str(tmp_path), folders, patterns, records.result_of({**ABOUT, **about}, ID, ''), has_all_logs=False)
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        told = sweep._taken(folder, job_of(id=ID), 'w', (tmp_path / bundle.OUTPUTS).read_bytes(), None, 1)
        return told, sorted(os.listdir(folder.place(ID)))


def test_any_name_of_a_file_is_kept_and_different_ones_stay_different(tmp_path, folders):
    for name in NAMES:
        with open(os.path.join(os.fsencode(folders.files), os.fsencode(name)), 'wb') as stream:
            stream.write(os.fsencode(name))
        with open(os.path.join(os.fsencode(folders.logs), os.fsencode(name)[:240] + b'.txt'), 'wb') as stream:
            stream.write(b'said')
    told, names = taken(tmp_path, folders)
    assert (told.status, told.error) == ('complete', None)
    kept = [name for name in names if name.startswith('files-')]
    assert len(kept) == len(NAMES)
    assert {'files-result%200.csv', 'files-%C3%BC.csv', 'files-%2Drf.csv', 'files-a%0Ab.csv'} <= set(kept)
    logs = os.listdir(tmp_path / 'out' / 'trials' / ID / 'logs')
    assert len([name for name in logs if name.endswith('.txt')]) == len(NAMES)
    with outputs.OutputFolder(tmp_path / 'out') as folder:  # and all of it is known as ours
        outputs.remove_trial(folder.place(ID))
        assert not folder.place(ID).exists()


def test_what_is_no_plain_file_is_left_out_and_told(tmp_path, folders):
    for folder in (folders.files, folders.logs):
        os.mkfifo(os.path.join(folder, 'pipe.txt'))
        os.mkdir(os.path.join(folder, 'folder.txt'))
        os.symlink('/dev/zero', os.path.join(folder, 'link.txt'))
    told, names = taken(tmp_path, folders)
    assert (told.status, told.error) == (
        'complete', '2 of its files are not kept; files-link.txt: it is no plain file')
    assert not [name for name in names if name.startswith('files-')]


def test_what_is_larger_than_allowed_fails_that_trial_alone(tmp_path, folders):
    with open(os.path.join(folders.files, 'large'), 'wb') as stream:
        stream.truncate(bundle.MOST_BYTES + 1)
    told, names = taken(tmp_path, folders)
    assert (told.status, 'more than 536870912 bytes' in told.error) == ('failed', True)
    assert 'files-large' not in names


@pytest.mark.parametrize('content', [
    b'', b'no archive', packed([]), packed([('trial.json', b'[]')]), packed([('trial.json', b'{}')]),
    packed([*trial(), ('../x', b'')]), packed(trial())[:99], packed(trial(id='other')), packed(trial(status=None))],
                         ids=range(9))
def test_outputs_that_cannot_be_taken_are_a_trial_that_failed(tmp_path, content):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        about = sweep._taken(folder, job_of(id=ID), 'w', content, None, 2)
        assert (about.status, about.attempts) == ('failed', 2)
        assert about.error.startswith('its outputs cannot be taken: ')
        assert outputs.read_planned(folder.path, records.Plan(), records.Planned(ID)).error == about.error
        tables.write(folder, plan())
    job = sweep.again(content, job_of(id=ID))
    assert job is None or job.trial.id == ID


def test_a_note_in_a_trials_folder_stays_and_ends_no_other_trial(tmp_path):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.put(packed(trial()), 'w', 1)
        (folder.place(ID) / 'note').write_text('mine')
        about = sweep._taken(folder, job_of(id=ID), 'w', packed(trial()), None, 1)
        assert (about.status, 'note' in about.error) == ('failed', True)
        assert (folder.place(ID) / 'note').read_text() == 'mine'
