"""Failed jobs whose outcome the program never asks for: futures, results of pools of threads, asyncio's tasks.

The exception of such a job waits in its future until the program asks for it. If it never does, Python says nothing, or
says it when the future is gone. Most outcomes are asked for later. So the event log says ``unasked`` at the end of a
round in which an exception still waits, and ``asked`` as soon as the program has asked. An exception that was not asked
for until the end of the run counts as uncaught (``runs.ends``).
"""
from __future__ import annotations

import weakref
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Callable, Dict, Mapping, Optional, Tuple

import rospy

from move_base_abstract.runs.failures import ASKED, UNASKED

from ...replacing.replaced import replace
from ..code.imports import when_imported
from . import uncaught

if TYPE_CHECKING:
    from ..participation.taking_part import Participant

_JOB, _TASK = 'a job whose outcome was never asked for', 'a task whose outcome was never asked for'
_MOST_OPEN = 1000  # older ones stay ``unasked`` in the log: it is not checked any more whether the program asks
_state = SimpleNamespace(participant=None, count=0, open=[])


class _Outcome:
    """An exception that waits in its future. ``is_asked`` says whether the program has asked for it."""

    def __init__(self, error: Any, what: str) -> None:
        self.error_name, self.where = type(error).__name__, '{}, {}'.format(what, uncaught.place_of(error))
        self.is_asked = False
        self.number = None  # its number in the event log

    def look(self) -> None:
        """Check whether the program has asked, for kinds of jobs that do not say so by themselves."""


class _OfTask(_Outcome):
    """The outcome of a task of asyncio. Python itself notes whether it was asked for.

    When a task is gone without that, Python calls the loop's exception handler, which sets ``is_lost``.
    """

    def __init__(self, task: Any, error: Any) -> None:
        super().__init__(error, _TASK)
        self._task = weakref.ref(task)
        self.is_lost = False

    def look(self) -> None:
        task = self._task()
        if not self.is_lost:
            self.is_asked = not task._log_traceback if task is not None else True


def install(participant: Participant) -> None:
    """Log from now on the outcomes of failed jobs that the program does not ask for."""
    _state.participant = participant
    participant.last_words.append(_tell)
    when_imported('concurrent.futures._base', _follow_futures)
    when_imported('multiprocessing.pool', _follow_pools)


def _note(outcome: _Outcome) -> None:
    participant = _state.participant
    if participant is not None and not participant.scheduler.is_closed and not rospy.core.is_shutdown_requested():
        _state.open.append(outcome)


def _tell() -> None:
    """Log, at the end of a round, the outcomes that wait, and those that were asked for since."""
    if not _state.open:  # as in nearly all rounds
        return
    participant = _state.participant
    for one in list(_state.open):
        one.look()
        if one.is_asked:
            _state.open.remove(one)
            if one.number is not None:
                participant.log(rospy.get_name(), ASKED, [one.number])
        elif one.number is None:
            _state.count += 1
            one.number = _state.count
            participant.log(rospy.get_name(), UNASKED, [one.number, one.error_name, one.where])
    del _state.open[:-_MOST_OPEN]


# --- futures and pools ----------------------------------------------------------------------------------------------


def _follow_futures() -> None:
    replace('concurrent.futures._base.Future.set_exception', _setting)
    for name in ('result', 'exception'):
        replace('concurrent.futures._base.Future.' + name, _asking)
    replace('concurrent.futures._base.Future.add_done_callback', _calling_back)


def _keep(job: Any, error: Any) -> None:
    if uncaught.is_failure(error):
        job._lockstep_outcome = outcome = _Outcome(error, _JOB)
        _note(outcome)


def _setting(set_exception: Callable[..., Any]) -> Callable[..., Any]:
    def _set_exception(self: Any, exception: Any) -> None:
        if exception is not None:
            _keep(self, exception)
        set_exception(self, exception)
    return _set_exception


def _asking(ask: Callable[..., Any]) -> Callable[..., Any]:
    def _ask(self: Any, timeout: Optional[float] = None) -> Any:
        try:
            return ask(self, timeout)
        finally:
            outcome = self.__dict__.get('_lockstep_outcome')
            if outcome is not None:
                outcome.is_asked = True
    return _ask


