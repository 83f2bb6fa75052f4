"""Decides what a thread that waits without end waits for: something that is owed to it, or work that may come.

An answer, a message, a lock and the outcome of a job are owed. If nothing is left to happen in the run, a thread that
waits for one of them is stuck. The next job in a queue, a notification of a condition and an event may never come, so
such a thread is idle. A callback that waits is in the middle of its work, so something is owed to it in any case.

The decision depends on which function of Python's library waits for the lock. This module knows no ROS.
"""
from __future__ import annotations

import queue
import sys
import threading
from typing import TYPE_CHECKING, Any, List, Optional, Tuple

if TYPE_CHECKING:
    from types import FrameType

    from .task import Task

#: the kinds of waits; a wait for the end of a thread has that thread's task as its kind
OWED, WORK = 'owed', 'work'
_CONDITION = threading.Condition.wait.__code__
_SEMAPHORE = threading.Semaphore.acquire.__code__
#: functions that only hand on a wait for a condition
_BETWEEN = (_CONDITION, threading.Condition.wait_for.__code__, threading.Event.wait.__code__)
_QUEUE = queue.__name__
#: modules that stand in for Python's and rospy's
_OURS = (__name__.rpartition('.')[0] + '.', 'move_base_abstract_ros.lockstep.')
#: modules whose waits are for something that other threads owe: permits, barriers, outcomes of jobs
_FOR_THREADS = (threading.__name__, 'concurrent.futures._base', 'multiprocessing.pool')


def of_lock(depth: int = 1) -> Tuple[str, str]:
    """Return (kind, text) of a wait for a lock by the caller ``depth`` frames above the calling function."""
    frame: Any = sys._getframe(depth + 1)
    if frame.f_code is not _CONDITION:
        return OWED, 'another thread{}'.format(_place(frame))
    while frame.f_code in _BETWEEN:
        frame = frame.f_back
    if frame.f_code is _SEMAPHORE and _module(frame.f_back) == _QUEUE:
        frame = frame.f_back  # queue.SimpleQueue is made of a semaphore
    module, name = _module(frame), frame.f_code.co_name
    if module == _QUEUE:
        return (WORK if name == 'get' else OWED), 'another thread, in queue.{}(){}'.format(name, _place(frame))
    kind = OWED if module in _FOR_THREADS else WORK
    return kind, 'another thread, by a condition or an event{}'.format(_place(frame))


def _module(frame: FrameType) -> Any:
    return frame.f_globals.get('__name__')


def _place(frame: Optional[FrameType]) -> str:
    """Return the place where the program waits: the first one outside of Python's thread modules and of ours."""
    while frame is not None and (_module(frame) in (_QUEUE, *_FOR_THREADS, 'concurrent.futures.thread')
                                 or str(_module(frame)).startswith(_OURS)):
        frame = frame.f_back
    return '' if frame is None else ' ({}, line {})'.format(frame.f_code.co_filename, frame.f_lineno)


def split(tasks: List[Task]) -> Tuple[List[Task], List[Task]]:
    """Split tasks that wait without end: return (those to which something is owed, those that wait for work)."""
    owed = [task for task in tasks if _is_owed(task)]
    return owed, [task for task in tasks if task not in owed]


def _is_owed(task: Task) -> bool:
    """Return whether something is owed to a task, as always to a worker, which waits within a callback.

    If the task waits for the end of a thread, the wait of that thread decides. If threads wait for each other's end,
    they are stuck, so something is owed to them.
    """
    chain = [task]
    while isinstance(chain[-1].kind, type(task)):
        if chain[-1].kind in chain:
            return True
        chain.append(chain[-1].kind)
    return task.is_worker or chain[-1].kind == OWED
