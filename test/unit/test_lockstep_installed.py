"""Which files are those of installed distributions."""

import pytest

from move_base_abstract_ros.lockstep.code.own_code import _tops, is_installed


@pytest.fixture
def folder(tmp_path):
    """A folder of packages as `pip install --target` leaves it, with a program of the user's in it."""
    _tops.cache_clear()
    for package in ('pandas', 'six_like', 'mine'):
        (tmp_path / package / 'core').mkdir(parents=True)
    record = tmp_path / 'pandas-2.0.dist-info' / 'RECORD'
    record.parent.mkdir()
    record.write_text('pandas/__init__.py,sha256=x,1\n"pandas/core/a,b.py",,\n../../bin/tool,,\nbin/tool,,\nalone.py,,\n')
    return tmp_path


@pytest.mark.parametrize(('path', 'expected'), [
    ('pandas/__init__.py', True), ('pandas/core/frame.py', True), ('pandas/', True), ('pandas/core/', True),
    ('alone.py', True), ('mine/core/plan.py', False), ('script.py', False), ('bin/tool', False), ('', False)])
def test_what_a_distribution_lists_is_installed_and_what_lies_beside_it_is_not(folder, path, expected):
    assert is_installed(str(folder) + '/' + path) is expected


def test_a_distribution_below_one_of_the_users_own_folders_is_found(folder):
    inner = folder / 'mine' / 'vendor'
    (inner / 'x-1.dist-info').mkdir(parents=True)
    (inner / 'x-1.dist-info' / 'RECORD').write_text('x/__init__.py,,\n')
    assert is_installed(str(inner / 'x' / 'y' / 'z.py'))
    assert not is_installed(str(inner / 'other.py'))


@pytest.mark.parametrize('record', [None, b'\xff\x00\n', b'"'])
def test_a_list_that_is_not_there_or_no_list_lists_nothing(folder, record):
    info = folder / 'mine' / 'x-1.dist-info'
    info.mkdir()
    if record is not None:
        (info / 'RECORD').write_bytes(record)
    assert not is_installed(str(folder / 'mine' / 'x' / 'y.py'))


def test_roots_and_relative_names_come_to_an_end():
    assert [is_installed(path) for path in ('/', '', 'x.py', '/x.py', '<string>')] == [False] * 5
