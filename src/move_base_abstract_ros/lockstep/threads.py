"""Threads of the application: one runs at a time, and Python's locks are known waits (R9).

A thread that the application starts waits for its first turn. ``threading.Lock`` and everything made of it (RLock,
Condition, Event, Semaphore, Barrier, Queue, joins) gives the turn away when an application thread must wait for
another; time-outs are simulated time. Threads of rospy itself use the same locks as ever.
"""
import queue
import threading
from collections import deque
from threading import get_ident

from move_base_abstract.lockstep.scheduler import TurnLost, _make_lock
from move_base_abstract.lockstep.wire import NEVER

from .waits import to_ns

#: who is never a thread of the application
_FOREIGN = ('rospy.', 'rosgraph.', 'xmlrpc', 'socketserver', 'logging', 'move_base_abstract_ros.lockstep',
            'move_base_abstract_ros.outbox')
_OF_THE_APPLICATION = ('rospy.timer',)

class _NoScheduler:
    """Before the process takes part, every thread runs freely."""

    turn_ident = 0
    is_closed = True

    @staticmethod
    def is_mine():
        """No thread has a turn."""
        return False


class _Process:
    """What the locks of this process ask."""

    scheduler = _NoScheduler()


def install(participant, own_threads):
    """Follow the application's threads; with ``own_threads`` its locks as well."""
    _Process.scheduler = participant.scheduler
    if own_threads:
        replace_locks()
        _follow_threads(participant.scheduler)


def replace_locks():
    """Have the locks that are made from now on give the turn away; until the process takes part they are ordinary."""
    threading._allocate_lock = threading.Lock = CooperativeLock
    threading.RLock = CooperativeRLock
    queue.SimpleQueue = queue._PySimpleQueue


def _follow_threads(scheduler):
    start, join = threading.Thread.start, threading.Thread.join

    def _start(self):
        if scheduler.is_mine() and not _is_foreign(self):
            task = scheduler.spawn(self.name)
            self._lockstep_task = task
            self.run = _in_turn(scheduler, task, self.run)
        # While a thread is started, Python itself waits for it: not a wait of the application.
        mine, is_mine = scheduler.turn_ident, scheduler.is_mine()
        if is_mine:
            scheduler.turn_ident = 0
        try:
            start(self)
        finally:
            if is_mine:
                scheduler.turn_ident = mine

    def _join(self, timeout=None):
        task = getattr(self, '_lockstep_task', None)
        if task is not None and scheduler.is_mine() and not task.is_finished:
            wake_ns = NEVER if timeout is None else scheduler.now_ns + max(0, to_ns(timeout))
            if not scheduler.wait_until(lambda: task.is_finished, wake_ns, 'the end of thread {}'.format(self.name)):
                return
        join(self, timeout)

    threading.Thread.start, threading.Thread.join = _start, _join


def _is_foreign(thread):
    target = getattr(thread, '_target', None)
    for module in (type(thread).__module__, getattr(target, '__module__', None) or ''):
        if module.startswith(_OF_THE_APPLICATION):
            return False
        if (module + '.').startswith(_FOREIGN):
            return True
    return False


def _in_turn(scheduler, task, run):
    def run_in_turn():
        scheduler.begin(task)
        try:
            run()
        except TurnLost:
            pass  # lockstep is over, and with it the node
        finally:
            scheduler.finish()
    return run_in_turn


class CooperativeLock:
    """A lock as Python's own; an application thread that waits for another one lets the others go on."""

    __slots__ = ('_lock', '_waiting', '_is_applications', '__weakref__')

    def __init__(self):
        self._lock = _make_lock()
        self._waiting = None
        self._is_applications = False

    def acquire(self, blocking=True, timeout=-1):
        """As threading.Lock.acquire; the time-out is simulated in application threads."""
        if self._lock.acquire(False):
            self._is_applications = _Process.scheduler.turn_ident == get_ident()
            return True
        if not blocking:
            return False
        if not (self._is_applications and _Process.scheduler.is_mine()):
            # Held by a thread that runs freely and will let go by itself.
            is_taken = self._lock.acquire(True, timeout)
            self._is_applications = is_taken and _Process.scheduler.is_mine()
            return is_taken
        return self._wait(timeout)

    __enter__ = acquire

    def _wait(self, timeout):
        task = _Process.scheduler.current()
        wake_ns = NEVER if timeout is None or timeout < 0 else _Process.scheduler.now_ns + to_ns(timeout)
        if self._waiting is None:
            self._waiting = deque()
        while not self._lock.acquire(False):
            if wake_ns <= _Process.scheduler.now_ns:
                return False
            self._waiting.append(task)
            try:
                _Process.scheduler.wait(wake_ns, 'another thread')
            except TurnLost:
                return self._lock.acquire(True, timeout)
            finally:
                if task in self._waiting:
                    self._waiting.remove(task)
        self._is_applications = True
        return True

    def release(self):
        """As threading.Lock.release."""
        self._is_applications = False
        self._lock.release()
        if self._waiting:
            self._wake()

    def __exit__(self, *_error):
        self.release()

    def _wake(self):
        if _Process.scheduler.is_mine():
            _Process.scheduler.wake(self._waiting.popleft())
        elif not _Process.scheduler.is_closed:
            _Process.scheduler.from_outside(self._wake_one)

    def _wake_one(self):
        if self._waiting:
            _Process.scheduler.wake(self._waiting.popleft())

    def locked(self):
        """As threading.Lock.locked."""
        return self._lock.locked()

    def _at_fork_reinit(self):
        self._lock = _make_lock()
        self._waiting = None


class CooperativeRLock:
    """A lock that its owner may take again, made of a :class:`CooperativeLock`."""

    __slots__ = ('_block', '_owner', '_count', '__weakref__')

    def __init__(self):
        self._block = CooperativeLock()
        self._owner = None
        self._count = 0

    def acquire(self, blocking=True, timeout=-1):
        """As threading.RLock.acquire."""
        me = get_ident()
        if self._owner == me:
            self._count += 1
            return True
        if not self._block.acquire(blocking, timeout):
            return False
        self._owner = me
        self._count = 1
        return True

    __enter__ = acquire

    def release(self):
        """As threading.RLock.release."""
        if self._owner != get_ident():
            raise RuntimeError('cannot release un-acquired lock')
        self._count -= 1
        if not self._count:
            self._owner = None
            self._block.release()

    def __exit__(self, *_error):
        self.release()

    # What threading.Condition asks for.

    def _is_owned(self):
        return self._owner == get_ident()

    def _release_save(self):
        count, self._count, self._owner = self._count, 0, None
        self._block.release()
        return count

    def _acquire_restore(self, count):
        self._block.acquire()
        self._owner, self._count = get_ident(), count

    def _at_fork_reinit(self):
        self._block._at_fork_reinit()
        self._owner, self._count = None, 0
