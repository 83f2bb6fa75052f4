"""The end of a participant's process. It leaves in its last round, not at some moment of the wall clock.

If it has lost the run, it ends with an error, whatever its main thread returns. Threads that only wait for others do
not keep it alive.
"""
from __future__ import annotations

import atexit
import dis
import logging
import os
import select
import signal
import sys
import threading
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Callable, List, NoReturn, Optional, Tuple, Type

import rospy

from move_base_abstract.common.lasting_output import drop_unread_outputs
from move_base_abstract.lockstep.task import TurnLost

from ...process.process_end import leave
from ...replacing.replaced import replace
from ..failing import uncaught
from ..failing.tracebacks import hide_ours
from ..waiting.waits import replace_within

if TYPE_CHECKING:
    from .taking_part import Participant

_OWN_SIGNAL_SECONDS = 1.0  # wall; a program that ends all processes may have ended the time master before this one
_STUCK_SECONDS = 5.0  # wall
_LOOK_SECONDS = 0.25  # wall
#: files of the innermost functions of a thread that waits for others
_WAITING = ('threading.py', 'queue.py', 'locks.py', 'scheduler.py', 'waits.py', 'watchdog.py', 'finish.py')
_REPLACED = 'new node registered with same name'
#: code: the exit code, None for the program's own; ending: the thread that ends the node; is_watched: whether
#: :func:`end_what_is_stuck` was called; is_told_of_ends: whether :func:`watch_ends` was; participant: the one of the
#: process ``pid``
_state = SimpleNamespace(code=None, ending=None, is_watched=False, is_told_of_ends=False, participant=None, pid=None)

#: reasons that rospy gives if a signal ends the node; the program's own thread may have the turn then
_INTERRUPTS = ('signal-', 'keyboard interrupt')


def install(participant: Participant) -> None:
    """Make the process leave the run in an orderly way when its main thread has ended."""
    def shutdown(original: Callable[..., Any]) -> Callable[..., Any]:
        def _shutdown() -> None:
            """Wait for the application's threads. Python calls this when the main thread has ended."""
            _end_executors()
            _await_others(participant)
            original()
        return _shutdown

    def excepthook(original: Callable[..., Any]) -> Callable[..., Any]:
        def _excepthook(kind: Type[BaseException], error: BaseException, trace: Any) -> None:
            """Show an uncaught error, but not TurnLost: the end of lockstep is no error of the application."""
            if issubclass(kind, TurnLost) and _state.code is None:
                _state.code = 0  # the run is over, as wished, and that is no error of the program either
            if issubclass(kind, KeyboardInterrupt) and not _is_raised_by_program(error):
                participant.interrupted('keyboard interrupt')
            if not issubclass(kind, TurnLost):
                uncaught.tell(error, 'the main thread')
                hide_ours(error)
                original(kind, error, error.__traceback__)
        return _excepthook

    def signal_shutdown(original: Callable[..., Any]) -> Callable[..., Any]:
        def _signal_shutdown(reason: str) -> None:
            drop_unread_outputs()
            if _REPLACED in str(reason):
                _state.code = 1
                rospy.logfatal('%s: another node of its name has taken its place: %s', rospy.get_name(), reason)
            if str(reason).startswith(_INTERRUPTS) or not participant.scheduler.is_mine():
                participant.interrupted(str(reason))
            uncaught.follow_hooks()
            original(reason)
        return _signal_shutdown

    _state.participant, _state.pid = participant, os.getpid()
    watch_ends()
    replace('threading._shutdown', shutdown)
    replace_within(rospy.core.signal_shutdown, signal_shutdown)
    replace('sys.excepthook', excepthook)


def _is_raised_by_program(error: Optional[BaseException]) -> bool:
    """Return whether a KeyboardInterrupt is from a ``raise`` of the program, and not from a handler of a signal."""
    if error is None or not isinstance(error, KeyboardInterrupt):
        return error is None or _is_raised_by_program(error.__context__)
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    own = [getattr(getattr(handler, '__func__', handler), '__code__', None) for handler in handlers if callable(handler)
           and handler is not signal.default_int_handler]
    trace, codes = error.__traceback__, []
    at = -1
    while trace is not None:
        codes.append(trace.tb_frame.f_code)
        at, trace = trace.tb_lasti, trace.tb_next
    if not codes or None in own or any(code in own for code in codes):
        return False
    return dis.opname[codes[-1].co_code[at]] == 'RAISE_VARARGS' and _is_raised_by_program(error.__context__)


def watch_ends() -> None:
    """Tell the time master before the process ends itself at once, so that it is not taken for one that is killed.

    The program's own lines come after this, since it may import the functions by their names.
    """
    if not _state.is_told_of_ends:
        _state.is_told_of_ends = True
        replace('os._exit', _exiting_at_once)
        replace('os.kill', _killing)


