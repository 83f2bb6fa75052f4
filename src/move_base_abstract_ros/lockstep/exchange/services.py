"""Service calls between participants, which replace rospy's connections.

A call is handled in the next round, by a thread of its own as in rospy. The handler may itself sleep or call services.
Calls from other nodes come over rospy's connections and enter at the next grant. During a call to another node time
stands still, unless the answer takes long: then the other node may be waiting for simulated time.
"""
from __future__ import annotations

import _thread
import sys
import time
from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Set, Tuple

import rospy
from rospy.impl import registration, tcpros_service

from move_base_abstract.lockstep import wire
from move_base_abstract.lockstep.task import TurnLost, _make_lock

from ...replacing.replaced import replace
from ..ros_master.master_calls import aside
from .links import creating_index

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

    from ..participation.taking_part import Participant

#: endings of the names of services that rospy itself offers in each node; they are not part of lockstep
_OF_ROSPY = ('/get_loggers', '/set_logger_level')
_TIME_MASTERS = '/time_master/'  # the namespace of the time master's services
_SEEK_SECONDS = 0.1  # wall
_PATIENCE = 5.0  # s, wall
_CALLS = 1000  # of a thread at one instant, after which each takes a while, as in C++


class Services:
    """The services that a participant offers and calls."""

    def __init__(self, participant: Participant) -> None:
        self._participant: Any = participant
        self._names: List[str] = []
        self._offered: Dict[Optional[int], Any] = {}
        self._calls: Dict[int, Any] = {}
        self._call_count = 0
        self._found: Set[str] = set()

    def install(self) -> None:
        """Take over the node's present and future services, without those that rospy itself offers."""
        _patch(self)
        for name, service in sorted(registration.get_service_manager().map.items()):
            if not name.endswith(_OF_ROSPY):
                self.register(name, service)

    # --- services of this node --------------------------------------------------------------------------------------

    def register(self, name: str, service: Any) -> None:
        """Report a new service."""
        number = len(self._names)
        self._names.append(name)
        self._offered[number] = service
        service._lockstep_number = number
        self._participant.add(wire.serve(number, creating_index(), name))

    def unregister(self, service: Any) -> None:
        """Report that a service is gone."""
        number = getattr(service, '_lockstep_number', None)
        if self._offered.pop(number, None) is not None:
            self._participant.add(wire.unserve(number))

    def handlers(self) -> Dict[int, Callable[..., None]]:
        """Return {kind of a grant's item: function of its values, to be called in the turn}."""
        return {wire.CALL_IN: self._handle, wire.ANSWER: self._take_answer, wire.FOUND: self._found.add}

    def _handle(self, number: int, caller: int, call: int, data: bytes) -> None:
        service = self._offered.get(number)
        if service is None:
            name = self._names[number] if number < len(self._names) else number
            is_ok, answer = 0, 'service [{}] is not offered any more'.format(name).encode('utf-8')
        else:
            is_ok, answer = _serve(service, data)
        self._participant.add(wire.response(caller, call, is_ok, answer))

    def from_outside(self, service: Any, handle: Callable[..., Any]) -> None:
        """Run ``handle()``, a call of a node that does not take part, in the next round, and wait for its end."""
        over = _make_lock()
        over.acquire()

        def run() -> None:
            self._participant.label('service {} was called by a node that does not take part'.format(
                service.resolved_name))
            try:
                handle()
            finally:
                over.release()
        self._participant.scheduler.from_outside(run)
        while not over.acquire(True, 0.5):
            if self._participant.scheduler.is_closed:
                return

    # --- calls of this node -----------------------------------------------------------------------------------------

    def call(self, name: str, request: bytes) -> Tuple[int, bytes]:
        """Call a participant's service; return (wire.CallStatus, bytes). Other threads and nodes go on meanwhile.

        In a loop that does nothing but call, time goes on.

        :raises TurnLost: if the run ends meanwhile.
        """
        self._call_count += 1
        number = self._call_count
        scheduler = self._participant.scheduler
        scheduler.repeat(scheduler.current().calls, _CALLS)  # in a loop that calls until the world changes
        self._calls[number] = [scheduler.current(), None]
        self._participant.add(wire.call(number, creating_index(), name, request))
        try:
            while self._calls[number][1] is None:
                scheduler.wait(waits_for='the answer of service {}'.format(name))
            return self._calls[number][1]
        finally:
            del self._calls[number]

    def _take_answer(self, number: int, status: int, data: bytes) -> None:
        if number in self._calls:
            self._calls[number][1] = (status, data)
            self._participant.scheduler.wake(self._calls[number][0])

    def wait_for(self, name: str, timeout_ns: Optional[int]) -> bool:
        """Wait until a participant or another node offers the service; return False if it is not there in time.

        ``timeout_ns`` [ns, simulated] is None for no limit.

        :raises TurnLost: if the run ends meanwhile.
        """
        scheduler = self._participant.scheduler
        self._found.discard(name)
        self._participant.add(wire.watch(name))
        scheduler.wait_round()  # in its grant the time master says whether a participant offers the service
        if name in self._found or self.is_offered_outside(name):
            return True
        wake_ns = wire.NEVER if timeout_ns is None else scheduler.now_ns + timeout_ns
        sought = [name]
        _thread.start_new_thread(self._seek_outside, (sought,))
        try:
            return scheduler.wait_until(lambda: name in self._found, wake_ns, 'service {}'.format(name))
        finally:
            sought.clear()

    def _seek_outside(self, sought: Any) -> None:
        """Wake the thread that waits for a service when a node that does not take part offers it. Runs in a thread."""
        while sought and not self._participant.scheduler.is_closed:
            name = sought[0]
            if self.is_offered_outside(name):
                self._participant.scheduler.from_outside(partial(self._found_outside, name))
                return
            time.sleep(_SEEK_SECONDS)

    def _found_outside(self, name: str) -> None:
        self._participant.label('service {} was waited for; a node offers it that does not take part'.format(name))
        self._found.add(name)

    def call_outside(self, name: str, call: Any) -> Any:
        """Return what ``call()`` returns, which calls a service of a node that does not take part; label the run.

        Simulated time stands still until the answer comes, at most for 5 s of wall time; then it goes on. (Calls of the
        time master's own services are not labelled.)

        :raises rospy.ROSInterruptException: if the run ends meanwhile.
        """
        if name.startswith(_TIME_MASTERS):
            with aside():
                return call()
        self._participant.parameters.settle()  # the other node may read them
        label = self._participant.label
        label('service {}, which was called, is offered by a node that does not take part'.format(name))
        asked = _Asked(call)
        if not asked.is_over.acquire(True, _PATIENCE):
            label('service {} of a node that does not take part has not answered for {:g} s of wall time: simulated '
                  'time goes on until it does'.format(name, _PATIENCE))
            scheduler = self._participant.scheduler
            asked.when_over(lambda: scheduler.from_outside(_nothing))
            try:
                scheduler.wait_until(lambda: asked.outcome, waits_for='the answer of service {}'.format(name))
            except TurnLost:
                raise rospy.ROSInterruptException('node shutdown interrupted service call') from None
        return asked.result()

    def is_offered_outside(self, name: str) -> bool:
        """Return whether the ROS master knows a node that offers the service and has never taken part.

        Present and former participants do not count: they register there at moments of the wall clock.
        """
        try:
            with aside():
                code, _, (_, _, offered) = rospy.client.get_master().getSystemState()
        except (OSError, ValueError):
            return False
        members = set(self._participant.members.names.values())
        return code == 1 and any(service == name and not members.issuperset(nodes) for service, nodes in offered)


