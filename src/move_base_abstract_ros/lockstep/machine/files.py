"""Files that the program opens: the time master is told, and compares what participants read and write.

A file that two of them have, and one writes, is a way past the order of simulated time. What ROS opens for itself, and
what is read for an import, is not told. Which of the others do not matter is decided there, for programs in C++ too.
"""
import os
import sys
from urllib.parse import parse_qs, unquote

from move_base_abstract.lockstep import wire

from ..code.callers import own_frame
from ..code.labels import told

_READS, _WRITES = (wire.NoteKind.READS,), (wire.NoteKind.WRITES,)
_BOTH = _READS + _WRITES
_ACCESS = os.O_RDONLY | os.O_WRONLY | os.O_RDWR
_URI = 'file:'
_IN_MEMORY = ':memory:'


class Files:
    """Of this process; each is told once."""

    def __init__(self):
        self._noted = {}
        self._participant = None

    def follow(self, participant):
        """The program takes part from now on; ``participant``: None if the time master is not in lockstep any more."""
        self._participant = participant
        for note in list(self._noted):
            self._say(note)

    def audit(self, event, arguments):
        """Look at an event of sys.audit, before it happens; never raises."""
        if event in _FILES:
            path, kinds = _FILES[event](*arguments)
            if own_frame(sys._getframe(2)) is not None:
                self._note(path, kinds)

    def connected(self, database, *_args, **_kwds):
        """Note what the program has given to sqlite3.connect, which is called by a function of ours."""
        self._note(*_database(database))

    def _note(self, path, kinds):
        if path is None or told.is_over():
            return
        try:
            text = _text(os.path.realpath(path))
        except (OSError, ValueError):
            return  # the current folder is gone, or it is no name of a file: it cannot be opened either
        for kind in kinds:
            if (kind, text) not in self._noted:
                self._noted[kind, text] = True
                self._say((kind, text))

    def _say(self, note):
        if self._participant is not None:
            add = self._participant.add_aside if told.is_ordered() else self._participant.add
            add(wire.note(*note))


def _text(path):
    """Return a path as a text that can be sent: a name may be any bytes. The same as in C++."""
    name = os.fsencode(path)
    try:
        return name.decode('utf-8')
    except UnicodeDecodeError:
        return name.decode('ascii', 'backslashreplace')


def _path(given):
    """Return what was given as a path as a text, or None: it is none, but an open file's number, say."""
    try:
        return os.fsdecode(given)
    except TypeError:
        return None


def _opened(given, mode, flags):
    """Of open() and os.open(); what is not there has been looked for: another run may find it."""
    path = _path(given)
    if mode is None and path is not None and not os.path.isabs(path) and sys._getframe(3).f_globals.get(
            '__name__') in ('os', 'shutil'):
        return None, ()  # of os.fwalk or shutil.rmtree, in a folder that the event does not name
    access = flags & _ACCESS
    return path, _BOTH if access == os.O_RDWR else _WRITES if access else _READS


def _renamed(_source, to, _source_folder=-1, folder=-1):
    """What was written under another name has this one now."""
    path = _path(to)
    return (path if path is None or folder == -1 or os.path.isabs(path) else None), _WRITES


def _database(given, *_others):
    """Of sqlite3.connect: a path, or a URI."""
    path = _path(given)
    if path in (None, '', _IN_MEMORY):
        return None, ()
    if not path.startswith(_URI):
        return path, _BOTH
    name, _, query = path[len(_URI):].partition('#')[0].partition('?')
    mode = parse_qs(query).get('mode', [''])[-1]
    is_memory = mode == 'memory' or name in ('', _IN_MEMORY)
    return None if is_memory else unquote(name), _READS if mode == 'ro' else _BOTH


#: events of sys.audit -> (path or None, what is done with it) of their arguments
_FILES = {'open': _opened, 'os.rename': _renamed, 'sqlite3.connect': _database}

#: of this process
files = Files()
