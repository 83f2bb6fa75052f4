"""All calls of the ROS master by this process, caught at the one place that they have in common: XML-RPC requests.

Answers that are lists, or trees, come in the order of the names' bytes. Stock answers come in the order in which nodes
have registered, which differs from run to run. Calls of the thread that has the turn are answered by :mod:`queries`
(nodes, topics, services) and :mod:`parameters`.
"""
from __future__ import annotations

import sys
import threading
from contextlib import contextmanager
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence
from urllib.parse import urlsplit

import rosgraph
import rospy.core  # noqa: F401 - replaced by name

from move_base_abstract.lockstep.parameters import in_order

from ...replacing.replaced import replace
from ..code.callers import is_own, own_frame
from ..code.labels import NUMBER, told

QUESTIONS = ('getPublishedTopics', 'getTopicTypes', 'getSystemState', 'lookupNode', 'lookupService')
CHANGES = ('setParam', 'deleteParam')
#: what a node or the ROS master says of its process and its connections
_NUMBERS = ('getPid', 'getBusStats', 'getBusInfo')
_PASS_ON = ('xmlrpc.', 'rosgraph.', 'rospy.msproxy', 'rospy.core')
_MULTICALL = 'system.multicall'
_METHODS = frozenset((*QUESTIONS, *CHANGES, _MULTICALL, 'getParam', 'hasParam', 'searchParam', 'getParamNames',
                      'subscribeParam'))
_local = threading.local()
Answer = List[Any]  # of the ROS master: [code, message, value]


class MasterCalls:
    """The calls of this process, and the functions that answer them once it takes part."""

    def __init__(self) -> None:
        self._is_installed = False
        #: take_part(what), for a program that is not a node yet
        self.before: Optional[Callable[[str], bool]] = None
        self._participant: Any = None
        self._answers: Dict[str, Callable[..., Answer]] = {}

    def install(self) -> None:
        """Put a hook in front of XML-RPC requests."""
        if not self._is_installed:
            self._is_installed = True
            replace('xmlrpc.client.ServerProxy._ServerProxy__request', self._following)
            # In front of its lock: a thread that waits for other nodes must not hold it, since others may need it.
            replace('rospy.core._LockedServerProxy._ServerProxy__request', self._following)

    def follow(self, participant: Any, answers: Dict[str, Callable[..., Answer]]) -> None:
        """Answer calls of the thread that has the turn, from now on; ``answers`` is {method: answer(ask, *arguments)}.

        ``ask()`` sends the request to the ROS master.
        """
        self.install()
        replace('rospy.msproxy.MasterProxy.get_param_cached', lambda _cached: _get_param)
        self._participant, self._answers = participant, answers

    def _following(self, request: Callable[..., Any]) -> Callable[..., Any]:
        def _request(proxy: Any, method: str, arguments: Sequence[Any]) -> List[Any]:
            if not getattr(_local, 'is_aside', False):
                _tell_of(proxy, method, sys._getframe(1))

            def ask(*others: Any) -> List[Any]:
                with aside():
                    return request(proxy, method, others or arguments)
            if method not in _METHODS or getattr(_local, 'is_aside', False) or not _is_of_ros_master(proxy):
                return request(proxy, method, arguments)
            return self._call(ask, method, arguments)
        return _request

    def _call(self, ask: Callable[..., Any], method: str, arguments: Sequence[Any]) -> List[Any]:
        if self.before is not None and method in QUESTIONS + CHANGES:
            self.before('a call of the ROS master ({})'.format(method))
        participant = self._participant
        if participant is None or participant.is_told_to_end:
            return ask() if method == _MULTICALL else _in_order(method, ask())
        if not participant.scheduler.is_mine():
            if method in CHANGES and participant.scheduler.current() is None and not participant.scheduler.is_closed:
                _label_stray(participant, arguments)
            return ask() if method == _MULTICALL else _in_order(method, ask())
        if method == _MULTICALL:
            return self._multicall(ask, *arguments)
        answer = self._answers.get(method)
        return _in_order(method, ask()) if answer is None else answer(ask, *arguments)

    def _multicall(self, ask: Callable[..., Any], calls: Sequence[Dict[str, Any]]) -> List[Any]:
        """Answer the calls that change parameters here, and let the ROS master answer all others in one request."""
        others = [call for call in calls if call['methodName'] not in CHANGES]
        answers = iter(ask(others) if others else ())
        return [[self._answers[call['methodName']](None, *call['params'])] if call['methodName'] in CHANGES
                else next(answers) for call in calls]


#: the calls of this process
calls = MasterCalls()


@contextmanager
def aside() -> Iterator[None]:
    """Give a context in which the calling thread's requests go to the ROS master as without lockstep."""
    before, _local.is_aside = getattr(_local, 'is_aside', False), True
    try:
        yield
    finally:
        _local.is_aside = before


def _get_param(self: Any, key: str) -> Any:
    value = self[key]
    if isinstance(value, dict) and not value:
        raise KeyError(key)  # as rospy does: the ROS master answers {} for a parameter that is not set, too
    return value


def _is_of_ros_master(proxy: Any) -> bool:
    return proxy._ServerProxy__host == urlsplit(rosgraph.get_master_uri()).netloc


def _tell_of(proxy: Any, method: str, frame: Any) -> None:
    """Label the run if the program asks for numbers of a process, or asks another server than the ROS master."""
    if method in _NUMBERS:
        while frame is not None and (frame.f_globals.get('__name__') or '').startswith(_PASS_ON):
            frame = frame.f_back
        told.tell(frame if is_own(frame) else None, method, NUMBER)
    elif not _is_of_ros_master(proxy):
        told.tell(own_frame(frame), 'xmlrpc.client.ServerProxy', 'of {}: its answer comes over a connection, at some '
                  'moment of the wall clock'.format(method))


def _label_stray(participant: Any, arguments: Sequence[Any]) -> None:
    participant.label('parameter {} is set or deleted by a thread that lockstep does not order'.format(
        rosgraph.names.resolve_name(arguments[1], arguments[0])))


def _in_order(method: str, answer: Answer) -> Answer:
    """Return an answer of the ROS master with its lists of names in order."""
    code, message, value = answer
    if code != 1:
        return answer
    if method in ('getPublishedTopics', 'getTopicTypes', 'getParamNames'):
        value = sorted(value)
    elif method == 'getSystemState':
        value = [sorted([name, sorted(nodes)] for name, nodes in group) for group in value]
    elif method in ('getParam', 'subscribeParam'):
        value = in_order(value)
    return [code, message, value]