class _Asked:
    """A call in a thread of its own, which is not one of the application's threads."""

    def __init__(self, call: Callable[[], Any]) -> None:
        self.outcome: List[Any] = []  # when it is over: one (result, error), of which one is None
        self.is_over = _make_lock()
        self.is_over.acquire()
        self._then: List[Callable[[], None]] = []
        _thread.start_new_thread(self._ask, (call,))

    def _ask(self, call: Callable[[], Any]) -> None:
        try:
            outcome: Any = (call(), None)
        except BaseException as error:
            outcome = (None, error)
        self.outcome.append(outcome)
        self.is_over.release()
        for then in self._then:
            then()

    def when_over(self, then: Callable[[], None]) -> None:
        """Call ``then()`` in the call's thread when the call is over, unless it is over already."""
        self._then.append(then)

    def result(self) -> Any:
        """Return what the call has returned, or raise what it has raised."""
        (result, error), = self.outcome
        if error is not None:
            raise error
        return result


def _nothing() -> None:
    """Do nothing; the scheduler then checks the conditions of waiting threads."""


def _serve(service: Any, data: bytes) -> Tuple[int, bytes]:
    """Call a service's handler; return (1, response) or (0, text of the error), as rospy's own connections would."""
    request = service.request_class()
    try:
        request.deserialize(data)
        response = tcpros_service.convert_return_to_response(service.handler(request), service.response_class)
        buffer = BytesIO()
        response.serialize(buffer)
        service.seq += 1
        return 1, buffer.getvalue()
    except rospy.ServiceException as error:
        return 0, 'service cannot process request: {}'.format(error).encode('utf-8')
    except TurnLost:
        raise
    except (Exception, SystemExit) as error:  # in rospy sys.exit ends the connection, and the caller gets an error
        service.error_handler(error, *sys.exc_info())
        return 0, 'error processing request: {}'.format(error).encode('utf-8')


