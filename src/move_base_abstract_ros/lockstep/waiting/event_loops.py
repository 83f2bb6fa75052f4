"""Event loops of asyncio: their time is the run's, and waiting for a callback gives the turn away like any other wait.

A loop waits in its selector, until a timer is due or another thread calls ``call_soon_threadsafe``. Both are known to
lockstep: the timer's instant is simulated time, and the other thread has the turn. Input over connections and pipes,
and signals of the kernel, are handled as without lockstep: they come by the wall clock, and label the run. Nothing is
replaced before the program imports asyncio.
"""
from __future__ import annotations

import importlib
import itertools
import signal
import sys
import threading
import types
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from move_base_abstract.common.units import NS_PER_S, seconds_to_ns
from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.machine_view import UPTIME
from move_base_abstract.lockstep.open_waits import WORK
from move_base_abstract.lockstep.stable_hash import Numbered
from move_base_abstract.lockstep.task import TurnLost, _make_lock
from move_base_abstract.lockstep.wire import NEVER

from ...replacing.replaced import replace
from ..code.callers import is_own, own_frame
from ..code.imports import when_imported
from ..code.labels import told
from ..failing import outcomes
from .waits import replace_within, until_shutdown

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

_WAITS_FOR = 'a callback of its event loop'
_OUTSIDE = 'gets data over a connection or a pipe, at some moment of the wall clock'
_BY_ADDRESS = 'goes through a set of coroutines, which Python hashes by their address: its order differs from run to ' \
              'run'
_ENDS = (signal.SIGINT, signal.SIGTERM)  # signals that end the run
_LOOK_SECONDS, _LAST_WAIT = 0.05, 1.0  # wall; within the first, new connections are watched; the second is as for locks
_numbers = itertools.count()


def install(clocks: Any, take_part: Callable[..., Any]) -> None:
    """Make event loops use the run's clocks, ``clocks``, as soon as asyncio is imported.

    ``take_part(what)`` is called if a program that is not a node yet waits, as in :mod:`watchdog`.
    """
    when_imported('asyncio', lambda: _install(clocks, take_part))


def _install(clocks: Any, take_part: Callable[..., Any]) -> None:
    loops = 'asyncio.selector_events.BaseSelectorEventLoop.'
    replace(loops + '__init__', lambda init: _making(init, clocks, take_part))
    replace(loops + '_write_to_self', _waking)
    replace('asyncio.unix_events._UnixSelectorEventLoop._handle_signal', _signalled)
    replace('asyncio.base_events.BaseEventLoop.time', lambda time: _telling_time(time, clocks))
    replace('asyncio.events.TimerHandle.__init__', _in_order_of_creation)
    for name in ('asyncio.tasks.Task', 'asyncio.futures.Future'):
        replace(name, _numbered)
    outcomes.follow_tasks()
    replace('asyncio.tasks.__sleep0', lambda _sleep: _sleep0)
    tasks = importlib.import_module('asyncio.tasks')
    replace_within(tasks.as_completed, _completing)
    if sys.version_info < (3, 11):  # later it takes no coroutines
        replace_within(tasks.wait, _waiting)
    if sys.version_info >= (3, 12):  # so that a thread waits for a child, as before
        replace('asyncio.unix_events.can_use_pidfd', lambda _can: lambda: False)


# --- the loop's clock -----------------------------------------------------------------------------------------------


def _telling_time(machine: Callable[..., Any], clocks: Any) -> Callable[..., Any]:
    def time(self: Any) -> float:
        """Return the time of the loop's clock [s]: the program's time.monotonic."""
        selector = self.__dict__.get('_selector')
        if not told.is_ordered() and not (told.is_over() and getattr(selector, 'is_ordered', False)):
            return machine(self)
        frame = sys._getframe(1)
        now_ns = clocks.read(UPTIME, frame) if is_own(frame) else None
        return (clocks.now(UPTIME) if now_ns is None else now_ns) / NS_PER_S
    return time


class _When(float):
    """A timer's instant [s]. Of two equal instants the one that was made first comes first, as without lockstep."""

    __slots__ = ('number',)

    number: int

    def __lt__(self, other: float) -> bool:
        if float.__eq__(self, other):
            return self.number < getattr(other, 'number', -1)
        return float.__lt__(self, other)


def _in_order_of_creation(init: Callable[..., Any]) -> Callable[..., Any]:
    def init_in_order(self: Any, when: Any, *args: Any, **kwds: Any) -> None:
        if type(when) is float:
            when = _When(when)
            when.number = next(_numbers)
        init(self, when, *args, **kwds)
    return init_in_order


