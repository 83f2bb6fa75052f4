"""rospy's and actionlib's waits, made exact: they give the turn away and end at their instant, not after it.

The functions of rospy get other code, and stay the same objects, so that modules that have imported them by name use
it, too. A thread that is not the application's waits as without lockstep.
"""
from __future__ import annotations

import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Type

import genpy
import rospy
import rospy.client
import rospy.timer
from rospy.impl import tcpros_service

from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.task import TurnLost
from move_base_abstract.lockstep.wire import NEVER

from ...replacing import replaced

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

    from ..participation.taking_part import Participant

#: messages that a thread waits for at one instant, after which each takes a while, as in C++
_MESSAGES = 100


def install(participant: Participant) -> None:
    """Replace the waits. Call this once."""
    from actionlib import action_client, simple_action_client  # only now: the locks that it makes are replaced ones
    scheduler = participant.scheduler
    waits = _Waits(participant)
    for function, hook in (
            (rospy.timer.sleep, waits.sleep), (rospy.client.spin, waits.spin),
            (rospy.client.wait_for_message, waits.wait_for_message),
            (tcpros_service.wait_for_service, waits.wait_for_service),
            (action_client.ActionClient.wait_for_server, waits.wait_for_server),
            (simple_action_client.SimpleActionClient.wait_for_result, waits.wait_for_result)):
        _replace(function, hook, scheduler)
    replaced.replace('rospy.impl.tcpros_service.ServiceImpl.spin',
                     lambda _spin: lambda self: rospy.spin() if not self.done else None)


def _replace(function: Callable[..., Any], hook: Callable[..., Any], scheduler: Scheduler) -> None:
    """Make ``function`` do what ``hook`` does, in the thread that has the turn."""
    def make(original: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any, **kwds: Any) -> Any:
            return hook(*args, **kwds) if scheduler.is_mine() else original(*args, **kwds)
        return call
    replace_within(function, make)


def replace_within(function: Any, make: Callable[..., Any]) -> None:
    """Make ``function`` do what ``make(original)`` does. It stays the same object for all modules that have it."""
    replaced.note(replaced.name_of(function), function)
    original = type(function)(function.__code__, function.__globals__, function.__name__, function.__defaults__)
    original.__kwdefaults__ = function.__kwdefaults__
    key = '_lockstep_{}'.format(function.__name__)
    function.__globals__[key] = make(original)
    namespace: Dict[Any, Any] = {}
    exec(compile('def {}(*args, **kwds):\n    return {}(*args, **kwds)\n'.format(function.__name__, key),
                 __file__, 'exec'), function.__globals__, namespace)
    function.__defaults__ = function.__kwdefaults__ = None
    function.__code__ = namespace[function.__name__].__code__


@contextmanager
def replaced_within(function: Callable[..., Any], make: Callable[..., Any]) -> Iterator[None]:
    """Do the same as :func:`replace_within`, within a context."""
    before = function.__code__, function.__defaults__, function.__kwdefaults__
    replace_within(function, make)
    try:
        yield
    finally:
        function.__code__, function.__defaults__, function.__kwdefaults__ = before


def to_ns(duration: Any) -> int:
    """Return seconds (int, float) or a Duration in ns, rounded as rospy does."""
    if not isinstance(duration, genpy.Duration):
        duration = genpy.Duration.from_sec(duration)
    return duration.to_nsec()


