"""Prepare rospy before a process of ours, or a program that the launcher starts, becomes a node.

rospy.init_node checks every tenth of a second whether the ROS master knows the node, which takes a hundredth. And the
thread that registers topics is woken just before the end has come, so that it sleeps for half a second more. Unless the
announced address is a loopback address, rospy listens on all addresses of the computer: then any other computer that
reaches this one can call a node's XML-RPC server, which shuts the node down if it is asked to.
"""
from __future__ import annotations

import os
import re
import socket
import threading
import time
from typing import Any, Callable, Optional

import rosgraph.network
import rospy
import rospy.core

from .replaced import replace

_LOOK_S = 0.001  # wall
_TRIES = 20
_sleep = time.sleep  # the real one, before the launcher replaces it for a program
_LOCAL_MASTER = re.compile(r'https?://(localhost|127\.[0-9.]+)(:|/|$)')
_LOOPBACK = '127.0.0.1'
_ALL = '0.0.0.0'  # noqa: S104


def prepare() -> None:
    """Shorten two waits of rospy, make it listen only on the announced address, and let it end while it starts.

    Comes before rospy.init_node.
    """
    shorten_waits()
    set_default_address()
    listen_there_only()
    replace('rospy.impl.tcpros_base.TCPServer.run', _run_until_closed)


def _run_until_closed(run: Callable[..., Any]) -> Callable[..., Any]:
    def run_until_closed(server: Any) -> None:
        """Accept connections. That the socket is closed is no error.

        If rospy shuts down before this thread has run, the thread forgets that (`is_shutdown = False`), and fails.
        """
        try:
            run(server)
        except OSError:
            if server.server_sock.fileno() >= 0:
                raise
    return run_until_closed


class _Time:
    """The module time with another sleep, which never takes longer than 1 ms."""

    def __getattr__(self, name: str) -> Any:
        return getattr(time, name)

    @staticmethod
    def sleep(seconds: float) -> None:
        _sleep(min(seconds, _LOOK_S))


def shorten_waits() -> None:
    """Shorten both waits in this process. Call this before rospy.init_node."""
    replace('rospy.impl.init.time', lambda _module: _Time())
    rospy.core.add_shutdown_hook(_wake)


def _wake(_reason: str) -> None:
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


def set_default_address(environment: Any = os.environ) -> None:
    """Set ROS_IP to 127.0.0.1, if neither it nor ROS_HOSTNAME is set, and ROS_MASTER_URI names this computer."""
    if 'ROS_IP' not in environment and 'ROS_HOSTNAME' not in environment and _LOCAL_MASTER.match(
            environment.get('ROS_MASTER_URI', 'http://localhost:11311')):
        environment['ROS_IP'] = _LOOPBACK


def listen_there_only() -> None:
    """Make rospy's servers listen on the announced address. Call this before rospy.init_node."""
    def make(original: Any) -> Any:
        def get_bind_address(address: Optional[str] = None) -> Any:
            found = original(address)
            announced = address or rosgraph.network.get_address_override()
            return _resolved(announced) or found if found == _ALL and announced else found
        return get_bind_address
    replace('rosgraph.network.get_bind_address', make)


def _resolved(name: str) -> Any:
    """Return the address of ``name`` if it is one of this computer, or None: it may be that of a router before it."""
    try:
        with socket.socket() as trial:
            trial.bind((socket.gethostbyname(name), 0))
            return trial.getsockname()[0]
    except OSError:
        return None