# --- the loop's wait ------------------------------------------------------------------------------------------------


def _making(init: Callable[..., Any], clocks: Any, take_part: Callable[..., Any]) -> Callable[..., Any]:
    def init_with_selector(self: Any, selector: Any = None) -> None:
        if selector is None:
            selector = importlib.import_module('selectors').DefaultSelector()
        frame = own_frame(sys._getframe(1))
        init(self, _Selector(selector, self, _place_of(frame), clocks, take_part))
    return init_with_selector


def _place_of(frame: Any) -> Optional[Tuple[str, int]]:
    return frame and (frame.f_code.co_filename, frame.f_lineno)


def _waking(write: Callable[..., Any]) -> Callable[..., Any]:
    def _write_to_self(self: Any) -> None:
        selector = self._selector
        if not isinstance(selector, _Selector) or not selector.wake():
            write(self)
    return _write_to_self


def _signalled(handle: Callable[..., Any]) -> Callable[..., Any]:
    def handle_signal(self: Any, number: int) -> None:
        if number not in _ENDS and isinstance(self._selector, _Selector):
            told.tell_place(self._selector.place, 'asyncio', '{} comes when it comes'.format(
                signal.Signals(number).name))
        handle(self, number)
    return handle_signal


class _Selector:
    """Stands in for a loop's selector."""

    def __init__(self, selector: Any, loop: Any, place: Any, clocks: Any,
                 take_part: Callable[..., Any]) -> None:
        self._selector = selector
        self._loop = loop
        self.place = place
        self._clocks, self._take_part = clocks, take_part
        self._own = None  # the loop's own end of a pair of sockets
        self._places: Dict[int, Optional[Tuple[str, int]]] = {}  # {descriptor: where it was registered}
        self._waiting = None  # the task of the thread that waits here
        self._watch: Any = None
        self.is_ordered = False
        self.has_yielded = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._selector, name)

    def register(self, fileobj: Any, events: int, data: Any = None) -> Any:
        """Register a file, as selectors.BaseSelector does."""
        key = self._selector.register(fileobj, events, data)
        if self._own is None:
            self._own = key.fd
        self._places[key.fd] = _place_of(own_frame(sys._getframe(1))) or self.place
        return key

    def select(self, timeout: Optional[float] = None) -> List[Tuple[Any, int]]:
        """Wait for a file, as selectors.BaseSelector does; the time-out [s] is simulated time."""
        participant = told.participant
        if participant is None:
            return self._before_node(timeout)
        scheduler = participant.scheduler
        if not scheduler.is_mine():
            return self._in_the_end(timeout) if self.is_ordered and told.is_over() else self._selector.select(timeout)
        self.is_ordered = True
        ready = self._selector.select(0)
        if not ready and (timeout is None or timeout > 0):
            return self._wait(scheduler, timeout)
        if self.has_yielded:
            self._look(scheduler)
        return self._told_of(ready)

    def _wait(self, scheduler: Scheduler, timeout: Optional[float]) -> List[Tuple[Any, int]]:
        wake_ns = NEVER if timeout is None else scheduler.now_ns + max(1, seconds_to_ns(timeout))
        self._waiting = scheduler.current()
        if self._has_outside:
            self._watch = self._watch or _Watch(self._selector, self._wake)
            self._watch.begin()
        try:
            scheduler.wait(wake_ns, _WAITS_FOR, WORK)
        except TurnLost:
            return self._in_the_end(timeout)
        finally:
            self._waiting = None
            if self._watch is not None:
                self._watch.end()
        return self._told_of(self._selector.select(0))

    @property
    def _has_outside(self) -> bool:
        """Whether something may come from outside of the program, by connections, pipes or signals."""
        return len(self._selector.get_map()) > 1 or bool(getattr(self._loop, '_signal_handlers', None))

    def _told_of(self, ready: List[Tuple[Any, int]]) -> List[Tuple[Any, int]]:
        for key, _events in ready:
            if key.fd != self._own:
                told.tell_place(self._places.get(key.fd), 'asyncio', _OUTSIDE)
        return ready

    def _look(self, scheduler: Scheduler) -> None:
        """Count a look: the loop goes round without waiting, because a task sleeps for 0 s, as with time.sleep(0)."""
        self.has_yielded = False
        step_ns = STEP_NS
        if self._loop._scheduled:
            step_ns = min(step_ns, max(1, seconds_to_ns(self._loop._scheduled[0].when() - self._loop.time())))
        scheduler.look(step_ns)

    def wake(self) -> bool:
        """Wake the loop for another thread; return False if the thread must write to the loop's socket, too."""
        participant = told.participant
        if participant is None or not self.is_ordered:
            return False
        if participant.scheduler.is_mine():
            self._wake()
            return True
        if not participant.scheduler.is_closed:
            participant.scheduler.from_outside(self._wake)
        return False

    def _wake(self) -> None:
        if self._waiting is not None:
            told.participant.scheduler.wake(self._waiting)

    def _before_node(self, timeout: Optional[float]) -> List[Tuple[Any, int]]:
        """Wait when the program does not take part yet: it takes part from here on, or waits in wall time."""
        if timeout and not self._has_outside and self._take_part('a wait of asyncio'):
            return self.select(timeout)
        ready = self._selector.select(timeout)
        if timeout and not ready and told.is_ordered():
            self._clocks.add_sleep(timeout)
        return ready

    def _in_the_end(self, timeout: Optional[float]) -> List[Tuple[Any, int]]:
        """Wait in wall time when lockstep is over and the node is about to end.

        :raises TurnLost: if nothing came, and there is no time-out.
        """
        until_shutdown()
        ready = self._selector.select(_LAST_WAIT if timeout is None else min(timeout, _LOOK_SECONDS))
        if not ready:
            if timeout is None:
                raise TurnLost('lockstep has ended while an event loop waited')
            self._clocks.add_sleep(timeout)
        return ready


