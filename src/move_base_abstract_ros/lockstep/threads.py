"""Threads of the application: one runs at a time, and Python's locks are known waits (R9).

A thread that the application starts waits for its first turn. ``threading.Lock`` and everything made of it (RLock,
Condition, Event, Semaphore, Barrier, Queue, joins) gives the turn away when an application thread must wait for
another; time-outs are simulated time. Threads of rospy itself use the same locks as ever.
"""
import queue
import threading
import time

from move_base_abstract.lockstep.locks import CooperativeLock, CooperativeRLock, Process, clock
from move_base_abstract.lockstep.scheduler import TurnLost
from move_base_abstract.lockstep.wire import NEVER

from .waits import to_ns

#: who is never a thread of the application
_FOREIGN = ('rospy.', 'rosgraph.', 'xmlrpc', 'socketserver', 'logging', 'move_base_abstract_ros.lockstep',
            'move_base_abstract_ros.outbox')
_OF_THE_APPLICATION = ('rospy.timer',)

def install(participant, own_threads):
    """Follow the application's threads; with ``own_threads`` its locks as well."""
    Process.scheduler = participant.scheduler
    if own_threads:
        replace_locks()
        _follow_threads(participant.scheduler)


def replace_locks():
    """Have the locks that are made from now on give the turn away; until the process takes part they are ordinary."""
    threading._allocate_lock = threading.Lock = CooperativeLock
    threading.RLock = CooperativeRLock
    queue.SimpleQueue = queue._PySimpleQueue
    threading._time = queue.time = clock(time.monotonic)


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
