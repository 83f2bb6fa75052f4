"""Pools of Python's library: pools of threads take turns; pools of processes work while simulated time stands still.

The threads that manage a pool of processes wait for the processes in the kernel, and so do those that wait for
asyncio's children. They do not count as threads of the application. As long as such a pool has work to do, or such a
child works, this process reports nothing, so that results come at the instant at which they were asked for. (The run is
labelled all the same, because the processes take no part.)
"""
from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple

import rospy

from move_base_abstract.lockstep.open_waits import WORK
from move_base_abstract.lockstep.wire import NEVER

from ...replacing.replaced import replace

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

_OF_PROCESSES = ('concurrent.futures.process', 'multiprocessing.queues')
_POOL = 'multiprocessing.pool'
_OF_CHILDREN = 'asyncio.unix_events'  # each of its threads waits for a child
_LOOK_S, _LAST_WORDS_S, _LONGEST_S = 0.001, 0.05, 60.0  # wall
_sleep = time.sleep  # the real one, by the wall clock
#: of pools of processes: (managing thread, dict of the jobs that are not done)
_jobs: List[Tuple[Any, Dict[Any, Any]]] = []


def is_manager(thread: Any) -> bool:
    """Return whether a thread that is about to start manages a pool of processes. If so, follow the pool's jobs."""
    target: Any = getattr(thread, '_target', None)
    module = getattr(target, '__module__', None)
    is_manager_ = type(thread).__module__ in _OF_PROCESSES or module in (*_OF_PROCESSES, _OF_CHILDREN) or (
        module == _POOL and target.__name__.startswith('_handle_') and _has_pipes(thread))
    if is_manager_:
        _jobs.extend((thread, jobs) for jobs in _jobs_of(thread, module))
    return is_manager_


def _jobs_of(thread: Any, module: Any) -> List[Dict[Any, Any]]:
    """Return [dict of the jobs that are not done] of a managing thread; [] if another thread of the pool has it."""
    if hasattr(thread, 'pending_work_items'):
        return [thread.pending_work_items]
    if module == _OF_PROCESSES[0]:  # before Python 3.9
        return [thread._args[2]]
    if module == _OF_CHILDREN:
        return [{0: 'the end of a child'}]
    return [one for one in thread._args if isinstance(one, dict)]


def _has_pipes(thread: Any) -> bool:
    """Return whether a thread of a pool gets its work over pipes; one pipe of each pool only tells of changes."""
    pipes = sum(type(one).__module__ == 'multiprocessing.queues' for one in thread._args)
    return pipes > (thread._target.__name__ == '_handle_workers')


def await_results(scheduler: Scheduler) -> None:
    """If a pool of processes has work to do, wait in wall time until it has done some of it."""
    if not _jobs:
        return
    _jobs[:] = [(thread, jobs) for thread, jobs in _jobs if thread.is_alive()]
    if not _is_working():
        return
    if not _wait_by_the_wall(scheduler, _LONGEST_S, _is_working):
        rospy.logwarn('%s: a pool of processes, or a child of asyncio, has not said anything for %g s; simulated time '
                      'goes on without waiting for it', rospy.get_name(), _LONGEST_S)
        _jobs.clear()
    _wait_by_the_wall(scheduler, _LAST_WORDS_S, lambda: True)  # for a result that is off the list, and not here yet


def _is_working() -> bool:
    return any(jobs and thread.is_alive() for thread, jobs in _jobs)


def _wait_by_the_wall(scheduler: Scheduler, longest: float, condition: Callable[[], bool]) -> bool:
    """Wait in wall time, while a condition holds, until something comes from outside.

    Return False if that takes longer than ``longest`` [s, wall].
    """
    end = time.monotonic() + longest
    while condition() and not (scheduler.has_outside or rospy.core.is_shutdown_requested()):
        if time.monotonic() > end:
            return False
        _sleep(_LOOK_S)
    return True


def follow(thread: Any, scheduler: Scheduler) -> None:
    """Make a thread that manages a pool of threads wait for them like any other thread."""
    target = getattr(thread, '_target', None)
    if getattr(target, '__module__', None) == _POOL and not _state:
        _state.append(True)
        replace('multiprocessing.pool.Pool._wait_for_updates', lambda wait: staticmethod(_waiting(scheduler, wait)))


_state: List[Any] = []


def _waiting(scheduler: Scheduler, wait: Callable[..., Any]) -> Callable[..., Any]:
    def wait_for_updates(sentinels: Sequence[Any], change_notifier: Any, timeout: Optional[float] = None) -> None:
        if not scheduler.is_mine():
            wait(sentinels, change_notifier, timeout)
            return
        scheduler.wait_until(lambda: not change_notifier.empty(), NEVER, 'the threads of a pool', WORK)
        while not change_notifier.empty():
            change_notifier.get()
    return wait_for_updates
