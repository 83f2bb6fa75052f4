"""A trial in its own process: what goes back of one whose outputs are not as they should be."""
import io
import json
import shutil
import tarfile

import pytest

from move_base_abstract_experiments import functions, plan, trial


@pytest.fixture
def carried_out(tmp_path, monkeypatch):
    """Return what carries out the trial of a function, and returns (trial.json, names of the outputs)."""
    def carry_out(function):
        monkeypatch.setattr(functions, 'run_trial', lambda _job, folders: {
            'metrics': function(folders) or {}, 'labels': [], 'simulated_seconds': None})
        job = {'id': '0001-abcdef', 'configuration': {}, 'replication': 0, 'seed': 0, 'made_of': '', 'function': '',
               'version': plan.package_version(), 'trial_function': 'm:run', 'verified_by': '', 'record': ((), ('*',))}
        trial.carry_out(job, str(tmp_path))
        with tarfile.open(fileobj=io.BytesIO((tmp_path / trial.OUTPUTS).read_bytes())) as archive:
            return json.load(archive.extractfile('trial.json')), archive.getnames()
    return carry_out


def test_what_a_function_leaves_goes_back(carried_out):
    def function(folders):
        for path in (f'{folders.files}/a.csv', f'{folders.logs}/function.txt'):
            with open(path, 'w', encoding='utf-8') as stream:
                stream.write('x')
        return {'a': 1}
    about, names = carried_out(function)
    assert (about['status'], about['error'], about['metrics']) == ('complete', None, {'a': 1})
    assert names == ['trial.json', 'files-a.csv', 'logs/function.txt']


@pytest.mark.parametrize('folder', ['files', 'logs', 'own'])
def test_a_trial_whose_folder_has_gone_has_failed(carried_out, folder):
    about, names = carried_out(lambda folders: shutil.rmtree(getattr(folders, folder)))
    assert about['status'] == 'failed'
    assert about['error'].startswith('its outputs cannot be packed: [Errno 2] No such file or directory: ')
    assert names == ['trial.json']


def test_an_error_names_files_from_the_trials_folder(carried_out):
    def function(folders):
        with open(f'{folders.own}/events.jsonl', 'w', encoding='utf-8') as stream:
            stream.write('no log')
        with open(f'{folders.logs}/function.txt', 'w', encoding='utf-8') as stream:
            stream.write(f'ValueError: {folders.files}/a.csv\n')
    about, names = carried_out(function)
    assert about['error'].startswith('events.jsonl:1: is not JSON')
    assert about['error'].endswith('; function: ValueError: files/a.csv')
    assert 'events.jsonl' in names
