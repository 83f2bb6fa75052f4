"""A process that a participant forks (multiprocessing, os.fork) does not take part, and must not speak for its parent.

SIGTERM ends it, like any process that handles no signals. Otherwise it would inherit rospy's handler, which ends no
process. ``with multiprocessing.Pool()`` ends its workers by SIGTERM: with rospy's handler it would sometimes wait for
them for ever (without lockstep, too), and the run with it.
"""
from __future__ import annotations

import os
import signal
import threading
from typing import TYPE_CHECKING

import rospy.core

if TYPE_CHECKING:
    from .taking_part import Participant


def install(participant: Participant) -> None:
    """Make a forked child drop the connection and rospy's signal handler; the parent keeps both."""
    before = threading.local()

    def hold() -> None:
        before.mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})

    def go_on() -> None:
        signal.pthread_sigmask(signal.SIG_SETMASK, before.mask)

    def let_go() -> None:
        participant.scheduler.abandon()
        participant.connection.forget()
        if getattr(signal.getsignal(signal.SIGTERM), '__module__', None) == rospy.core.__name__:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        go_on()  # a signal that came meanwhile ends the child

    os.register_at_fork(before=hold, after_in_parent=go_on, after_in_child=let_go)
