"""The end of a process that takes part: it leaves in its last round, not at some moment of the wall clock."""
import threading

from move_base_abstract.lockstep.scheduler import TurnLost

from ..replaced import replace


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
            if not issubclass(kind, TurnLost):
                original(kind, error, trace)
        return _excepthook

    replace('threading._shutdown', shutdown)
    replace('sys.excepthook', excepthook)


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
        participant.let_time_pass()
    except TurnLost:
        pass
