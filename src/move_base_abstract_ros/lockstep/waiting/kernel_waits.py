"""Waits in the kernel that have a time-out: for descriptors, and for locks of multiprocessing.

While a thread waits there, simulated time stands still. So a loop of such waits (``while not done: poll(0.2)``) would
hold up time for ever. They count as sleeps (:class:`.watchdog.Sleep`). What comes over descriptors labels the run.
Locks of multiprocessing are waited for as others, as long as the process has no children that could hold them.
"""
from __future__ import annotations

import select
import socket
import sys
import time
from typing import Any, Callable, List, Optional, Sequence, Tuple

from move_base_abstract.lockstep.wire import NEVER

from ...replacing.replaced import replace
from ..code.callers import own_frame
from ..code.imports import when_imported
from ..code.labels import told
from ..machine.clocks import sleep_ns

_WATCHES = 'looks at a connection or a file, by the wall clock'
#: modules that wait for children and connections of their own; the program waits for these in other ways
_OTHERS = frozenset(('asyncio.selector_events', 'asyncio.base_events', 'multiprocessing.connection', 'subprocess',
                     'socketserver', 'selectors'))
_RECEIVING = ('accept', 'recv', 'recv_into', 'recvfrom', 'recvfrom_into')
_poll = select.poll


def install(wait: Callable[..., Any]) -> None:
    """Follow the program's waits from now on; ``wait`` is :meth:`.watchdog.Sleep.wait`."""
    waits = _Waits(wait)
    replace('select.select', waits.selecting)
    for name, unit in (('select.poll', 1000.0), ('select.epoll', 1.0)):
        replace(name, lambda make, name=name, unit=unit: waits.polling(make, name, unit))
    for kind in ('Select', 'Poll', 'Epoll'):
        replace('selectors.{}Selector.select'.format(kind), waits.of_selector)
    for name in _RECEIVING:
        replace('socket.socket.' + name, lambda receive, name=name: waits.receiving(receive, 'socket.' + name))
    when_imported('multiprocessing.synchronize', waits.follow_locks)
    when_imported('multiprocessing.connection', lambda: replace('multiprocessing.connection.wait', waits.connecting))


