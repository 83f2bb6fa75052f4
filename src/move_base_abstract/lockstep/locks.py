"""Locks that give the turn away: as Python's, but an application thread that waits for another lets the others go on.

``threading.Condition``, ``Event``, ``Semaphore``, ``Barrier`` and ``queue.Queue`` are made of these two, and ask
:func:`clock` what is left of a time-out. Time-outs of application threads are simulated time. Threads that are not the
application's wait as ever, and are waited for with simulated time standing still.
"""
from __future__ import annotations

from collections import deque
from threading import TIMEOUT_MAX, get_ident
from typing import TYPE_CHECKING, Any, Callable, Deque, Optional

from ..common.units import seconds_to_ns
from . import open_waits
from .scheduler import TurnLost
from .task import _make_lock
from .wire import NEVER

if TYPE_CHECKING:
    from threading import Lock

_LAST_WAIT = 1.0  # s, wall


class _NoScheduler:
    """Before the process takes part, every thread runs freely."""

    turn_ident = 0
    is_closed = True

    @staticmethod
    def is_mine() -> bool:
        """No thread has a turn."""
        return False


class Process:
    """Whom the locks of this process ask: its scheduler, once it takes part."""

    scheduler: Any = _NoScheduler()  # a Scheduler


def clock(machine_clock: Callable[[], float]) -> Callable[[], float]:
    """Return a function that tells application threads simulated time [s], and others what ``machine_clock()`` says."""
    def now() -> float:
        scheduler = Process.scheduler
        return scheduler.now_ns * 1e-9 if scheduler.is_mine() else machine_clock()
    return now


def _wake_ns(timeout: float) -> int:
    """Return when ``timeout`` [s] is over, or NEVER; what is left of one must not be lost in rounding."""
    if timeout < 0 or timeout >= TIMEOUT_MAX:
        return NEVER
    now_ns: int = Process.scheduler.now_ns
    return now_ns + (max(1, seconds_to_ns(timeout)) if timeout > 0 else 0)


class CooperativeLock:
    """A lock as Python's own; an application thread that waits for another one lets the others go on."""

    __slots__ = ('_lock', '_waiting', '_is_applications', '__weakref__')

    def __init__(self) -> None:
        self._lock: Lock = _make_lock()
        self._waiting: Optional[Deque[Any]] = None  # tasks
        self._is_applications = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """As threading.Lock.acquire; the time-out is simulated in application threads."""
        if self._lock.acquire(False):
            self._is_applications = Process.scheduler.turn_ident == get_ident()
            return True
        if not blocking or timeout != -1 and timeout < 0:
            return self._lock.acquire(blocking, timeout)  # False, or the error that Python raises
        if not (self._is_applications and Process.scheduler.is_mine()):
            # Held by a thread that runs freely and will let go by itself.
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
        """Lockstep is over, and the node about to end: wait for a holder that goes on now, but for no other."""
        if self._lock.acquire(True, _LAST_WAIT if timeout < 0 else min(timeout, _LAST_WAIT)):
            return True
        if timeout < 0:
            raise TurnLost('lockstep has ended while this thread waited for another one')
        return False

    def release(self, *_error: Any) -> None:
        """As threading.Lock.release."""
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
        """As threading.Lock.locked."""
        return self._lock.locked()

    def _at_fork_reinit(self) -> None:
        self._lock = _make_lock()
        self._waiting = None

    # Python's old names of the same.
    acquire_lock, release_lock, locked_lock = acquire, release, locked


class CooperativeRLock:
    """A lock that its owner may take again, made of a :class:`CooperativeLock`."""

    __slots__ = ('_block', '_owner', '_count', '__weakref__')

    def __init__(self) -> None:
        self._block = CooperativeLock()
        self._owner: Optional[int] = None
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """As threading.RLock.acquire."""
        me = get_ident()
        if self._owner == me:
            self._count += 1
            return True
        block = self._block
        if block._lock.acquire(False):  # what the block's own acquire begins with: rospy takes these locks all the time
            block._is_applications = Process.scheduler.turn_ident == me
        elif not block.acquire(blocking, timeout):
            return False
        self._owner = me
        self._count = 1
        return True

    __enter__ = acquire

    def release(self, *_error: Any) -> None:
        """As threading.RLock.release."""
        if self._owner != get_ident():
            raise RuntimeError('cannot release un-acquired lock')
        self._count -= 1
        if not self._count:
            self._owner = None
            self._block.release()

    __exit__ = release

    # What threading.Condition asks for.

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

    # What newer Pythons ask for: multiprocessing from 3.13 on, anybody from 3.14 on.

    def _recursion_count(self) -> int:
        return self._count if self._owner == get_ident() else 0

    def locked(self) -> bool:
        """As threading.RLock.locked."""
        return self._owner is not None
