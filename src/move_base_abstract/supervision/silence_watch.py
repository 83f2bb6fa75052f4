"""Whether another simulator still runs: finds sources that have been silent for too long."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, List, Tuple


@dataclass(frozen=True)
class Silence:
    """News about sources: those that were never heard, that have fallen silent, and that are heard again."""

    unheard: Tuple[str, ...] = ()
    silent: Tuple[str, ...] = ()
    back: Tuple[str, ...] = ()


class SilenceWatch:
    """Reports sources that were silent for ``limit`` [s, wall], and again every ``repeat`` [s, wall] while they are.

    Wall times are arguments [s, of one clock that never goes back]. Not thread-safe.
    """

    def __init__(self, limit: float = 8.0, repeat: float = 60.0) -> None:
        self.limit = limit
        self._repeat = repeat
        self._sources: Dict[str, _Source] = {}

    def add(self, name: str, wall: float) -> None:
        """Watch the source ``name`` from ``wall`` [s] on."""
        self._sources[name] = _Source(wall + self.limit)

    def remove(self, name: str) -> None:
        """Stop watching the source ``name``."""
        self._sources.pop(name, None)

    def heard(self, name: str, wall: float) -> None:
        """Note that the source ``name`` was heard at ``wall`` [s]."""
        source = self._sources.get(name)
        if source is not None:
            source.due = wall + self.limit
            source.was_heard = True
            source.is_back = source.is_back or source.is_told
            source.is_told = False

    def check(self, wall: float) -> Silence:
        """Return the :class:`Silence` that was not reported yet, at ``wall`` [s], in the order of the calls of add."""
        unheard: List[str] = []
        silent: List[str] = []
        back: List[str] = []
        for name, source in self._sources.items():
            if source.is_back:
                source.is_back = False
                back.append(name)
            if wall >= source.due:
                source.due = wall + self._repeat
                source.is_told = True
                (silent if source.was_heard else unheard).append(name)
        return Silence(tuple(unheard), tuple(silent), tuple(back))


class _Source:
    """One source; ``due``: the time at which its silence is reported [s, wall]."""

    __slots__ = ('due', 'was_heard', 'is_told', 'is_back')

    def __init__(self, due: float) -> None:
        self.due = due
        self.was_heard = self.is_told = self.is_back = False
