"""Files that the program opens, or asks for, are reported to the time master, which compares what participants do.

If two participants open a file, and one of them writes it, that bypasses the order of simulated time. Files that ROS
opens for itself, and those that are read for an import, are not reported. The time master decides which of the others
do not matter, for programs in C++, too.
"""
from __future__ import annotations

import functools
import os
import sys
from typing import Any, Callable, Dict, Optional, Tuple
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
    """The files that this process has opened; each is reported once."""

    def __init__(self) -> None:
        self._noted: Dict[Tuple[Any, str], bool] = {}
        self._participant = None

    def follow(self, participant: Any) -> None:
        """Report to ``participant`` from now on; None if the time master is not in lockstep any more."""
        self._participant = participant
        for note in list(self._noted):
            self._say(note)

    def audit(self, event: Any, arguments: Any) -> None:
        """Look at an event of sys.audit, before it happens. This never raises an error."""
        for look in _FILES.get(event, ()):
            path, kinds = look(*arguments)
            if own_frame(sys._getframe(2)) is not None:
                self._note(path, kinds)

    def asking(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return ``os.stat``, or another function of a path, that notes the file as read: it may be there, or not."""
        @functools.wraps(function)
        def ask(path: Any, *args: Any, **kwds: Any) -> Any:
            if kwds.get('dir_fd') is None and own_frame(sys._getframe(1)) is not None:
                self._note(_path(path), _READS)
            return function(path, *args, **kwds)
        return ask

    def connected(self, database: Any, *_args: Any, **_kwds: Any) -> None:
        """Note the file of a database. Our replacement of sqlite3.connect calls this with the program's arguments."""
        self._note(*_database(database))

    def _note(self, path: Optional[str], kinds: Any) -> None:
        if path is None or told.is_over():
            return
        try:
            text = _text(os.path.realpath(path))
        except (OSError, ValueError):
            return  # the current folder is gone, or it is not a file's name, so it cannot be opened, either
        for kind in kinds:
            if (kind, text) not in self._noted:
                self._noted[kind, text] = True
                self._say((kind, text))

    def _say(self, note: Any) -> None:
        if self._participant is not None:
            add = self._participant.add_aside if told.is_ordered() else self._participant.add
            add(wire.note(*note))


def _text(path: str) -> Any:
    """Return a path, which may be any bytes, as a text that can be sent. Programs in C++ do the same."""
    name = os.fsencode(path)
    try:
        return name.decode('utf-8')
    except UnicodeDecodeError:
        return name.decode('ascii', 'backslashreplace')


def _path(given: Any) -> Any:
    """Return a given path as a text; None if it is not a path, but for example the number of an open file."""
    try:
        return os.fsdecode(given)
    except TypeError:
        return None


def _opened(given: Any, mode: str, flags: Any) -> Any:
    """Return (path or None, kinds of note) for open() and os.open().

    A file that is missing is noted, too, since another run may find it.
    """
    path = _path(given)
    if mode is None and path is not None and not os.path.isabs(path) and sys._getframe(3).f_globals.get(
            '__name__') in ('os', 'shutil'):
        return None, ()  # os.fwalk or shutil.rmtree opens it, in a folder that the event does not name
    access = flags & _ACCESS
    return path, _BOTH if access == os.O_RDWR else _WRITES if access else _READS


def _named(given: Any, folder: int = -1) -> Any:
    """Return (path or None, kinds of note) for a name that a file gets or loses, which counts as writing."""
    path = _path(given)
    return (path if path is None or folder == -1 or os.path.isabs(path) else None), _WRITES


def _database(given: Any, *_others: Any) -> Any:
    """Return (path or None, kinds of note) for sqlite3.connect(), which takes a path or a URI."""
    path = _path(given)
    if path in (None, '', _IN_MEMORY):
        return None, ()
    if not path.startswith(_URI):
        return path, _BOTH
    name, _, query = path[len(_URI):].partition('#')[0].partition('?')
    mode = parse_qs(query).get('mode', [''])[-1]
    is_memory = mode == 'memory' or name in ('', _IN_MEMORY)
    return None if is_memory else unquote(name), _READS if mode == 'ro' else _BOTH


#: {event of sys.audit: functions of its arguments that return (path or None, kinds of note)}
_FILES: Dict[str, Any] = {
    'open': (_opened,), 'os.remove': (_named,), 'sqlite3.connect': (_database,),
    'os.rename': (lambda source, _to, folder=-1, _folder=-1: _named(source, folder),
                  lambda _source, to, _folder=-1, folder=-1: _named(to, folder))}

#: the files of this process
files = Files()
