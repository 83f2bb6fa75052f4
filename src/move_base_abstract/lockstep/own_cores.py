"""The process's own cores: those that it may use outside of lockstep. The time master may bind it to one of them.

Programs that the process starts do not inherit that binding, code that counts the cores does not see it, and it ends
with the connection.
"""
from __future__ import annotations

import os
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Set


class OwnCores:
    """Remembers the cores of the process before it took part, unless the program has chosen cores since."""

    def __init__(self) -> None:
        self._get, self._set = os.sched_getaffinity, os.sched_setaffinity  # the originals, which may be replaced later
        self._own: Any = None

    def remember(self) -> None:
        """Remember the present cores, before the process takes part."""
        self._own = self._get(0)

    def restore(self) -> None:
        """Give the process's own cores back to all of its threads that were bound from outside."""
        bound = self._get(os.getpid())
        if not self._is_bound(bound):
            return
        for thread in os.listdir('/proc/self/task'):
            try:
                if self._get(int(thread)) == bound:
                    self._set(int(thread), self._own)
            except OSError:
                pass  # the thread has just ended

    @contextmanager
    def lifted(self) -> Iterator[None]:
        """Lift the binding of the calling thread in a with block: what it starts there has the process's own cores."""
        bound = self._get(0)
        if not self._is_bound(bound):
            yield
            return
        self._set(0, self._own)
        try:
            yield
        finally:
            if self._get(0) == self._own:
                self._set(0, bound)

    def seen(self, getaffinity: Callable[..., Any]) -> Callable[..., Any]:
        """Return a replacement for os.sched_getaffinity, which returns the own cores of a process that is bound."""
        def call(pid: int, /) -> Set[int]:
            cores = getaffinity(pid)
            return set(self._own) if self._is_bound(cores) else cores
        return call

    def chosen(self, setaffinity: Callable[..., Any]) -> Callable[..., Any]:
        """Return a replacement for os.sched_setaffinity: cores that the program chooses are its own from then on."""
        def call(pid: int, mask: Set[int], /) -> None:
            setaffinity(pid, mask)
            self._own = None
        return call

    def loading(self, create_dynamic: Callable[..., Any]) -> Callable[..., Any]:
        """Return a replacement for _imp.create_dynamic: libraries that count cores when they are loaded see all."""
        def call(*args: Any) -> Any:
            with self.lifted():
                return create_dynamic(*args)
        return call

    def _is_bound(self, cores: Set[int]) -> bool:
        return self._own is not None and len(cores) == 1 and cores < self._own


own_cores = OwnCores()  # the one of this process
