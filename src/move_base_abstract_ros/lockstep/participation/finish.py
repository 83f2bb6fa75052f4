"""The end of a process that takes part: it leaves in its last round, not at some moment of the wall clock.

When it has lost the run it ends with an error, whatever its main thread returns. Threads that only wait for what comes
no more do not keep it alive.
"""
import atexit
import logging
import os
import select
import sys
import threading
from types import SimpleNamespace

import rospy

from move_base_abstract.lockstep.scheduler import TurnLost

from ...process.process_end import leave
from ...replacing.replaced import replace
from ..failing import uncaught
from ..waiting.waits import replace_within

_OWN_SIGNAL_SECONDS = 1.0  # wall; who ends all processes may have ended the time master first
_STUCK_SECONDS = 5.0  # wall
_LOOK_SECONDS = 0.25  # wall
#: where a thread is that waits for others, in the innermost of its functions
_WAITING = ('threading.py', 'queue.py', 'locks.py', 'scheduler.py', 'waits.py', 'watchdog.py', 'finish.py')
_REPLACED = 'new node registered with same name'
#: the exit code, where it is not what the program says; whether it is known that the node ends
_state = SimpleNamespace(code=None, ending=None, is_watched=False)

#: reasons that rospy gives for the end of a node, of a signal; the program's own thread may have the turn
_INTERRUPTS = ('signal-', 'keyboard interrupt')


def install(participant):
    """Leave in an orderly way when the main thread has come to its end."""
    def shutdown(original):
        def _shutdown():
            """Python calls this when the main thread has ended, and waits in it for threads that are no daemons."""
            _end_executors()
            _await_others(participant)
            original()
        return _shutdown

    def excepthook(original):
        def _excepthook(kind, error, trace):
            """That lockstep has ended is told once, and is no error of the application's."""
            if issubclass(kind, TurnLost) and _state.code is None:
                _state.code = 0  # the run is over, as wished, which is not an error of the program either
            if issubclass(kind, KeyboardInterrupt):
                participant.interrupted('keyboard interrupt')
            if not issubclass(kind, TurnLost):
                uncaught.tell(error, 'the main thread')
                original(kind, error, trace)
        return _excepthook

    def signal_shutdown(original):
        def _signal_shutdown(reason):
            if _REPLACED in str(reason):
                _fail('another node of its name has taken its place: {}'.format(reason))
            if str(reason).startswith(_INTERRUPTS) or not participant.scheduler.is_mine():
                participant.interrupted(str(reason))
            uncaught.follow_hooks()
            original(reason)
        return _signal_shutdown

    replace('threading._shutdown', shutdown)
    replace_within(rospy.core.signal_shutdown, signal_shutdown)
    replace('sys.excepthook', excepthook)


def end_node(reason, as_wished):
    """Shut the node down because the run is over for it; from any thread, and not in it.

    A run that is not over ``as_wished`` is an error, unless a signal ends this process at the same time.
    """
    _state.ending = threading.Thread(target=_end_node, args=(reason, as_wished), daemon=True)
    threading.Thread.start(_state.ending)


def _end_node(reason, as_wished):
    if not as_wished:
        _await_own_signal()
    if not rospy.core.is_shutdown_requested():
        if as_wished:
            rospy.loginfo('%s: %s', rospy.get_name(), reason)
        else:
            _fail(reason)
        rospy.signal_shutdown(reason)
    end_what_is_stuck()


def _await_own_signal():
    for _ in range(int(_OWN_SIGNAL_SECONDS / _LOOK_SECONDS)):
        if rospy.core.is_shutdown_requested():
            return
        select.select([], [], [], _LOOK_SECONDS)


def _fail(reason):
    _state.code = 1
    rospy.logfatal('%s: %s', rospy.get_name(), reason)


def exit_code():
    """Return with which code the process is to end, None if that is the program's to say."""
    if _state.ending is not None:
        _state.ending.join(_OWN_SIGNAL_SECONDS + _STUCK_SECONDS)
    return _state.code


@atexit.register
def _leave_with_code():
    """Python's own way knows no exit code any more at this point."""
    code = exit_code()
    if code is not None:
        logging.shutdown()
        leave(code)


def end_what_is_stuck():
    """End the process, from now on, when all that keeps it alive are threads that wait for others."""
    if not _state.is_watched:
        _state.is_watched = True
        threading.Thread.start(threading.Thread(target=_end_what_is_stuck, daemon=True))


def _end_what_is_stuck():
    looks = 0
    while looks * _LOOK_SECONDS < _STUCK_SECONDS:
        select.select([], [], [], _LOOK_SECONDS)
        alive, waiting = _waiting()
        looks = looks + 1 if alive == waiting and rospy.core.is_shutdown() else 0
    logging.shutdown()
    leave(1, '{}: lockstep is over, and for {:g} s only threads that wait for others have kept the process alive; it '
          'is ended: {}'.format(rospy.get_name(), _STUCK_SECONDS, ', '.join(waiting)))


def _waiting():
    """Return the threads that keep the process alive, and those of them that wait, by their names and places."""
    frames = sys._current_frames()
    alive, waiting = [], []
    for thread in threading.enumerate():
        inner = frames.get(thread.ident)
        frame = inner
        while frame is not None and os.path.basename(frame.f_code.co_filename) in _WAITING:
            frame = frame.f_back
        if thread.daemon or frame is None:  # the main thread, when it has ended, waits for the others
            continue
        alive.append('{} ({}, line {})'.format(thread.name, frame.f_code.co_filename, frame.f_lineno))
        if frame is not inner:
            waiting.append(alive[-1])
    return alive, waiting


def _end_executors():
    """Call what Python calls first at the end: it tells the threads of executors, which wait for work, to end."""
    hooks = getattr(threading, '_threading_atexits', [])
    while hooks:
        try:
            hooks.pop()()
        except TurnLost:
            pass


def _await_others(participant):
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
