"""What a thread that waits without end waits for: something that is owed to it, or work that may come.

An answer, a message, a lock, the outcome of a job are owed: if nothing is left to happen in the run, whoever waits for
such a thing is stuck. The next job in a queue, a notification of a condition, an event may never be meant to come: the
thread is idle. A callback that waits is in the middle of its work, whatever it waits for.

Told by who in Python's library waits for the lock in question. Knows no ROS.
"""
from __future__ import annotations

import queue
import sys
import threading
from typing import TYPE_CHECKING, Any, List, Optional, Tuple

if TYPE_CHECKING:
    from types import FrameType

    from .task import Task

#: what a wait is for; the task of another thread stands for its end
OWED, WORK = 'owed', 'work'
_CONDITION = threading.Condition.wait.__code__
_SEMAPHORE = threading.Semaphore.acquire.__code__
#: what only hands on a wait for a condition
_BETWEEN = (_CONDITION, threading.Condition.wait_for.__code__, threading.Event.wait.__code__)
_QUEUE = queue.__name__
#: modules that stand in for Python's and rospy's
_OURS = (__name__.rpartition('.')[0] + '.', 'move_base_abstract_ros.lockstep.')
#: modules whose waits are for what other threads are about to do: permits, barriers, outcomes of jobs
_FOR_THREADS = (threading.__name__, 'concurrent.futures._base', 'multiprocessing.pool')


def of_lock(depth: int = 1) -> Tuple[str, str]:
    """Return (kind, text) of a wait for a lock, by the caller so many frames above."""
    frame: Any = sys._getframe(depth + 1)
    if frame.f_code is not _CONDITION:
        return OWED, 'another thread{}'.format(_place(frame))
    while frame.f_code in _BETWEEN:
        frame = frame.f_back
    if frame.f_code is _SEMAPHORE and _module(frame.f_back) == _QUEUE:
        frame = frame.f_back  # queue.SimpleQueue is made of one
    module, name = _module(frame), frame.f_code.co_name
    if module == _QUEUE:
        return (WORK if name == 'get' else OWED), 'another thread, in queue.{}(){}'.format(name, _place(frame))
    kind = OWED if module in _FOR_THREADS else WORK
    return kind, 'another thread, by a condition or an event{}'.format(_place(frame))


def _module(frame: FrameType) -> Any:
    return frame.f_globals.get('__name__')


def _place(frame: Optional[FrameType]) -> str:
    """Return where the program waits: the first place outside of Python's library for threads, and of ours."""
    while frame is not None and (_module(frame) in (_QUEUE, *_FOR_THREADS, 'concurrent.futures.thread')
                                 or str(_module(frame)).startswith(_OURS)):
        frame = frame.f_back
    return '' if frame is None else ' ({}, line {})'.format(frame.f_code.co_filename, frame.f_lineno)


def split(tasks: List[Task]) -> Tuple[List[Task], List[Task]]:
    """Return (those to whom something is owed, those who wait for work) of tasks that wait without end."""
    owed = [task for task in tasks if _is_owed(task)]
    return owed, [task for task in tasks if task not in owed]


def _is_owed(task: Task) -> bool:
    """Who waits for the end of a thread is owed what that one is; nobody ends where they wait for each other."""
    chain = [task]
    while isinstance(chain[-1].kind, type(task)):
        if chain[-1].kind in chain:
            return True
        chain.append(chain[-1].kind)
    return task.is_worker or chain[-1].kind == OWED
