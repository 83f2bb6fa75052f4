"""Sockets between processes of our own, which wait as long as it takes."""
import socket
from typing import Tuple


def pair() -> Tuple[socket.socket, socket.socket]:
    """Return two connected sockets without a time limit.

    A process may have set a time limit for all its new sockets; rospy sets 60 s with its first subscription. Python
    realises it by O_NONBLOCK, which the process that inherits a socket would get without knowing it.

    :raises OSError: if there are too many open files.
    """
    both = socket.socketpair()
    for one in both:
        one.settimeout(None)
    return both
