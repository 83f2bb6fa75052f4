"""Threads that wait for somebody outside run beside the thread that has the turn, until they act again."""
from __future__ import annotations

from threading import get_ident
from typing import Any, Callable, Deque, Dict

from .task import Task


class Beside:
    """A part of the scheduler: it lets such a thread go, and takes it back."""

    turn_ident: int
    is_closed: bool
    _tasks: Dict[int, Task]
    _ready: Deque[Task]
    from_outside: Callable[[Callable[[], object]], None]
    _resume_worker: Callable[[], None]
    #: {number: task} of the threads that were let go
    beside: Dict[int, Task]
    _beside_lock: Any  # held while a thread is let go, or comes back

    def let_go(self, ident: int, still_waits: Callable[[], bool]) -> bool:
        """Let others go on beside the thread ``ident``, which has the turn, if it ``still_waits()`` in the kernel.

        Return whether that is so. A thread without a turn calls this. The other thread takes the turn again before it
        does anything that others may see (:meth:`is_mine`).
        """
        task = self._tasks.get(ident)
        if task is None:
            return False
        with self._beside_lock:
            if self.turn_ident != ident or self.is_closed:
                return False
            self.beside[ident] = task
            self.turn_ident = 0  # before the look: whoever acts after it has no turn any more, and asks for one
            if not still_waits():
                self.beside.pop(ident, None)
                self.turn_ident = ident
                return False
        self._resume_worker()
        return True

    def comes_back(self) -> bool:
        """If the calling thread was let go, wait for the turn; return whether it has the turn."""
        with self._beside_lock:
            task = self.beside.pop(get_ident(), None)
        if task is None or self.is_closed:
            return self.turn_ident == get_ident()
        self.from_outside(lambda: self._ready.append(task))
        task.parking.acquire()
        if not self.is_closed:
            self.turn_ident = task.ident
        return True
