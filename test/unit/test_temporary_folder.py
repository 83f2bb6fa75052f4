import contextlib
import os
import tempfile

import pytest

from move_base_abstract.common.temporary import temporary_folder


@pytest.fixture(autouse=True)
def base(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    return tmp_path


def test_each_run_has_the_same_path_and_finds_nothing():
    said, paths = [], []
    for _ in range(3):
        with temporary_folder(said.append) as path:
            paths.append(path)
            assert os.listdir(path) == []
            os.mkdir(os.path.join(path, 'left'))
            with open(os.path.join(path, 'left', 'file'), 'w') as stream:
                stream.write('mine')
    assert len(set(paths)) == 1
    assert len(said) == 3
    for line in said:
        with open(os.path.join(line.rpartition(' ')[2], 'left', 'file')) as stream:
            assert stream.read() == 'mine'


def test_what_a_run_left_that_was_killed_is_moved_aside():
    said = []
    with temporary_folder(said.append) as path:
        pass
    assert (said, os.path.exists(path)) == ([], False)
    os.mkdir(path, 0o700)
    with open(os.path.join(path, 'file'), 'w'):
        pass
    with temporary_folder(said.append) as again:
        assert (again, os.listdir(again)) == (path, [])
        assert os.listdir(said[0].rpartition(' ')[2]) == ['file']


def test_runs_beside_each_other_have_one_each():
    with temporary_folder(print) as one, temporary_folder(print) as two, temporary_folder(print) as three:
        assert (one[-3:], two, three) == ('_01', one[:-3] + '_02', one[:-3] + '_03')
    with temporary_folder(print) as again:
        assert again == one


def test_the_paths_of_runs_beside_each_other_are_equally_long():
    with contextlib.ExitStack() as stack:
        paths = [stack.enter_context(temporary_folder(print)) for _ in range(12)]
        assert (len(set(paths)), len({len(path) for path in paths})) == (12, 1)


def test_what_is_not_its_own_is_not_used(base):
    with temporary_folder(print) as path:
        pass
    for make in (lambda: open(path, 'w').close(), lambda: os.mkdir(path, 0o755),
                 lambda: os.symlink(str(base), path), lambda: os.symlink(str(base / 'nowhere'), path)):
        make()
        with temporary_folder(print) as other:
            assert other == path[:-3] + '_02'
        if os.path.isdir(path) and not os.path.islink(path):
            os.rmdir(path)
        else:
            os.unlink(path)


def test_where_none_can_be_had_there_is_none(base, monkeypatch):
    monkeypatch.setattr(tempfile, 'tempdir', str(base / 'missing'))
    with temporary_folder(print) as path:
        assert path is None