def _calling_back(add_done_callback: Callable[..., Any]) -> Callable[..., Any]:
    def _add_done_callback(self: Any, fn: Callable[..., Any]) -> None:
        add_done_callback(self, uncaught.told(fn, "a job's done callback"))
    return _add_done_callback


def _follow_pools() -> None:
    for name in ('ApplyResult', 'MapResult'):
        replace('multiprocessing.pool.{}._set'.format(name), _setting_result)
    replace('multiprocessing.pool.ApplyResult.get', _asking)
    for name in ('IMapIterator', 'IMapUnorderedIterator'):
        replace('multiprocessing.pool.{}._set'.format(name), _setting_item)
    for name in ('next', '__next__'):
        replace('multiprocessing.pool.IMapIterator.' + name, _taking)


def _setting_result(set_result: Callable[..., Any]) -> Callable[..., Any]:
    def _set(self: Any, i: int, obj: Tuple[bool, Any]) -> None:
        is_success, value = obj
        if not is_success and self._error_callback is None and not hasattr(self, '_lockstep_outcome'):
            _keep(self, value)
        set_result(self, i, obj)
    return _set


def _setting_item(set_item: Callable[..., Any]) -> Callable[..., Any]:
    def _set(self: Any, i: int, obj: Tuple[bool, Any]) -> None:
        is_success, value = obj
        if not is_success and uncaught.is_failure(value):
            value._lockstep_outcome = outcome = _Outcome(value, _JOB)
            _note(outcome)
        set_item(self, i, obj)
    return _set


def _taking(take: Callable[..., Any]) -> Callable[..., Any]:
    """Return the method that takes the next item: if it raises the exception of a job, that was asked for."""
    def _next(self: Any, *args: Any, **kwds: Any) -> Any:
        try:
            return take(self, *args, **kwds)
        except BaseException as error:
            outcome = getattr(error, '_lockstep_outcome', None)
            if outcome is not None:
                outcome.is_asked = True
            raise
    return _next


# --- tasks of asyncio -----------------------------------------------------------------------------------------------


def follow_tasks() -> None:
    """Follow what asyncio's loops report about uncaught exceptions."""
    replace('asyncio.base_events.BaseEventLoop.default_exception_handler', _handling)
    replace('asyncio.tasks._GatheringFuture.set_exception', _setting_of_many)


def _handling(handle: Callable[..., Any]) -> Callable[..., Any]:
    def default_exception_handler(self: Any, context: Mapping[str, Any]) -> None:
        error = context.get('exception')
        outcome = getattr(error, '_lockstep_outcome', None)
        if outcome is not None:
            outcome.is_lost, outcome.is_asked = True, False
        elif error is not None:
            uncaught.tell(error, 'a callback of its event loop')
        handle(self, context)
    return default_exception_handler


def _setting_of_many(set_exception: Any) -> Callable[..., Any]:
    """Return a new ``set_exception`` of gather()'s future. It has asked its tasks, and is asked in their place."""
    def _set_exception(self: Any, exception: Any) -> None:
        set_exception(self, exception)
        _ended(self)
    return _set_exception


def methods_of(kind: Any) -> Dict[str, Callable[..., Any]]:
    """Return the methods by which a class of asyncio's tasks or futures notes its outcome."""
    if not hasattr(kind, 'get_coro'):
        def set_exception(self: Any, exception: Any) -> None:
            kind.set_exception(self, exception)
            _ended(self)
        return {'set_exception': set_exception}

    def init(self: Any, *args: Any, **kwds: Any) -> None:
        kind.__init__(self, *args, **kwds)
        self.add_done_callback(_ended)
    return {'__init__': init}


def _ended(task: Any) -> None:
    """Note the exception of an ended task, unless the program has given its loop an exception handler of its own."""
    error: Any = None if task.cancelled() else task._exception
    if not uncaught.is_failure(error) or task.get_loop().get_exception_handler() is not None:
        return
    before = getattr(error, '_lockstep_outcome', None)  # that of a task for which this one has waited
    if before is not None:
        before.look()
    if before is None or before.is_asked:
        error._lockstep_outcome = outcome = _OfTask(task, error)
        _note(outcome)