class _Watch:
    """A thread that checks in wall time whether something has come from outside for a loop that waits."""

    def __init__(self, selector: Any, wake: Callable[..., Any]) -> None:
        self._selector, self._wake = selector, wake
        self._go = _make_lock()
        self._go.acquire()
        self._is_wanted = False
        threading.Thread(target=self._live, name='lockstep_event_loop', daemon=True).start()

    def begin(self) -> None:
        """Check from now on."""
        self._is_wanted = True
        try:
            self._go.release()
        except RuntimeError:
            pass  # it was released before

    def end(self) -> None:
        """Stop checking."""
        self._is_wanted = False

    def _live(self) -> None:
        while True:
            self._go.acquire()
            while self._is_wanted:
                try:
                    is_there = self._selector.select(_LOOK_SECONDS)
                except (OSError, ValueError, AttributeError, TypeError):
                    return  # the selector has been closed
                if is_there and self._is_wanted:
                    told.participant.scheduler.from_outside(self._wake)
                    break


# --- tasks ----------------------------------------------------------------------------------------------------------


def _numbered(kind: Any) -> Any:
    """Return a class of tasks or futures that hashes by number: asyncio cancels and counts them in the order of sets.

    Its objects also note their outcome.
    """
    return type(kind.__name__, (Numbered, kind), {
        '__slots__': (), '__module__': kind.__module__, '__qualname__': kind.__qualname__, '__doc__': kind.__doc__,
        **outcomes.methods_of(kind)})


@types.coroutine
def _sleep0() -> Iterator[None]:
    loop = sys.modules['asyncio.events']._get_running_loop()
    if isinstance(getattr(loop, '_selector', None), _Selector):
        loop._selector.has_yielded = True
    yield


def _completing(complete: Callable[..., Any]) -> Callable[..., Any]:
    def as_completed(fs: Sequence[Any], *args: Any, **kwds: Any) -> Iterator[Any]:
        return complete(_in_order(fs, kwds.get('loop'), sys._getframe(2)), *args, **kwds)
    return as_completed


def _waiting(wait: Any) -> Any:
    async def wait_for_all(fs: Any, *args: Any, **kwds: Any) -> Any:
        return await wait(_in_order(fs, kwds.get('loop'), sys._getframe(1)), *args, **kwds)
    return wait_for_all


def _in_order(some: Sequence[Any], loop: Any, frame: Any) -> Any:
    """Return tasks of coroutines in the order in which they are given. asyncio would first make a set of them."""
    tasks = sys.modules['asyncio.tasks']
    if isinstance(some, (set, frozenset)) and sum(map(tasks.coroutines.iscoroutine, some)) > 1:
        told.tell(own_frame(frame), 'asyncio', _BY_ADDRESS)
    is_one = tasks.futures.isfuture(some) or tasks.coroutines.iscoroutine(some)
    if is_one or not hasattr(some, '__iter__'):
        return some  # which is an error
    return [tasks.ensure_future(one, loop=loop) for one in dict.fromkeys(some)]
