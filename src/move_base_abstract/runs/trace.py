"""The rows of robots and orders, which are the same in the trace of the plain Python fleet and in a run's event log."""
from __future__ import annotations

import gc
from typing import Any, Callable, Iterable, Iterator, List, NamedTuple, Tuple


class RowKind(NamedTuple):
    """A kind of rows: its ``values`` and ``words``, which say when it comes, as the page has them.

    Positions are in m and yaws in rad, in the global frame. ``is_motion``: whether the rows come only with the
    parameter ``log_motion``.
    """

    kind: str
    values: str
    words: str
    is_motion: bool = False


class TraceEntry(NamedTuple):
    """Something that happened: when [ns], to which robot, its kind, and its values, as its :class:`RowKind` says."""

    time_ns: int
    robot: str
    kind: str
    values: Any


#: the most frequent kinds of rows: how many values their events have, and how many of these are the row
FLAT = {'goal': (4, 4), 'departed': (6, 6), 'stands': (6, 6), 'ended': (8, 6), 'entered': (4, 4), 'left': (4, 4)}
_new = tuple.__new__  # makes a named tuple without the call of its constructor


class Rows:
    """Rows that nobody has read yet.

    The values of events of the kinds in FLAT follow one another in one list, without an object for each row: the
    objects that Python's garbage collector would visit again and again would become more and more.
    """

    def __init__(self) -> None:
        self._values: List[Any] = []
        #: takes a row of any kind
        self.take: Callable[[Tuple[Any, ...]], None] = self._values.append
        #: takes an event of a kind in FLAT
        self.take_flat: Callable[[Tuple[Any, ...]], None] = self._values.extend

    def read(self) -> List[TraceEntry]:
        """Return all rows as entries, and forget them."""
        collects = gc.isenabled()
        gc.disable()  # all objects made here stay, so the search for garbage, which takes most of the time, finds none
        try:
            return self._entries()
        finally:
            self._values.clear()
            if collects:
                gc.enable()

    def _entries(self) -> List[TraceEntry]:
        values, entries, place = self._values, [], 0
        while place < len(values):
            row = values[place]
            if type(row) is tuple:
                place += 1
                time_ns, robot, kind, *rest = row
                entries.append(TraceEntry(time_ns, robot, kind, tuple(rest)))
            else:
                robot, kind = values[place + 1], values[place + 2]
                length, end = FLAT[kind]
                entries.append(_new(TraceEntry, (row, robot, kind, tuple(values[place + 3:place + end]))))
                place += length
        return entries


def as_entries(rows: Iterable[Tuple[Any, ...]]) -> Iterator[TraceEntry]:
    """Yield the rows of events as :class:`TraceEntry` objects; they are made only when somebody reads them."""
    return (TraceEntry(row[0], row[1], row[2], row[3:]) for row in rows)
