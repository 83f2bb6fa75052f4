import errno
import os

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.own_files import MARKER, FolderKind, OutputError, check_file, create_file, whole_file

KIND = FolderKind('result', ('data.csv', 'log_*.txt'))


def made(path, *names):
    os.close(KIND.make(path))
    for name in names:
        (path / name).write_text('x')
    return path


def test_a_folder_is_made_with_its_parents_taken_again_and_removed(tmp_path):
    path = made(tmp_path / 'a' / 'b', 'data.csv', 'log_1.txt', 'data.csv.part')
    made(path)
    assert sorted(file.name for file in path.iterdir()) == [MARKER, 'data.csv', 'data.csv.part', 'log_1.txt']
    KIND.remove(path)
    KIND.remove(path)
    assert not path.exists()
    assert path.parent.exists()


@pytest.mark.parametrize('name', ['notes.txt', 'data.csv.bak', 'sub', 'link'])
def test_a_folder_with_anything_else_in_it_is_not_removed(tmp_path, name):
    path = made(tmp_path / 'a', 'data.csv')
    if name == 'sub':
        (path / name).mkdir()
    elif name == 'link':
        (path / name).symlink_to(path / 'data.csv')
    else:
        (path / name).write_text('precious')
    with pytest.raises(ConfigurationError, match=f"a: was made by this program, but '{name}' in it was not"):
        KIND.remove(path)
    assert (path / 'data.csv').exists()


def test_a_folder_or_a_link_by_the_name_of_a_file_of_ours_is_not_ours(tmp_path):
    (tmp_path / 'precious').write_text('precious')
    for number, put in enumerate((os.mkdir, lambda path: os.symlink(tmp_path / 'precious', path))):
        path = made(tmp_path / str(number))
        put(path / 'data.csv')
        with pytest.raises(ConfigurationError, match="'data.csv' in it was not"):
            KIND.remove(path)


def test_only_a_mark_of_the_same_kind_is_one(tmp_path):
    other = FolderKind('heap')
    path = tmp_path / 'a'
    os.close(other.make(path))
    with pytest.raises(ConfigurationError, match='did not make it as a result'):
        KIND.make(path)
    (path / MARKER).unlink()
    (path / MARKER).symlink_to(made(tmp_path / 'b') / MARKER)
    with pytest.raises(ConfigurationError, match='did not make it as a result'):
        KIND.remove(path)


def test_a_folder_that_is_being_written_is_left_alone(tmp_path):
    marker = KIND.make(tmp_path / 'a')
    for call in (KIND.make, KIND.remove):
        with pytest.raises(ConfigurationError, match='another process of this program is writing there'):
            call(tmp_path / 'a')
    os.close(marker)
    KIND.remove(tmp_path / 'a')


def test_a_file_appears_when_it_is_complete_and_no_link_is_followed(tmp_path):
    path, precious = tmp_path / 'data.csv', tmp_path / 'precious'
    precious.write_text('precious')
    with pytest.raises(ZeroDivisionError), whole_file(path) as stream:
        stream.write(str(1 // 0))
    assert not path.exists()
    with whole_file(path) as stream:  # in the place of what the first try left
        stream.write('all')
        assert not path.exists()
    assert path.read_text() == 'all'
    (tmp_path / 'data.csv.part').symlink_to(precious)
    with pytest.raises(OutputError, match='data.csv: cannot be written: File exists'), whole_file(path) as stream:
        stream.write('more')
    assert (precious.read_text(), path.read_text()) == ('precious', 'all')


def test_a_full_disk_is_named(tmp_path):
    with pytest.raises(OutputError, match='x: cannot be written: the disk is full'), whole_file(tmp_path / 'x'):
        raise OSError(errno.ENOSPC, 'No space left on device')
    assert (tmp_path / 'x.part').exists()


def test_a_file_is_replaced_only_if_it_is_empty_or_ours(tmp_path):
    def is_own(line):
        return line.startswith(b'ours')
    path, link = tmp_path / 'file', tmp_path / 'link'
    for text in (None, '', 'ours 1'):
        if text is not None:
            path.write_text(text)
        create_file(path, is_own).close()
        assert path.read_text() == ''
    path.write_text('theirs')
    link.symlink_to(tmp_path / 'nothing')
    for wrong in (path, link, tmp_path, '/dev/null'):
        with pytest.raises(ConfigurationError, match=f'{wrong}: is there already'):
            create_file(wrong, is_own)
        with pytest.raises(ConfigurationError):
            check_file(wrong, is_own)
    assert path.read_text() == 'theirs'
    assert not (tmp_path / 'nothing').exists()
