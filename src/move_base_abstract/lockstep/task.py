"""A thread of a participant as the scheduler sees it."""
from __future__ import annotations

import threading
from typing import Any, Tuple

# Python's own locks. The application gets other locks, whose waits are waits in the scheduler.
_make_lock = threading._allocate_lock  # type: ignore[attr-defined]


class TurnLost(Exception):
    """The participant has left lockstep while this thread waited."""


class Repeated:
    """What a thread does again and again: how often at one instant, which is that of the last time [ns]."""

    __slots__ = ('count', 'at_ns')

    def __init__(self) -> None:
        self.count, self.at_ns = 0, -1


class Task:
    """The state of one thread: what it waits for, and the lock that is released to let it go on."""

    __slots__ = ('name', 'ident', 'parking', 'is_waiting', 'wake_token', 'timed_out', 'waits_for', 'kind',
                 'is_finished', 'is_worker', 'looks', 'turns', 'idle_turns',
                 'is_looking', 'calls', 'messages')

    def __init__(self, name: str, is_worker: bool = False) -> None:
        self.name = name
        self.ident = 0
        self.parking: Any = _make_lock()
        self.parking.acquire()
        self.is_waiting = False
        self.wake_token = 0
        self.timed_out = False
        self.waits_for = ''
        self.kind: Any = None  # the kind of a wait without end, see open_waits
        self.is_finished = False
        self.is_worker = is_worker
        self.looks = 0  # the number of looks since it has waited, sent, or looked away
        self.is_looking: int = False
        self.turns = 0  # the number of turns of loops since then, or since it has computed
        self.idle_turns = 0  # the same, or since it has called a function that may compute
        self.calls, self.messages = Repeated(), Repeated()  # of services; that it has waited for


def release(task: Task) -> None:
    """Let a parked thread go on. That may happen twice: by the thread that has the turn, and at the end of lockstep."""
    try:
        task.parking.release()
    except RuntimeError:
        pass


def is_current(entry: Tuple[int, int, int, Task]) -> bool:
    """Return whether a sleeper still sleeps in the same wait."""
    return entry[3].is_waiting and entry[3].wake_token == entry[2]
