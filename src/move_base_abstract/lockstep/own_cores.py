"""The cores that this process may use by itself: the time master may keep it on one of them while it takes part.

What the process starts does not inherit that, who counts its cores does not see it, and it ends with the connection.
"""
from __future__ import annotations

import os
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Set


class OwnCores:
    """Knows what the process had before it took part; nothing, where it has chosen by itself since."""

    def __init__(self) -> None:
        self._get, self._set = os.sched_getaffinity, os.sched_setaffinity  # the kernel's, whatever is replaced later
        self._own: Any = None

    def remember(self) -> None:
        """Keep the cores of now: the process is about to take part."""
        self._own = self._get(0)

    def restore(self) -> None:
        """Give all threads of the process its own cores back, if they were taken from outside."""
        bound = self._get(os.getpid())
        if not self._is_bound(bound):
            return
        for thread in os.listdir('/proc/self/task'):
            try:
                if self._get(int(thread)) == bound:
                    self._set(int(thread), self._own)
            except OSError:
                pass  # it has just ended

    @contextmanager
    def lifted(self) -> Iterator[None]:
        """What the calling thread starts in this context has the process's own cores."""
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
        """Return what stands for os.sched_getaffinity: it tells the process's own cores."""
        def call(pid: int, /) -> Set[int]:
            cores = getaffinity(pid)
            return set(self._own) if self._is_bound(cores) else cores
        return call

    def chosen(self, setaffinity: Callable[..., Any]) -> Callable[..., Any]:
        """Return what stands for os.sched_setaffinity: what the program chooses is its own."""
        def call(pid: int, mask: Set[int], /) -> None:
            setaffinity(pid, mask)
            self._own = None
        return call

    def loading(self, create_dynamic: Callable[..., Any]) -> Callable[..., Any]:
        """Return what stands for _imp.create_dynamic: libraries that count cores when they are loaded see all."""
        def call(*args: Any) -> Any:
            with self.lifted():
                return create_dynamic(*args)
        return call

    def _is_bound(self, cores: Set[int]) -> bool:
        return self._own is not None and len(cores) == 1 and cores < self._own


own_cores = OwnCores()  # of this process
