"""SQLite's own random numbers and dates, in the connections of a program, are those of the run.

SQLite's functions for them are replaced in each connection by functions of this module. Those for dates pass calls that
are not about the present on to SQLite itself.
"""
from __future__ import annotations

import datetime
import sys
from typing import Any, Callable

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.lockstep.machine_view import DATE

from ...replacing.replaced import replace
from ..code.callers import own_frame
from ..code.imports import when_imported
from .files import files

_DATES = ('date', 'time', 'datetime', 'julianday', 'unixepoch')
_NOW = 'now'


def install(clocks: Any, draw: Callable[..., Any]) -> None:
    """Replace sqlite3.connect as soon as sqlite3 is imported. ``draw(size)`` returns bytes of the run's chance."""
    when_imported('sqlite3', lambda: _install(_Functions(clocks, draw)))


def _install(functions: Any) -> None:
    for name in ('sqlite3.connect', 'sqlite3.dbapi2.connect'):
        replace(name, lambda connect: _connecting(connect, functions))


def _connecting(connect: Any, functions: Any) -> Any:
    def connect_(*args: Any, **kwds: Any) -> Any:
        made = connect(*args, **kwds)
        if own_frame(sys._getframe(1)) is not None:
            functions.give(made, connect)
            files.connected(*args, **kwds)
        return made
    return connect_


class _Functions:
    """The replacements of the functions of SQLite that ask the machine."""

    def __init__(self, clocks: Any, draw: Any) -> None:
        self._clocks, self._draw = clocks, draw
        self._plain: Any = None

    def give(self, connection: Any, connect: Any) -> None:
        """Install the replacements in a connection."""
        if self._plain is None:
            self._plain = connect(':memory:', check_same_thread=False)
        made = connection.create_function
        made('random', 0, lambda: int.from_bytes(self._draw(8), 'little', signed=True))
        made('randomblob', 1, lambda size: self._draw(max(1, int(size or 0))))
        for name, shown in (('current_timestamp', '%Y-%m-%d %H:%M:%S'), ('current_date', '%Y-%m-%d'),
                            ('current_time', '%H:%M:%S')):
            made(name, 0, lambda shown=shown: self._present().strftime(shown))
        for name in _DATES:
            made(name, -1, self._dating(name, 0), deterministic=True)
        made('strftime', -1, self._dating('strftime', 1), deterministic=True)

    def _present(self) -> Any:
        return datetime.datetime.fromtimestamp(self._clocks.now(DATE) / NS_PER_S, datetime.timezone.utc)

    def _dating(self, name: str, place: Any) -> Any:
        """Return the replacement of the date function ``name``; its instant is the argument at ``place``."""
        def function(*given: Any) -> Any:
            words = list(given)
            if len(words) == place:
                words.append(_NOW)
            if len(words) > place and isinstance(words[place], str) and words[place].strip().lower() == _NOW:
                words[place] = self._present().strftime('%Y-%m-%d %H:%M:%S.%f')[:-3]
            marks = ', '.join('?' * len(words))
            return self._plain.execute('SELECT {}({})'.format(name, marks), words).fetchone()[0]
        return function
