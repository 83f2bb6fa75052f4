"""A process that a participant forks (multiprocessing, os.fork) takes no part, and must not speak for its parent.

It ends by SIGTERM, as any process does that handles no signals. rospy's handler, which it would inherit, does not end a
process: `with multiprocessing.Pool()` ends its workers so, and now and then would wait for them for ever (without
lockstep, too), and the run with it.
"""
import os
import signal
import threading

import rospy.core


def install(participant):
    """Have a child let go of the connection, and of rospy's signal handler; its parent's go on."""
    before = threading.local()

    def hold():
        before.mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})

    def go_on():
        signal.pthread_sigmask(signal.SIG_SETMASK, before.mask)

    def let_go():
        participant.scheduler.abandon()
        participant.connection.forget()
        if getattr(signal.getsignal(signal.SIGTERM), '__module__', None) == rospy.core.__name__:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        go_on()  # a signal that came meanwhile ends the child

    os.register_at_fork(before=hold, after_in_parent=go_on, after_in_child=let_go)
