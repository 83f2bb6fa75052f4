"""Temporary folders: what killed processes leave is removed, and nothing else."""
import os
import signal
import tempfile

import pytest

from move_base_abstract.common import temporary
from move_base_abstract.common.own_files import MARKER

PREFIX = temporary.PREFIX + 'x_'


@pytest.fixture(autouse=True)
def own_tmp(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))


def left(tmp_path, name='left'):
    path = tmp_path / (PREFIX + name)
    os.close(temporary.KIND.make(str(path)))
    (path / 'worker').mkdir()
    (path / 'worker' / 'file').write_text('x')
    return path


def test_what_a_killed_process_left_is_removed_by_the_next_one(tmp_path):
    path = left(tmp_path)
    with temporary.folder('x_') as own:
        assert not path.exists()
        assert os.listdir(tmp_path) == [os.path.basename(own)]
    assert not os.listdir(tmp_path)


def test_what_is_in_use_or_not_ours_stays(tmp_path):
    in_use = left(tmp_path, 'used')
    marker = temporary.KIND.make(str(in_use))
    (tmp_path / (PREFIX + 'others')).mkdir()
    (tmp_path / (PREFIX + 'others') / 'file').write_text('precious')
    (tmp_path / (PREFIX + 'marked')).mkdir()
    (tmp_path / (PREFIX + 'marked') / MARKER).write_text('by another program')
    elsewhere = tmp_path / 'elsewhere'
    os.close(temporary.KIND.make(str(elsewhere)))
    (tmp_path / (PREFIX + 'link')).symlink_to(elsewhere)
    (tmp_path / (PREFIX + 'empty')).mkdir()
    before = sorted(os.listdir(tmp_path))
    try:
        assert temporary.remove_left() == []
    finally:
        os.close(marker)
    assert sorted(os.listdir(tmp_path)) == before
    assert temporary.remove_left() == [str(in_use)]


def test_a_folder_that_is_kept_stays_and_one_whose_forks_have_ended_does_not(tmp_path):
    kept, removed, left_over = (temporary.make(name) for name in ('kept_', 'removed_', 'left_'))
    (tmp_path / os.path.basename(kept) / 'file').write_text('for the user')
    temporary.keep(kept)
    temporary.remove(removed)
    temporary.remove(removed)  # it is gone already
    assert temporary.remove_left() == []
    pid = os.fork()
    if pid == 0:
        temporary.let_go()  # as a guard does
        os._exit(len(temporary.remove_left()))  # the parent still holds the folder
    assert os.waitpid(pid, 0)[1] == 0
    temporary.let_go()
    assert temporary.remove_left() == [left_over]
    assert os.listdir(tmp_path) == [os.path.basename(kept)]


def test_what_cannot_be_deleted_now_is_deleted_later(tmp_path, monkeypatch):
    path = temporary.make('busy_')
    (tmp_path / os.path.basename(path) / 'worker').mkdir()
    with monkeypatch.context() as patched:
        patched.setattr(temporary.shutil, 'rmtree', lambda *_args, **_kwds: None)  # as if somebody still wrote there
        temporary.remove(path)
    assert temporary.remove_left() == [path]
    assert not os.listdir(tmp_path)


@pytest.mark.parametrize('has_marker', [False, True])
def test_what_is_left_by_who_is_killed_before_the_mark_is_removed_and_not_while_it_is_made(tmp_path, monkeypatch,
                                                                                          has_marker):
    def killed(path):
        if has_marker:
            open(os.path.join(path, MARKER), 'x').close()
        assert temporary.remove_left() == []  # as by another program at this moment
        assert os.path.isdir(path)
        os.kill(os.getpid(), signal.SIGKILL)
    pid = os.fork()
    if pid == 0:
        try:
            monkeypatch.setattr(temporary.KIND, 'make', killed)
            temporary.make('x_')
        finally:
            os._exit(1)
    assert os.waitpid(pid, 0)[1] == signal.SIGKILL
    left_over, = tmp_path.iterdir()
    assert temporary.remove_left() == [str(left_over)]
    assert not os.listdir(tmp_path)