def _patch(services: Services) -> None:
    """Replace rospy's connections among participants by this participant's services."""
    _replace_offering(services)
    _replace_calling(services, services._participant.scheduler)


def _replace_offering(services: Services) -> None:
    def registering(register: Callable[..., Any]) -> Callable[..., Any]:
        def _register(self: Any, name: str, service: Any) -> None:
            register(self, name, service)
            if not name.endswith(_OF_ROSPY):
                services.register(name, service)
        return _register

    def unregistering(unregister: Callable[..., Any]) -> Callable[..., Any]:
        def _unregister(self: Any, name: str, service: Any) -> None:
            services.unregister(service)
            unregister(self, name, service)
        return _unregister

    def handling(handle_request: Callable[..., Any]) -> Callable[..., Any]:
        def _handle_request(self: Any, transport: Any, request: Any) -> None:
            if hasattr(self, '_lockstep_number') and not services._participant.scheduler.is_closed:
                services.from_outside(self, lambda: handle_request(self, transport, request))
            else:
                handle_request(self, transport, request)
        return _handle_request

    replace('rospy.service.ServiceManager.register', registering)
    replace('rospy.service.ServiceManager.unregister', unregistering)
    replace('rospy.impl.tcpros_service.ServiceImpl._handle_request', handling)


def _replace_calling(services: Services, scheduler: Scheduler) -> None:
    def calling(call: Callable[..., Any]) -> Callable[..., Any]:
        def _call(self: Any, *args: Any, **kwds: Any) -> Any:
            if not scheduler.is_mine():
                return call(self, *args, **kwds)
            request = rospy.msg.args_kwds_to_message(self.request_class, args, kwds)
            buffer = BytesIO()
            request.serialize(buffer)
            try:
                status, answer = services.call(self.resolved_name, buffer.getvalue())
            except TurnLost:
                raise rospy.ROSInterruptException('node shutdown interrupted service call') from None
            if status != wire.CallStatus.NO_SERVER:
                return _answer(self, status, answer)
            if services.is_offered_outside(self.resolved_name):
                return services.call_outside(self.resolved_name, lambda: call(self, request))
            raise rospy.ServiceException('service [{}] unavailable'.format(self.resolved_name))
        return _call

    replace('rospy.impl.tcpros_service.ServiceProxy.call', calling)


def _answer(proxy: Any, status: int, data: Any) -> Any:
    """Return the response, or raise the error that rospy would raise."""
    if status == wire.CallStatus.OK:
        return proxy.response_class().deserialize(data)
    if status == wire.CallStatus.SERVER_GONE:
        raise rospy.ServiceException('transport error completing service call: the server of {} is gone'.format(
            proxy.resolved_name))
    raise rospy.ServiceException('service [{}] responded with an error: {}'.format(proxy.resolved_name, data))
