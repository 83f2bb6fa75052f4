"""Two waits of rospy, at a node's start and at its end, that last longer than what they wait for.

rospy.init_node looks every tenth of a second whether the ROS master knows the node, which takes a hundredth; and the
thread that registers topics is told of the end just before there is one, so that it sleeps for half a second more.
"""
import threading
import time

import rospy
import rospy.core

from .replaced import replace

_LOOK_S = 0.001  # wall
_TRIES = 20
_sleep = time.sleep  # as it is before a launched program's is another one


class _Time:
    """The module time, but for a sleep that is never longer than a look."""

    def __getattr__(self, name):
        return getattr(time, name)

    @staticmethod
    def sleep(seconds):
        _sleep(min(seconds, _LOOK_S))


def shorten():
    """Have both last as long as they must, in this process. To be called before rospy.init_node."""
    replace('rospy.impl.init.time', lambda _module: _Time())
    rospy.core.add_shutdown_hook(_wake)


def _wake(_reason):
    """Have the threads that rospy waits for next see that it has shut down."""
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
