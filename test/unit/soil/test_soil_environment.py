"""The Python environment of the study: made where there is none, kept where it fits, and nothing else is replaced."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

from soil_mapping import environment
from soil_mapping.environment import MARKER, EnvironmentFailure, make, of_the_user, python_in
from soil_mapping.ros import find_python as finder


@pytest.fixture
def steps(monkeypatch):
    """Leave out venv and pip: return the commands that would have been run, each with pip's own constraints in it."""
    done = []

    def run(words, failure):
        words = [str(word) for word in words]
        done.append([Path(word).read_text() if word.endswith('kept.txt') else word for word in words])
        if words[1:3] == ['-m', 'venv']:
            python = python_in(words[-1])
            python.parent.mkdir(parents=True, exist_ok=True)
            python.symlink_to(sys.executable)

    monkeypatch.setattr(environment, '_run', run)
    return done


def test_what_debian_has_of_the_compiled_libraries_is_kept(steps, tmp_path):
    import numpy
    import scipy
    make(tmp_path / 'env')
    kept = steps[1][-1].split()
    assert f'numpy=={numpy.__version__}' in kept
    assert f'scipy=={scipy.__version__}' in kept


def test_it_is_made_once_and_anew_when_a_list_changes(steps, tmp_path):
    lists = (tmp_path / 'requirements', tmp_path / 'constraints')
    for path in lists:
        path.write_text('gstools\n')
    python = make(tmp_path / 'env', lists)
    assert (python, len(steps)) == (tmp_path / 'env' / 'bin' / 'python', 2)
    make(tmp_path / 'env', lists)
    assert len(steps) == 2
    (tmp_path / 'env' / 'old').touch()
    lists[1].write_text('gstools==1\n')
    make(tmp_path / 'env', lists)
    assert len(steps) == 4
    assert not (tmp_path / 'env' / 'old').exists()


def test_one_that_was_not_finished_is_made_anew(monkeypatch, steps, tmp_path):
    def fail(words, failure):
        raise EnvironmentFailure('no network')

    with monkeypatch.context() as patched:
        patched.setattr(environment, '_run', fail)
        with pytest.raises(EnvironmentFailure, match='no network'):
            make(tmp_path / 'env')
    make(tmp_path / 'env')
    assert len(steps) == 2


def test_a_folder_of_another_kind_is_never_touched(steps, tmp_path):
    (tmp_path / 'env').mkdir()
    (tmp_path / 'env' / 'thesis.tex').write_text('mine')
    (tmp_path / 'file').write_text('mine')
    for name in ('env', 'file'):
        with pytest.raises(EnvironmentFailure, match=f'{name}: exists, and was not made by this program'):
            make(tmp_path / name)
    assert (tmp_path / 'env' / 'thesis.tex').read_text() == (tmp_path / 'file').read_text() == 'mine'
    assert steps == []


def test_a_link_to_an_environment_is_used_and_not_followed(steps, tmp_path):
    make(tmp_path / 'env')
    (tmp_path / 'env' / MARKER).write_text('other lists')
    (tmp_path / 'link').symlink_to(tmp_path / 'env')
    assert make(tmp_path / 'link') == tmp_path / 'link' / 'bin' / 'python'
    assert ((tmp_path / 'env' / MARKER).read_text(), len(steps)) == ('other lists', 2)


def test_a_folder_below_a_file_is_named(tmp_path):
    (tmp_path / 'file').touch()
    with pytest.raises(EnvironmentFailure, match='file'):
        make(tmp_path / 'file' / 'env')


def test_the_users_environment_lies_in_the_users_data_folder(monkeypatch):
    monkeypatch.setenv('HOME', '/home/me')
    monkeypatch.setenv('XDG_DATA_HOME', '/data')
    assert str(of_the_user()) == '/data/move_base_abstract/study_python'
    monkeypatch.setenv('XDG_DATA_HOME', 'relative')  # which the specification says to ignore
    assert str(of_the_user()) == '/home/me/.local/share/move_base_abstract/study_python'


@pytest.fixture
def started(monkeypatch, tmp_path):
    """An installed program whose Python lacks an import: return a function, which Python it is started with again."""
    monkeypatch.setattr(finder, '__file__', str(tmp_path / 'lib' / 'soil_mapping' / 'ros' / 'find_python.py'))
    monkeypatch.setattr(finder, 'NEEDED', {'no_such_module': 'no-such-package'})
    monkeypatch.setenv('XDG_DATA_HOME', str(tmp_path / 'data'))
    monkeypatch.delenv(finder.VARIABLE, raising=False)
    monkeypatch.delenv(finder.STARTED_AGAIN, raising=False)
    found = []
    monkeypatch.setattr(os, 'execv', lambda python, words: found.append(python))

    def start():
        found.clear()
        finder.find_python(['/opt/lib/study', 'trial'], 'study')
        monkeypatch.delenv(finder.STARTED_AGAIN)
        return found[0]

    return start


def executable(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch(mode=0o755)
    return str(path)


def test_an_installed_program_finds_the_users_environment_and_the_one_that_a_variable_names(started, monkeypatch,
                                                                                           tmp_path):
    users = executable(tmp_path / 'data' / 'move_base_abstract' / 'study_python' / 'bin' / 'python')
    assert started() == users
    executable(tmp_path / '.ws' / 'venv' / 'bin' / 'python')  # of somebody else: this is no source tree
    assert started() == users
    monkeypatch.setenv(finder.VARIABLE, executable(tmp_path / 'mine'))
    assert started() == str(tmp_path / 'mine')


def test_without_one_the_error_says_how_to_make_it(started):
    with pytest.raises(SystemExit, match='(?s)no-such-package not installed.*python3 .*examples/study.py setup'):
        started()


def test_setup_runs_with_debians_python_alone(tmp_path):
    """What makes the environment must not need what the environment brings."""
    code = ('import sys\nfor name in ("numpy", "scipy", "yaml", "matplotlib"): sys.modules[name] = None\n'
            'sys.path.append(sys.argv[1])\nimport study\n'
            'from soil_mapping import environment\n'
            'environment._run = lambda words, failure: None\nsys.argv = ["study", "setup"]\nstudy.main()')
    examples = str(Path(__file__).resolve().parents[3] / 'examples')
    done = subprocess.run([sys.executable, '-c', code, examples], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          text=True, env={**os.environ, 'XDG_DATA_HOME': str(tmp_path),
                                               'PYTHONPATH': os.pathsep.join(sys.path)},
                          check=False)
    assert (done.returncode, done.stdout) == (0, f'{tmp_path}/move_base_abstract/study_python/bin/python\n')
