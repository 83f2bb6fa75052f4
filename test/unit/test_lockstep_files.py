"""What the time master is told of the files that a program opens."""
import os
import pathlib

import pytest

from move_base_abstract.lockstep import wire
from move_base_abstract_ros.lockstep.machine.files import Files


class Noting:
    """A participant that keeps what it is to report."""

    def __init__(self):
        self.items = []
        self.add_aside = self.add = self.items.append


@pytest.fixture
def told(tmp_path, monkeypatch):
    """Return a function of an event of sys.audit that returns what is told: [(kind, path in the folder), ...]."""
    monkeypatch.chdir(tmp_path)
    beginning = os.path.realpath(str(tmp_path)) + '/'

    def tell(event, *arguments):
        files, participant = Files(), Noting()
        files.follow(participant)
        for _ in range(2):  # each is told once
            (lambda: files.audit(event, arguments))()
        notes = {wire.note(kind, beginning + name): (kind.name, name)
                 for kind in (wire.NoteKind.READS, wire.NoteKind.WRITES) for name in (
                     'x', 'y', 'odd \\xff', 'grün', '4')}
        return [notes[item] for item in participant.items]
    return tell


def test_how_a_file_is_opened_says_what_is_done_with_it(told):
    assert told('open', 'x', 'r', os.O_RDONLY | os.O_CLOEXEC) == [('READS', 'x')]
    assert told('open', b'x', 'a', os.O_WRONLY | os.O_APPEND | os.O_CREAT) == [('WRITES', 'x')]
    assert told('open', pathlib.Path('x'), 'r+', os.O_RDWR) == [('READS', 'x'), ('WRITES', 'x')]
    assert told('open', 'x', None, os.O_WRONLY | os.O_EXCL) == [('WRITES', 'x')]
    assert told('open', 4, 'r', os.O_RDONLY) == []
    assert told('open', 'x\0', 'r', os.O_RDONLY) == []
    assert told('os.remove', 'x', -1) == [('WRITES', 'x')]  # whether it is there is what others may ask


def test_a_file_has_one_name(told):
    os.mkdir('below')
    os.symlink('x', 'link')
    for name in ('./x', 'below/../x', 'link', os.path.join(os.getcwd(), 'x')):
        assert told('open', name, 'r', os.O_RDONLY) == [('READS', 'x')]
    assert told('open', os.fsdecode(b'odd \xff'), 'r', os.O_RDONLY) == [('READS', 'odd \\xff')]
    assert told('open', 'gr\u00fcn', 'r', os.O_RDONLY) == [('READS', 'grün')]


def test_what_is_renamed_is_written_under_both_names(told):
    assert told('os.rename', 'x', 'y', -1, -1) == [('WRITES', 'x'), ('WRITES', 'y')]
    assert told('os.rename', 'x', 'y', 3, -1) == [('WRITES', 'y')]  # from a folder without a name
    assert told('os.rename', 'x', 'y', -1, 3) == [('WRITES', 'x')]


def test_databases_are_read_and_written(told):
    both = [('READS', 'x'), ('WRITES', 'x')]
    for name in ('x', b'x', pathlib.Path('x'), 'file:x', 'file:%78?cache=shared#part'):
        assert told('sqlite3.connect', name) == both
    assert told('sqlite3.connect', 'file:x?mode=ro') == [('READS', 'x')]
    for name in (':memory:', '', 'file::memory:?cache=shared', 'file:x?mode=memory'):
        assert told('sqlite3.connect', name) == []


def test_what_was_opened_before_the_program_takes_part_is_told_then(tmp_path):
    files, participant = Files(), Noting()
    path = os.path.realpath(str(tmp_path / 'x'))
    (lambda: files.audit('open', (path, 'r', os.O_RDONLY)))()
    assert participant.items == []
    files.follow(participant)
    assert participant.items == [wire.note(wire.NoteKind.READS, path)]