class _Waits:
    """The waits. Each ends when the node shuts down, with the same result or error as the original."""

    def __init__(self, participant: Participant) -> None:
        self._participant = participant
        self._scheduler = participant.scheduler

    def _wake_ns(self, timeout: Optional[float]) -> int:
        return NEVER if timeout is None else self._scheduler.now_ns + max(0, to_ns(timeout))

    def sleep(self, duration: Any) -> None:
        """Stand in for rospy.sleep."""
        pause_ns = to_ns(duration)
        if pause_ns > 0:
            try:
                self._scheduler.wait(self._scheduler.now_ns + pause_ns)
            except TurnLost:
                until_shutdown()
        elif self._scheduler.is_mine():
            self._scheduler.look(STEP_NS)  # a loop of sleeps for 0 s waits by looking
        if rospy.core.is_shutdown():
            raise rospy.ROSInterruptException('ROS shutdown request')

    def spin(self) -> None:
        """Stand in for rospy.spin."""
        if not rospy.core.is_initialized():
            raise rospy.ROSInitException('client code must call rospy.init_node() first')
        try:
            while not rospy.core.is_shutdown():
                self._scheduler.wait(waits_for='the end', kind=None)
        except TurnLost:
            until_shutdown()
        except KeyboardInterrupt:
            rospy.core.signal_shutdown('keyboard interrupt')

    def wait_for_message(self, topic: str, topic_type: Type[Any], timeout: Optional[float] = None) -> Any:
        """Stand in for rospy.wait_for_message; the timeout is simulated time (stock rospy's is wall time)."""
        with _until_shutdown():
            self._scheduler.repeat(self._scheduler.current().messages, _MESSAGES)  # a latched one is there at once
        messages: List[Any] = []
        subscriber = rospy.Subscriber(topic, topic_type, messages.append)
        try:
            with _until_shutdown():
                is_there = self._scheduler.wait_until(lambda: messages, self._wake_ns(timeout),
                                                      'a message on {}'.format(topic))
            if not is_there:
                if not self._participant.topics.is_of_participants(rospy.resolve_name(topic)):
                    self._label_in_vain('a message on {}'.format(topic))
                raise rospy.ROSException('timeout exceeded while waiting for message on topic {}'.format(topic))
        finally:
            subscriber.unregister()
        return messages[0]

    def wait_for_service(self, service: str, timeout: Optional[float] = None) -> None:
        """Stand in for rospy.wait_for_service; the timeout is simulated time (stock rospy's is wall time)."""
        name = rospy.resolve_name(service)
        timeout_ns = None if timeout is None else to_ns(timeout)
        if timeout_ns == 0:
            raise ValueError('timeout must be non-zero')
        with _until_shutdown():
            is_found = self._participant.services.wait_for(name, timeout_ns)
        if not is_found:
            self._label_in_vain('service {}'.format(name))
            raise rospy.ROSException('timeout exceeded while waiting for service {}'.format(name))

    def _label_in_vain(self, what: str) -> None:
        """Label the run if nodes that do not take part may have ``what``, for which a thread has waited in vain."""
        others = rospy.get_param('/time_master/onlookers', [])
        if others:
            self._participant.label('{} was waited for in vain; it may be of a node that looks on: {}'.format(
                what, ', '.join(others)))

    def wait_for_result(self, client: Any, timeout: Any = genpy.Duration()) -> bool:
        """Stand in for SimpleActionClient.wait_for_result."""
        from actionlib.simple_action_client import SimpleGoalState
        if not client.gh:
            rospy.logerr('Called wait_for_result when no goal exists')
            return False
        self._until_or_shutdown(lambda: client.simple_state == SimpleGoalState.DONE, timeout,
                                'the result of {}'.format(client.action_client.ns))
        return client.simple_state == SimpleGoalState.DONE

    def wait_for_server(self, client: Any, timeout: Any = genpy.Duration()) -> bool:
        """Stand in for ActionClient.wait_for_server, which SimpleActionClient's calls, too."""
        if to_ns(timeout) < 0:  # as in actionlib: look once
            return _is_connected(client)
        return self._until_or_shutdown(lambda: _is_connected(client), timeout,
                                       'the action server {}'.format(client.ns))

    def _until_or_shutdown(self, condition: Callable[[], object], timeout: Any, what: str) -> bool:
        timeout = timeout if to_ns(timeout) > 0 else None
        try:
            return bool(self._scheduler.wait_until(condition, self._wake_ns(timeout), what))
        except TurnLost:
            until_shutdown()
            return bool(condition())


@contextmanager
def _until_shutdown() -> Iterator[None]:
    """Give a context for a wait: if lockstep ends in it, it waits for the node's end, as rospy does."""
    try:
        yield
    except TurnLost:
        until_shutdown()
        raise rospy.ROSInterruptException('rospy shutdown') from None


def until_shutdown() -> None:
    """Wait, 5 s of wall time at most, until the node shuts down: lockstep has ended in the middle of a wait."""
    deadline = time.monotonic() + 5.0
    while not rospy.core.is_shutdown() and time.monotonic() < deadline:
        time.sleep(0.01)


def _is_connected(client: Any) -> bool:
    """Return actionlib's own condition: whether an action server was heard, and all topics are connected to it."""
    if not client.last_status_msg:
        return False
    server = client.last_status_msg._connection_header['callerid']
    return (client.pub_goal.impl.has_connection(server) and client.pub_cancel.impl.has_connection(server)
            and all(any(connection.callerid_pub == server for connection in subscriber.impl.connections)
                    for subscriber in (client.result_sub, client.feedback_sub)))
