"""An uncaught exception in a callback, a handler or a thread is an event of the run.

rospy, actionlib and Python itself show such an exception and go on, so that the process's exit code does not show it.
The event log does (``uncaught``), and the judgement on the run uses that (``runs.ends``). An exception that comes after
the node was told to end, or when the run is over, is no event.
"""
from __future__ import annotations

import logging
import os
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Callable, List

import rospy

from move_base_abstract.lockstep.task import TurnLost
from move_base_abstract.runs import error_lines
from move_base_abstract.runs.failures import FIRST_USE, UNCAUGHT, words_of

from ...replacing.replaced import replace
from ..code.own_code import is_library
from .tracebacks import hide_ours

if TYPE_CHECKING:
    from ..exchange.topics import Topics
    from ..participation.taking_part import Participant

_state = SimpleNamespace(participant=None)


def install(participant: Participant) -> None:
    """Write uncaught exceptions of this process into the event log from now on."""
    _state.participant = participant
    replace('rospy.topics._SubscriberImpl._invoke_callback', _invoking)
    replace('rospy.impl.tcpros_service.ServiceImpl.error_handler', _handling)
    replace('actionlib.simple_action_server.SimpleActionServer.__init__', _executing)
    for what in ('goal', 'preempt'):
        replace('actionlib.simple_action_server.SimpleActionServer.register_{}_callback'.format(what),
                lambda register, what=what: _registering(register, "an action's {} callback".format(what)))
    replace('threading.excepthook', _in_threads)
    replace('sys.unraisablehook', _ignored)


class _ErrorLines(logging.Handler):
    """Notes the ERROR and FATAL lines of a participant's turns, for the program that has started the run."""

    def __init__(self, participant: Participant) -> None:
        super().__init__(logging.ERROR)
        self._participant = participant

    def createLock(self) -> None:  # noqa: N802 - logging's name
        """Have none: one thread has the turn."""
        self.lock = None

    def emit(self, record: logging.LogRecord) -> None:
        """Note the line."""
        participant = self._participant
        if participant.scheduler.is_mine() and not participant.is_told_to_end:
            error_lines.note(participant.members.own_name, record.levelno > logging.ERROR, record.getMessage())


def note_lines(participant: Participant) -> None:
    """Note ERROR and FATAL lines from now on. Call this after ``rospy.init_node``, which makes all log settings."""
    logging.getLogger('rosout').addHandler(_ErrorLines(participant))


def tell(error: Any, where: str) -> None:
    """Log the uncaught exception ``error``, once; ``where`` is a text for what was called."""
    if not rospy.core.is_shutdown_requested():
        _tell(error, where)


def _tell_last(error: Any, where: str) -> None:
    """Log an uncaught exception of a function that is called when the node ends by itself.

    Many programs write their results in such a function.
    """
    if not (_state.participant.is_told_to_end or isinstance(error, rospy.ROSInterruptException)):
        _tell(error, where)


def _tell(error: Any, where: str) -> None:
    participant = _state.participant
    if participant is None or participant.scheduler.is_closed:
        return
    if not is_failure(error) or hasattr(error, '_lockstep_told'):
        return
    error._lockstep_told = True
    participant.log(rospy.get_name(), UNCAUGHT, [
        type(error).__name__, '{}, {}'.format(where, place_of(error)), *_of_first_use(error, participant.topics)])


def _of_first_use(error: Any, topics: Topics) -> List[str]:
    """Return [a text] if the program may have failed because it asks for what it only begins to listen to.

    tf2 says that it knows no transform; of any other topic a program still has the None of its beginning.
    """
    since_now = topics.listens_since_now()
    if any((kind.__module__, kind.__name__) == ('tf2', 'TransformException') for kind in type(error).__mro__):
        found = [name for name in since_now if name == '/tf']
    elif isinstance(error, (AttributeError, TypeError)) and "'NoneType'" in str(error):
        found = [name for name in since_now if not topics.has_heard(name)]
    else:
        found = []
    return [FIRST_USE.format('began', ' and '.join(found))] if found else []


