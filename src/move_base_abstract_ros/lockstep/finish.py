"""The end of a process that takes part: it leaves in its last round, not at some moment of the wall clock."""
import threading

from move_base_abstract.lockstep.scheduler import TurnLost


def install(participant):
    """Leave in an orderly way when the main thread has come to its end."""
    shut_down = threading._shutdown

    def _shutdown():
        """Python calls this when the main thread has ended, and waits in it for threads that are no daemons."""
        _await_others(participant)
        shut_down()

    threading._shutdown = _shutdown


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
    except TurnLost:
        pass
