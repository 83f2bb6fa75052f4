"""Threads of the application: one runs at a time, and Python's locks are known waits.

A thread that the application starts waits for its first turn. ``threading.Lock`` and everything made of it (RLock,
Condition, Event, Semaphore, Barrier, Queue, joins) gives the turn away when an application thread must wait for
another; time-outs are simulated time. Threads of rospy itself use the same locks as ever.
"""
import itertools
import queue
import sys
import threading
import time

from move_base_abstract.lockstep.locks import CooperativeLock, CooperativeRLock, Process, clock
from move_base_abstract.lockstep.scheduler import TurnLost
from move_base_abstract.lockstep.wire import NEVER

from ...replacing.replaced import replace
from ..code.callers import is_own, own_frame
from ..code.labels import told
from ..failing import uncaught
from . import pools
from .waits import to_ns

#: where threads and their work are from that are never the application's
_FOREIGN = ('rosgraph.', 'xmlrpc.', 'socketserver.', 'http.', 'logging.', 'move_base_abstract_ros.lockstep.',
            'move_base_abstract_ros.messages.outbox.')
#: rospy's own threads are started here; rospy.spin, say, may well be the work of a thread of the application
_ROSPY = 'rospy.impl.'
_numbers = itertools.count(1)  # of threads without a name, which Python itself calls so


def install(participant, own_threads):
    """Follow the application's threads; with ``own_threads`` its locks as well."""
    Process.scheduler = participant.scheduler
    if own_threads:
        replace_locks()
        _follow_threads(participant.scheduler)


def replace_locks():
    """Have the locks that are made from now on give the turn away; until the process takes part they are ordinary."""
    now = clock(time.monotonic)
    for name, stand_in in (('threading._allocate_lock', CooperativeLock), ('threading.Lock', CooperativeLock),
                           ('threading.RLock', CooperativeRLock), ('queue.SimpleQueue', queue._PySimpleQueue),
                           ('threading._time', now), ('queue.time', now)):
        replace(name, lambda _original, stand_in=stand_in: stand_in)


def watch_start(take_part):
    """Have a program that starts a thread before it is a node take part from there on, by ``take_part(what)``.

    Where that is not possible, lockstep does not order the thread, which is told.
    """
    replace('threading.Thread.start', lambda start: _starting_early(start, take_part))


def _starting_early(start, take_part):
    def _start(self):
        frame = own_frame(sys._getframe(1)) if told.participant is None else None
        if frame is None or _is_foreign(self, ''):
            start(self)
        elif take_part('a thread'):
            threading.Thread.start(self)
        else:
            told.tell(frame, 'threading.Thread.start', 'starts a thread before rospy.init_node, which lockstep does '
                      'not order')
            start(self)
    return _start


def _follow_threads(scheduler):
    for name in ('_thread.start_new_thread', '_thread.start_new'):
        replace(name, _starting_new)
    replace('threading.Thread.start', lambda start: _starting(scheduler, start))
    replace('threading.Thread.join', lambda join: _joining(scheduler, join))
    replace('threading.Thread.is_alive', lambda is_alive: _looking(scheduler, is_alive))


def _starting(scheduler, start):
    def _start(self):
        if scheduler.is_mine() and not _is_foreign(self, sys._getframe(1).f_globals.get('__name__', '')):
            pools.follow(self, scheduler)
            task = scheduler.spawn(self.name)
            self._lockstep_task = task
            self.run = _in_turn(scheduler, task, uncaught.run_of(self))
        scheduler.start_thread(start, self)
    return _start


def _starting_new(start_new_thread):
    def _start_new_thread(function, args, kwargs=None):
        if not is_own(sys._getframe(1)):
            return start_new_thread(function, args, *([] if kwargs is None else [kwargs]))
        thread = threading.Thread(target=function, name='Dummy-{}'.format(next(_numbers)), args=args,
                                  kwargs=kwargs, daemon=True)
        thread.start()
        return thread.ident
    return _start_new_thread


def _joining(scheduler, join):
    def _join(self, timeout=None):
        task = getattr(self, '_lockstep_task', None)
        if task is None or not scheduler.is_mine():
            join(self, timeout)
            return
        wake_ns = NEVER if timeout is None else scheduler.now_ns + max(0, to_ns(timeout))
        if scheduler.wait_until(lambda: task.is_finished, wake_ns, 'the end of thread {}'.format(self.name), task):
            join(self)  # the rest of it, which is Python's, takes a moment of the wall clock
    return _join


def _looking(scheduler, is_alive):
    def _is_alive(self):
        task = getattr(self, '_lockstep_task', None)
        return is_alive(self) if task is None or not scheduler.is_mine() else not task.is_finished
    return _is_alive


def _is_foreign(thread, starter):
    """Return whether a thread is none of the application's; ``starter``: the module that starts it."""
    target = getattr(thread, '_target', None)
    modules = (type(thread).__module__, getattr(target, '__module__', None) or '')
    is_foreign = starter.startswith(_ROSPY) or any((module + '.').startswith(_FOREIGN) for module in modules)
    return is_foreign or pools.is_manager(thread)


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
