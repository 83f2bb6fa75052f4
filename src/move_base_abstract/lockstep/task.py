"""A thread of a participant, as the scheduler sees it."""
from __future__ import annotations

import threading
from typing import Any, Tuple

# The machine's own locks: those that the application gets are made of waits in the scheduler.
_make_lock = threading._allocate_lock  # type: ignore[attr-defined]


class Task:
    """What one thread waits for, and how it is let go."""

    __slots__ = ('name', 'ident', 'parking', 'is_waiting', 'wake_token', 'timed_out', 'waits_for', 'kind',
                 'is_finished', 'is_worker', 'looks', 'turns', 'idle_turns',
                 'is_looking')

    def __init__(self, name: str, is_worker: bool = False) -> None:
        self.name = name
        self.ident = 0
        self.parking: Any = _make_lock()
        self.parking.acquire()
        self.is_waiting = False
        self.wake_token = 0
        self.timed_out = False
        self.waits_for = ''
        self.kind: Any = None  # of a wait without end: see open_waits
        self.is_finished = False
        self.is_worker = is_worker
        self.looks = 0  # since it has waited, sent, or looked away
        self.is_looking: int = False
        self.turns = 0  # of loops; since it has computed, too
        self.idle_turns = 0  # since it has also called what may compute


def release(task: Task) -> None:
    """Let a parked thread go. One may be let go twice: by who has the turn, and by the end of lockstep."""
    try:
        task.parking.release()
    except RuntimeError:
        pass


def is_current(entry: Tuple[int, int, int, Task]) -> bool:
    """Whether a sleeper still sleeps, and in the same wait."""
    return entry[3].is_waiting and entry[3].wake_token == entry[2]