def _exiting_at_once(original: Callable[[int], NoReturn]) -> Callable[[int], NoReturn]:
    def _exit(status: int) -> NoReturn:
        """End the process without clean-up; what the program has published before is heard all the same."""
        participant = _participant_here()
        if participant is not None and participant.scheduler.is_mine():
            participant.leave('os._exit')
        elif participant is not None:
            participant.crashing()
        original(status)
    return _exit


def _killing(original: Callable[[int, int], None]) -> Callable[[int, int], None]:
    def kill(pid: int, number: int) -> None:
        participant = _participant_here()
        if participant is not None and (pid, number) == (os.getpid(), signal.SIGKILL):
            participant.crashing()
        original(pid, number)
    return kill


def _participant_here() -> Optional[Participant]:
    """Return the participant, None in a child that was forked, and before the process takes part."""
    return _state.participant if os.getpid() == _state.pid else None


def end_node(reason: str, as_wished: bool) -> None:
    """Shut the node down, in another thread, because the run is over for it. For any thread.

    If the run is not over ``as_wished``, that is an error, unless a signal ends this process at the same time.
    """
    _state.ending = threading.Thread(target=_end_node, args=(reason, as_wished), name='lockstep_end', daemon=True)
    threading.Thread.start(_state.ending)


def _end_node(reason: str, as_wished: bool) -> None:
    if not as_wished:
        _await_own_signal()
    drop_unread_outputs()
    end_what_is_stuck()
    if not rospy.core.is_shutdown_requested():
        _state.code = _state.code if as_wished else 1
        rospy.signal_shutdown(reason)
        (rospy.loginfo if as_wished else rospy.logfatal)('%s: %s', rospy.get_name(), reason)


def _await_own_signal() -> None:
    for _ in range(int(_OWN_SIGNAL_SECONDS / _LOOK_SECONDS)):
        if rospy.core.is_shutdown_requested():
            return
        select.select([], [], [], _LOOK_SECONDS)


def exit_code() -> Optional[int]:
    """Return the code with which the process must end, or None for the program's own code."""
    if _state.ending is not None:
        _state.ending.join(_OWN_SIGNAL_SECONDS + _STUCK_SECONDS)
    return _state.code


@atexit.register
def _leave_with_code() -> None:
    """End the process with :func:`exit_code`, if there is one. Python itself cannot change its code at this point."""
    code = exit_code()
    if code is not None:
        logging.shutdown()
        leave(code)


def end_what_is_stuck() -> None:
    """Watch the process from now on, and end it when only threads that wait for others keep it alive."""
    if not _state.is_watched:
        _state.is_watched = True
        threading.Thread.start(threading.Thread(target=_end_what_is_stuck, name='lockstep_stuck', daemon=True))


def _end_what_is_stuck() -> None:
    looks = 0
    while looks * _LOOK_SECONDS < _STUCK_SECONDS:
        select.select([], [], [], _LOOK_SECONDS)
        alive, waiting = _waiting()
        looks = looks + 1 if alive == waiting and rospy.core.is_shutdown() else 0
    logging.shutdown()
    leave(1, '{}: lockstep is over, and for {:g} s only threads that wait for others have kept the process alive; it '
          'is ended: {}'.format(rospy.get_name(), _STUCK_SECONDS, ', '.join(waiting)))


def _waiting() -> Tuple[List[str], List[str]]:
    """Return (threads that keep the process alive, those of them that wait), each as a text with name and place."""
    frames = sys._current_frames()
    alive, waiting = [], []
    for thread in threading.enumerate():
        inner = frames.get(thread.ident or 0)
        frame = inner
        while frame is not None and os.path.basename(frame.f_code.co_filename) in _WAITING:
            frame = frame.f_back
        if thread.daemon or frame is None:  # the main thread waits for the others when it has ended
            continue
        alive.append('{} ({}, line {})'.format(thread.name, frame.f_code.co_filename, frame.f_lineno))
        if frame is not inner:
            waiting.append(alive[-1])
    return alive, waiting


def _end_executors() -> None:
    """Call the functions that Python calls first at its end. They end the threads of executors, which wait for work."""
    hooks = getattr(threading, '_threading_atexits', [])
    while hooks:
        try:
            hooks.pop()()
        except TurnLost:
            pass


def _await_others(participant: Participant) -> None:
    scheduler = participant.scheduler
    if not scheduler.is_mine():
        return
    main = scheduler.current()
    others = [thread for thread in threading.enumerate()
              if not thread.daemon and getattr(thread, '_lockstep_task', None) not in (None, main)]
    try:
        for thread in others:
            thread.join()
        participant.rounds.let_time_pass()
    except TurnLost:
        pass