class _Waits:
    """The waits, each as the original but for its time-out."""

    def __init__(self, wait: Callable[..., Any]) -> None:
        self._wait = wait

    def _by(self, ask: Callable[[Optional[float]], Any], seconds: Optional[float], frame: Any, what: str) -> Any:
        """Return ``ask(seconds)``; if the program waits in it, by ``what``, its time-out counts as a sleep."""
        own = None if frame.f_globals.get('__name__') in _OTHERS else own_frame(frame)
        if own is None:
            return ask(seconds)
        told.tell(own, what, _WATCHES)
        return self._wait(ask, seconds, frame, what) if seconds is not None and seconds > 0 else ask(seconds)

    def selecting(self, select_: Callable[..., Any]) -> Callable[..., Any]:
        """Return ``select.select``; without any file it is a sleep."""
        def call(rlist: Sequence[Any], wlist: Sequence[Any], xlist: Sequence[Any], timeout: Optional[float] = None,
                 /) -> Tuple[List[Any], List[Any], List[Any]]:
            def ask(seconds: Optional[float]) -> Any:
                found[:] = [select_(rlist, wlist, xlist, seconds)]
                return any(found[0])
            found: List[Any] = []
            is_sleep = isinstance(rlist, (list, tuple)) and not (rlist or wlist or xlist)
            if is_sleep and timeout is not None and own_frame(sys._getframe(1)) is not None:
                time.sleep(max(0.0, timeout))
                return [], [], []
            self._by(ask, timeout, sys._getframe(1), 'select.select')
            return found[0]
        return call

    def polling(self, make: Callable[..., Any], name: str, unit: float) -> Callable[..., Any]:
        """Return ``select.poll`` or ``select.epoll``, whose objects count time-outs in units of 1/``unit`` s."""
        def call(*args: Any, **kwds: Any) -> Any:
            told.tell(own_frame(sys._getframe(1)), name, _WATCHES)
            return _Poll(make(*args, **kwds), lambda ask, seconds, frame: self._by(ask, seconds, frame, name), unit)
        return call

    def of_selector(self, select_: Callable[..., Any]) -> Callable[..., Any]:
        """Return the method ``select`` of a selector."""
        def call(selector: Any, timeout: Optional[float] = None) -> Any:
            return self._by(lambda seconds: select_(selector, seconds), timeout, sys._getframe(1), 'selectors')
        return call

    def connecting(self, wait_: Callable[..., Any]) -> Callable[..., Any]:
        """Return ``multiprocessing.connection.wait``, by which its queues and pipes wait, too."""
        def call(object_list: Any, timeout: Optional[float] = None) -> Any:
            frame = sys._getframe(1)
            while frame.f_globals.get('__name__') in _OTHERS and frame.f_back is not None:
                frame = frame.f_back  # Connection.poll
            return self._by(lambda seconds: wait_(object_list, seconds), timeout, frame, 'multiprocessing')
        return call

    def receiving(self, receive: Callable[..., Any], name: str) -> Callable[..., Any]:
        """Return a method of a socket that receives; if the socket has a time-out, it waits for that at most."""
        def call(self_: Any, *args: Any, **kwds: Any) -> Any:
            seconds = self_.gettimeout()
            if seconds and self_.fileno() >= 0:
                poll = _poll()
                poll.register(self_, select.POLLIN)
                frame = sys._getframe(1)
                if not self._by(lambda left: poll.poll(None if left is None else left * 1000), seconds, frame, name):
                    raise socket.timeout('timed out')
            return receive(self_, *args, **kwds)
        return call

    def follow_locks(self) -> None:
        """Follow locks, events, conditions and queues of multiprocessing, which are made of semaphores."""
        def making(make: Callable[..., None]) -> Callable[..., None]:
            def call(lock: Any) -> None:
                if not isinstance(lock._semlock, _Semaphore):
                    lock._semlock = _Semaphore(lock._semlock, self._wait)
                make(lock)
            return call
        replace('multiprocessing.synchronize.SemLock._make_methods', making)


class _Poll:
    """Stands in for an object of select.poll or select.epoll."""

    def __init__(self, machine: Any, wait: Callable[..., Any], unit: float) -> None:
        self._machine, self._wait, self._unit = machine, wait, unit

    def __getattr__(self, name: str) -> Any:
        return getattr(self._machine, name)

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_error: Any) -> None:
        self._machine.close()

    def poll(self, timeout: Optional[float] = None, *most: int, **words: int) -> Any:
        """Wait as the original does."""
        def ask(seconds: Optional[float]) -> Any:
            return self._machine.poll(timeout if seconds is None else seconds * self._unit, *most, **words)
        return self._wait(ask, None if timeout is None or timeout < 0 else timeout / self._unit, sys._getframe(1))


class _Semaphore:
    """Stands in for a semaphore of multiprocessing."""

    def __init__(self, machine: Any, wait: Callable[..., Any]) -> None:
        self._machine, self._wait = machine, wait

    def __getattr__(self, name: str) -> Any:
        return getattr(self._machine, name)

    def acquire(self, block: bool = True, timeout: Optional[float] = None) -> bool:
        """Acquire it as the original does."""
        machine, participant = self._machine, told.participant
        if machine.acquire(False):
            return True
        if not block or participant is None or not participant.scheduler.is_mine():
            return bool(machine.acquire(block, timeout))
        if sys.modules['multiprocessing.process']._children:
            ask = machine.acquire
            return bool(ask() if timeout is None else self._wait(
                lambda seconds: ask(True, seconds), timeout, sys._getframe(1), 'multiprocessing'))
        scheduler = participant.scheduler
        wake_ns = NEVER if timeout is None else scheduler.now_ns + (sleep_ns(timeout) if timeout > 0 else 0)
        # only this thread takes it: a semaphore may belong to a thread
        while scheduler.wait_until(lambda: not machine._is_zero(), wake_ns, 'a lock of multiprocessing'):
            if machine.acquire(False):
                return True
        return False

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_error: Any) -> None:
        self._machine.release()
