"""Locks like Python's, but an application thread that waits for another one gives the turn away, so that others go on.

``threading.Condition``, ``Event``, ``Semaphore``, ``Barrier`` and ``queue.Queue`` are made of these two locks, and ask
:func:`clock` for the rest of a time-out. Time-outs of application threads are in simulated time. All other threads wait
as usual. If an application thread waits for one of them, simulated time stands still.
"""
from __future__ import annotations

from collections import deque
from threading import TIMEOUT_MAX, get_ident
from typing import TYPE_CHECKING, Any, Callable, Deque, Dict, Optional

from ..common.units import seconds_to_ns
from . import open_waits
from .task import TurnLost, _make_lock
from .wire import NEVER

if TYPE_CHECKING:
    from threading import Lock

_LAST_WAIT = 1.0  # s, wall


class _NoScheduler:
    """Stands in for the scheduler before the process takes part, when every thread runs freely."""

    turn_ident = 0
    is_closed = True
    beside: Dict[int, object] = {}

    @staticmethod
    def is_mine() -> bool:
        """Return False: no thread has the turn."""
        return False


class Process:
    """Holds the scheduler that the locks of this process ask; before the process takes part, a stand-in."""

    scheduler: Any = _NoScheduler()  # a Scheduler


def clock(machine_clock: Callable[[], float]) -> Callable[[], float]:
    """Return a function that returns simulated time [s] to application threads, and ``machine_clock()`` to others."""
    def now() -> float:
        scheduler = Process.scheduler
        return scheduler.now_ns * 1e-9 if scheduler.is_mine() else machine_clock()
    return now


def _wake_ns(timeout: float) -> int:
    """Return when ``timeout`` [s] is over [ns], or NEVER; a positive time-out lasts at least 1 ns, despite rounding."""
    if timeout < 0 or timeout >= TIMEOUT_MAX:
        return NEVER
    now_ns: int = Process.scheduler.now_ns
    return now_ns + (max(1, seconds_to_ns(timeout)) if timeout > 0 else 0)


class CooperativeLock:
    """A lock like Python's own, but an application thread that waits for another one gives the turn away."""

    __slots__ = ('_lock', '_waiting', '_is_applications', '__weakref__')

    def __init__(self) -> None:
        self._lock: Lock = _make_lock()
        self._waiting: Optional[Deque[Any]] = None  # tasks
        self._is_applications = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire as threading.Lock does; in application threads the time-out is in simulated time."""
        if Process.scheduler.beside:
            Process.scheduler.comes_back()
        if self._lock.acquire(False):
            self._is_applications = Process.scheduler.turn_ident == get_ident()
            return True
        if not blocking or timeout != -1 and timeout < 0:
            return self._lock.acquire(blocking, timeout)  # False, or the error that Python raises
        if not (self._is_applications and Process.scheduler.is_mine()):
            # It is held by a thread that runs freely and will release it by itself.
            is_taken = self._lock.acquire(True, timeout)
            self._is_applications = is_taken and Process.scheduler.is_mine()
            return is_taken
        return self._wait(timeout)

    __enter__ = acquire

    def _wait(self, timeout: float) -> bool:
        task = Process.scheduler.current()
        wake_ns = _wake_ns(timeout)
        kind, what = open_waits.of_lock(2) if wake_ns >= NEVER else (None, '')
        if self._waiting is None:
            self._waiting = deque()
        while not self._lock.acquire(False):
            if wake_ns <= Process.scheduler.now_ns:
                return False
            self._waiting.append(task)
            try:
                Process.scheduler.wait(wake_ns, what, kind)
            except TurnLost:
                return self._wait_in_the_end(timeout)
            finally:
                if task in self._waiting:
                    self._waiting.remove(task)
        self._is_applications = True
        return True

    def _wait_in_the_end(self, timeout: float) -> bool:
        """Wait after the end of lockstep, when the node is about to end: at most 1 s of wall time for the holder."""
        if self._lock.acquire(True, _LAST_WAIT if timeout < 0 else min(timeout, _LAST_WAIT)):
            return True
        if timeout < 0:
            raise TurnLost('lockstep has ended while this thread waited for another one')
        return False

    def release(self, *_error: Any) -> None:
        """Release as threading.Lock does."""
        self._is_applications = False
        self._lock.release()
        if self._waiting:
            self._wake()

    __exit__ = release

    def _wake(self) -> None:
        if Process.scheduler.is_mine():
            Process.scheduler.wake(self._waiting.popleft())  # type: ignore[union-attr]
        elif not Process.scheduler.is_closed:
            Process.scheduler.from_outside(self._wake_one)

    def _wake_one(self) -> None:
        if self._waiting:
            Process.scheduler.wake(self._waiting.popleft())

    def locked(self) -> bool:
        """Return whether the lock is held."""
        return self._lock.locked()

    def _at_fork_reinit(self) -> None:
        self._lock = _make_lock()
        self._waiting = None

    # Python's old names of these methods.
    acquire_lock, release_lock, locked_lock = acquire, release, locked


class CooperativeRLock:
    """A lock like threading.RLock, which its owner may take again, made of a :class:`CooperativeLock`."""

    __slots__ = ('_block', '_owner', '_count', '__weakref__')

    def __init__(self) -> None:
        self._block = CooperativeLock()
        self._owner: Optional[int] = None
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire as threading.RLock does; in application threads the time-out is in simulated time."""
        me = get_ident()
        if self._owner == me:
            self._count += 1
            return True
        block = self._block
        if Process.scheduler.beside:
            Process.scheduler.comes_back()
        if block._lock.acquire(False):  # as block.acquire begins, but faster: rospy takes these locks all the time
            block._is_applications = Process.scheduler.turn_ident == me
        elif not block.acquire(blocking, timeout):
            return False
        self._owner = me
        self._count = 1
        return True

    __enter__ = acquire

    def release(self, *_error: Any) -> None:
        """Release as threading.RLock does."""
        if self._owner != get_ident():
            raise RuntimeError('cannot release un-acquired lock')
        self._count -= 1
        if not self._count:
            self._owner = None
            self._block.release()

    __exit__ = release

    # The methods that threading.Condition needs.

    def _is_owned(self) -> bool:
        return self._owner == get_ident()

    def _release_save(self) -> int:
        count, self._count, self._owner = self._count, 0, None
        self._block.release()
        return count

    def _acquire_restore(self, count: int) -> None:
        self._block.acquire()
        self._owner, self._count = get_ident(), count

    def _at_fork_reinit(self) -> None:
        self._block._at_fork_reinit()
        self._owner, self._count = None, 0

    # The methods that newer Pythons need: for multiprocessing from 3.13 on, for all from 3.14 on.

    def _recursion_count(self) -> int:
        return self._count if self._owner == get_ident() else 0

    def locked(self) -> bool:
        """Return whether any thread holds the lock."""
        return self._owner is not None
