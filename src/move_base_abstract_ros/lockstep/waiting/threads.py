"""Threads of the application: one runs at a time, and lockstep knows their waits for Python's locks.

A thread that the application starts waits for its first turn. ``threading.Lock`` and everything made of it (RLock,
Condition, Event, Semaphore, Barrier, Queue, joins) gives the turn away when a thread of the application must wait for
another. Time-outs are simulated time. For rospy's own threads these locks are ordinary ones.
"""
from __future__ import annotations

import itertools
import queue
import sys
import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, Optional, Tuple

from move_base_abstract.lockstep.locks import CooperativeLock, CooperativeRLock, Process, clock
from move_base_abstract.lockstep.task import TurnLost
from move_base_abstract.lockstep.wire import NEVER

from ...replacing.replaced import replace
from ..code.callers import is_own, own_frame
from ..code.labels import told
from ..failing import uncaught
from . import pools
from .waits import to_ns

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler
    from move_base_abstract.lockstep.task import Task

    from ..participation.taking_part import Participant

#: modules whose threads, or threads that run their functions, are never the application's
_FOREIGN = ('rosgraph.', 'xmlrpc.', 'socketserver.', 'http.', 'logging.config.', 'move_base_abstract_ros.lockstep.',
            'move_base_abstract_ros.messages.outbox.')
#: modules that start rospy's own threads. (A thread of the application may run a function of rospy, as rospy.spin.)
_ROSPY = 'rospy.impl.'
_numbers = itertools.count(1)  # of threads without a name, in the names that Python gives to them


def install(participant: Participant, own_threads: bool) -> None:
    """Make locks use the scheduler of ``participant``; with ``own_threads``, replace locks and follow threads."""
    Process.scheduler = participant.scheduler
    _Watch.take_part = None  # rospy may start threads of its own before its participant is known to the labels
    if own_threads:
        replace_locks()
        _follow_threads(participant.scheduler)


def replace_locks() -> None:
    """Make locks that are made from now on give the turn away. Until the process takes part they are ordinary locks."""
    now = clock(time.monotonic)
    for name, stand_in in (('threading._allocate_lock', CooperativeLock), ('threading.Lock', CooperativeLock),
                           ('_thread.allocate_lock', CooperativeLock), ('_thread.allocate', CooperativeLock),
                           ('threading.RLock', CooperativeRLock),
                           ('queue.SimpleQueue', queue._PySimpleQueue),  # type: ignore[attr-defined]
                           ('threading._time', now), ('queue.time', now)):
        replace(name, lambda _original, stand_in=stand_in: stand_in)


def watch_start(take_part: Callable[..., Any]) -> None:
    """If a program starts a thread before it is a node, make it take part from there on, by ``take_part(what)``.

    If that is not possible, lockstep does not order the thread, and the run is labelled.
    """
    _Watch.take_part = take_part
    replace('threading.Thread.start', _starting_early)
    _follow_new_threads()  # the program may import the function by its name


class _Watch:
    """How a program takes part when it starts a thread before it is a node; None from then on."""

    take_part: Optional[Callable[[str], bool]] = None


def _starting_early(start: Callable[..., Any]) -> Callable[..., Any]:
    def _start(self: Any) -> None:
        take_part = _Watch.take_part
        frame = None if take_part is None else own_frame(sys._getframe(1))
        if take_part is None or frame is None or _is_foreign(self, ''):
            start(self)
        elif take_part('a thread'):
            threading.Thread.start(self)
        else:
            told.tell(frame, 'threading.Thread.start', 'starts a thread before rospy.init_node, which lockstep does '
                      'not order')
            start(self)
    return _start


def _follow_new_threads() -> None:
    for name in ('_thread.start_new_thread', '_thread.start_new'):
        replace(name, _starting_new)


def _follow_threads(scheduler: Scheduler) -> None:
    _follow_new_threads()
    replace('threading.Thread.start', lambda start: _starting(scheduler, start))
    replace('threading.Thread.join', lambda join: _joining(scheduler, join))
    replace('threading.Thread.is_alive', lambda is_alive: _looking(scheduler, is_alive))


def _starting(scheduler: Scheduler, start: Callable[..., Any]) -> Callable[..., Any]:
    def _start(self: Any) -> None:
        if scheduler.is_mine() and not _is_foreign(self, sys._getframe(1).f_globals.get('__name__', '')):
            pools.follow(self, scheduler)
            task = scheduler.spawn(self.name)
            self._lockstep_task = task
            self.run = _in_turn(scheduler, task, uncaught.run_of(self))
        scheduler.start_thread(start, self)
    return _start


def _starting_new(start_new_thread: Callable[..., Any]) -> Callable[..., Any]:
    def _start_new_thread(function: Callable[..., Any], args: Tuple[Any, ...],
                          kwargs: Optional[Dict[str, Any]] = None) -> Optional[int]:
        if not is_own(sys._getframe(1)):
            return start_new_thread(function, args, *([] if kwargs is None else [kwargs]))
        thread = threading.Thread(target=function, name='Dummy-{}'.format(next(_numbers)), args=args,
                                  kwargs=kwargs, daemon=True)
        thread.start()
        return thread.ident
    return _start_new_thread


def _joining(scheduler: Scheduler, join: Callable[..., Any]) -> Callable[..., Any]:
    def _join(self: Any, timeout: Optional[float] = None) -> None:
        task = getattr(self, '_lockstep_task', None)
        if task is None or not scheduler.is_mine():
            join(self, timeout)
            return
        wake_ns = NEVER if timeout is None else scheduler.now_ns + max(0, to_ns(timeout))
        if scheduler.wait_until(lambda: task.is_finished, wake_ns, 'the end of thread {}'.format(self.name), task):
            join(self)  # Python's own end of the thread takes a moment of wall time
    return _join


def _looking(scheduler: Scheduler, is_alive: Callable[..., Any]) -> Callable[..., Any]:
    def _is_alive(self: Any) -> bool:
        task = getattr(self, '_lockstep_task', None)
        return is_alive(self) if task is None or not scheduler.is_mine() else not task.is_finished
    return _is_alive


def _is_foreign(thread: Any, starter: str) -> bool:
    """Return whether a thread is not the application's; ``starter`` is the module that starts it."""
    target = getattr(thread, '_target', None)
    modules = (type(thread).__module__, getattr(target, '__module__', None) or '')
    is_foreign = starter.startswith(_ROSPY) or any((module + '.').startswith(_FOREIGN) for module in modules)
    return is_foreign or pools.is_manager(thread)


def _in_turn(scheduler: Scheduler, task: Task, run: Callable[..., Any]) -> Callable[..., Any]:
    def run_in_turn() -> None:
        scheduler.begin(task)
        try:
            run()
        except TurnLost:
            pass  # lockstep is over, and so the node ends
        finally:
            scheduler.finish()
    return run_in_turn
