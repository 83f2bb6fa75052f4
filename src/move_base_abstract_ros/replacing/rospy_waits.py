"""Shorten two waits of rospy, at a node's start and at its end, which last longer than they must.

rospy.init_node checks every tenth of a second whether the ROS master knows the node, which takes a hundredth. And the
thread that registers topics is woken just before the end has come, so that it sleeps for half a second more.
"""
import threading
import time

import rospy
import rospy.core

from .replaced import replace

_LOOK_S = 0.001  # wall
_TRIES = 20
_sleep = time.sleep  # the real one, before the launcher replaces it for a program


class _Time:
    """The module time with another sleep, which never takes longer than 1 ms."""

    def __getattr__(self, name):
        return getattr(time, name)

    @staticmethod
    def sleep(seconds):
        _sleep(min(seconds, _LOOK_S))


def shorten():
    """Shorten both waits in this process. Call this before rospy.init_node."""
    replace('rospy.impl.init.time', lambda _module: _Time())
    rospy.core.add_shutdown_hook(_wake)


def _wake(_reason):
    """Wake the threads for which rospy waits next, so that they see that it has shut down."""
    for thread in list(rospy.core._shutdown_threads):
        condition = getattr(getattr(getattr(thread, '_target', None), '__self__', None), 'cond', None)
        if condition is None or thread is threading.current_thread():
            continue
        for _ in range(_TRIES):  # it may be just about to wait
            with condition:
                condition.notify_all()
            _sleep(_LOOK_S)  # no join, which may wait for simulated time
            if not thread.is_alive():
                break
