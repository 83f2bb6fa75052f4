"""Notices that the ROS master has gone while a node starts. rospy itself would try for ever, or fail anywhere."""
from __future__ import annotations

import http.client
import sys
import threading
import time
import xmlrpc.client
from typing import Any

import rosgraph

_PERIOD_S = 0.2  # wall
_TIMEOUT_S = 5.0  # wall; a busy ROS master answers late
_GONE_AFTER = 3  # number of refused connections in a row after which the ROS master counts as gone


class RosMasterWatch:
    """Asks the ROS master every 0.2 s whether it is there, until :meth:`stop`. It counts as gone only after an answer.

    ``has_lost`` says whether it is gone.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._uri = rosgraph.get_master_uri()
        self._stopped = threading.Event()
        self._is_known = False
        self.has_lost = False

    def start(self) -> None:
        """Ask once, then start the thread. So a ROS master that is there now cannot end unnoticed."""
        self._is_known = is_answering(self._uri, self._name, _TIMEOUT_S)
        threading.Thread(target=self._watch, name='ros_master_watch', daemon=True).start()

    def stop(self) -> None:
        """Stop asking."""
        self._stopped.set()

    def _watch(self) -> None:
        refused, is_late = 0, False
        while not self._stopped.wait(_PERIOD_S):
            begin = time.monotonic()
            answer = is_answering(self._uri, self._name, _TIMEOUT_S)
            if answer:
                self._is_known, refused, is_late = True, 0, False
            elif self._is_known and time.monotonic() - begin < _TIMEOUT_S:
                refused += 1
            elif self._is_known and not is_late:
                is_late = True
                self._say('has not answered for {:g} s; the node waits for it'.format(_TIMEOUT_S), 'logwarn')
            if refused >= _GONE_AFTER and not self._stopped.is_set():
                self._say('has gone while the node started; the node ends', 'logfatal')
                self.has_lost = True
                return

    def _say(self, text: str, level: str) -> None:
        text = '{}: the ROS master at {} {}'.format(self._name, self._uri, text)
        rospy = sys.modules.get('rospy')  # a launcher that asks for a proxy alone does not load it
        if rospy is not None and rospy.core.is_initialized():
            getattr(rospy, level)('%s', text)
        else:
            print(text, file=sys.stderr, flush=True)


class _Transport(xmlrpc.client.Transport):
    """A transport with a time-out [s, wall], which the standard one lacks."""

    def __init__(self, timeout: float) -> None:
        super().__init__()
        self._timeout = timeout

    def make_connection(self, host: str) -> Any:
        """Return a connection with the time-out."""
        connection = super().make_connection(host)
        connection.timeout = self._timeout
        return connection


def proxy_of(uri: str, timeout: float) -> Any:
    """Return a proxy of the ROS master or node at ``uri`` whose calls fail after ``timeout`` [s, wall] of silence."""
    return xmlrpc.client.ServerProxy(uri, transport=_Transport(timeout))


def is_answering(uri: str, caller: str, timeout: float) -> bool:
    """Return whether a ROS master or node at ``uri`` answers within ``timeout`` [s, wall]."""
    try:
        code, _, _ = proxy_of(uri, timeout).getPid('/' + caller.strip('/'))
    except (OSError, http.client.HTTPException, xmlrpc.client.Error, ValueError, TypeError):
        return False
    return code == 1