def is_failure(error: Any) -> bool:
    """Return whether an uncaught exception is a failure of the program, and not just the end of the run or of a job.

    ``sys.exit`` with an error is a failure: outside of the main thread it ends a callback and not the program. An
    exception of a class that is derived from ``BaseException`` alone is a failure, too.
    """
    if isinstance(error, SystemExit):
        return error.code not in (None, 0)
    return isinstance(error, BaseException) and not isinstance(error, (TurnLost, KeyboardInterrupt))


def place_of(error: Any) -> str:
    """Return 'FILE, line N' of the innermost place in an exception's traceback; the program's own code comes first."""
    found, trace = None, error.__traceback__
    while trace is not None:
        filename = trace.tb_frame.f_code.co_filename
        if filename != __file__ and (found is None or not is_library(filename) or is_library(found[0])):
            found = (filename, trace.tb_lineno)
        trace = trace.tb_next
    return '{}, line {}'.format(os.path.basename(found[0]), found[1]) if found else 'an unknown place'


class _Again:
    """Stands in for a callback that has failed: rospy calls it, and shows the error under the callback's own name."""

    def __init__(self, callback: Callable[..., Any], error: Any) -> None:
        self._callback = callback
        self._error = error

    def __call__(self, *_: Any) -> None:
        raise self._error.with_traceback(self._error.__traceback__.tb_next)  # where the callback begins

    def __str__(self) -> str:
        return str(self._callback)


def _invoking(invoke_callback: Callable[..., Any]) -> Callable[..., Any]:
    def _invoke_callback(self: Any, message: Any, callback: Callable[..., Any], arguments: Any) -> None:
        try:
            if arguments is None:
                callback(message)
            else:
                callback(message, arguments)
        except (Exception, SystemExit) as error:
            tell(error, 'a callback of {}'.format(self.resolved_name))
            invoke_callback(self, message, _Again(callback, error), arguments)
    return _invoke_callback


def _handling(error_handler: Callable[..., Any]) -> Callable[..., Any]:
    def _error_handler(self: Any, error: Any, *about: Any) -> None:
        tell(error, 'the handler of service {}'.format(self.resolved_name))
        error_handler(self, error, *about)
    return _error_handler


def _executing(init: Callable[..., Any]) -> Callable[..., Any]:
    def _init(self: Any, *args: Any, **kwds: Any) -> None:
        init(self, *args, **kwds)
        if self.execute_callback:
            self.execute_callback = told(self.execute_callback, "an action's execute callback")
    return _init


def _registering(register: Callable[..., Any], where: str) -> Callable[..., Any]:
    def _register(self: Any, cb: Callable[..., Any]) -> None:
        register(self, None if cb is None else told(cb, where))
    return _register


def told(function: Callable[..., Any], where: str, tell_it: Callable[..., Any] = tell) -> Callable[..., Any]:
    """Return a function that calls ``function`` and logs an exception that leaves it; ``where`` is a text for it."""
    def call(*args: Any) -> Any:
        try:
            return function(*args)
        except BaseException as error:
            tell_it(error, where)
            raise
    return call


def follow_hooks() -> None:
    """Log uncaught exceptions of the functions that rospy is about to call as the node shuts down."""
    hooks = rospy.core._client_shutdown_hooks
    hooks[:] = [told(hook, 'a function of rospy.on_shutdown', _tell_last) for hook in hooks]


def _ignored(hook: Callable[..., Any]) -> Callable[..., Any]:
    def unraisablehook(args: Any) -> None:
        about = args.err_msg or ''
        if 'atexit' in about:
            _tell_last(args.exc_value, 'a function of atexit')
        elif 'ctypes' in about:  # all others come from destructors
            tell(args.exc_value, 'a callback of a library in C')
        hook(args)
    return unraisablehook


def _in_threads(excepthook: Callable[..., Any]) -> Callable[..., Any]:
    def _excepthook(args: Any) -> None:
        if args.exc_value is not None:
            is_ours = getattr(args.thread, 'name', '').startswith('lockstep_')
            tell(args.exc_value, 'a callback' if is_ours else words_of(args.thread))
            hide_ours(args.exc_value)
        excepthook(args)
    return _excepthook


def run_of(thread: Any) -> Callable[..., Any]:
    """Return ``thread.run`` as a function that logs an uncaught exception while the thread still has its turn."""
    return told(thread.run, 'a callback of rospy.Timer' if isinstance(thread, rospy.Timer) else words_of(thread))
