"""A program that waits for other nodes before rospy.init_node takes part from there on, if its name is known.

The other nodes may be held in their own init_node until this program takes part. Then a service that it waits for is
not offered, a question to the ROS master gets an answer by chance, and time stands still for ever. So the first such
call makes the program take part. All that it has done until then, and init_node itself, belong to its first round.
"""
from __future__ import annotations

import atexit
import socket
import threading
from contextlib import ExitStack
from typing import Any, Callable, Dict, Optional, Tuple

import rosgraph
import rospy
import rospy.client
from rosgraph import network
from rospy.impl import tcpros_service

from move_base_abstract.lockstep import wire

from ...replacing.replaced import replaced
from ..exchange.access import connect, is_awaited, secret
from ..exchange.connection import Closed
from ..waiting.waits import replaced_within

_PORT_ARGUMENT = 8  # number of arguments of init_node up to and with xmlrpc_port
#: a program that reads one parameter more often than this counts as a loop that waits for it
_LOOKS = 20
#: how long a program that has ended waits for a time master that is still starting [s, wall]
_PATIENCE_S = 10.0


class Early:
    """Makes a program take part before rospy.init_node, when it first waits for another node.

    ``name`` is the node's name, '' if it is not known; ``join(name, uri)`` takes part.
    """

    def __init__(self, name: str, join: Callable[[str, str], None]) -> None:
        self._name = name
        self._join = join
        self._stack = ExitStack()
        self._reserved: Optional[socket.socket] = None
        self._uri = ''
        self._looks: Dict[str, int] = {}  # {parameter: how often the program has read it}
        self._is_told = False
        self._is_over = False

    def install(self) -> None:
        """Begin to watch for calls that wait for other nodes."""
        enter = self._stack.enter_context
        enter(replaced_within(tcpros_service.wait_for_service, lambda wait: self._before(
            'rospy.wait_for_service', lambda: tcpros_service.wait_for_service, wait)))
        enter(replaced('rospy.impl.tcpros_service.ServiceProxy.call', lambda call: self._before(
            'a service call', lambda: tcpros_service.ServiceProxy.call, call)))
        for function in (rospy.client.get_param, rospy.client.has_param):
            enter(replaced_within(function, lambda look, function=function: self._looking(function, look)))

    def _before(self, what: str, present: Callable[[], Callable[..., Any]],
                original: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any, **kwds: Any) -> Any:
            return (present() if self.take_part(what) else original)(*args, **kwds)
        return call

    def _looking(self, function: Callable[..., Any], original: Callable[..., Any]) -> Callable[..., Any]:
        def look(name: str, *args: Any, **kwds: Any) -> Any:
            self._looks[name] = self._looks.get(name, 0) + 1
            is_loop = self._looks[name] > _LOOKS and self.take_part('a loop that looks at parameter {}'.format(name))
            return (function if is_loop else original)(name, *args, **kwds)
        return look

    def take_part(self, what: str) -> bool:
        """Take part now, before the call ``what``; return whether that was possible.

        It is possible once, in the main thread, if the node's name is known.
        """
        if self._is_over or threading.current_thread() is not threading.main_thread():
            return False
        if not self._name:
            self._tell(what)
            return False
        self.end()
        self._reserve_address()
        self._join(self._name, self._uri)
        atexit.register(lambda: rospy.core.is_initialized() or rospy.signal_shutdown('the program has ended'))
        return True

    def end(self) -> None:
        """Stop watching, since the program takes part."""
        self._is_over = True
        self._stack.close()

    def _tell(self, what: str) -> None:
        if not self._is_told:
            self._is_told = True
            rospy.logwarn('lockstep: %s comes before rospy.init_node, in a program whose name is not known yet. If it '
                          'waits for a participant, that participant waits for this program, and time stands still: '
                          'give the program __name:=NAME, or call rospy.init_node first', what)

    def _reserve_address(self) -> None:
        """Reserve a port for the node's XML-RPC server, so that its address is known now."""
        family = socket.AF_INET6 if network.use_ipv6() else socket.AF_INET
        self._reserved = socket.socket(family, socket.SOCK_STREAM)
        self._reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # the server binds the same one
        self._reserved.bind((network.get_bind_address(), 0))
        self._uri = network.create_local_xmlrpc_uri(self._reserved.getsockname()[1])

    def init_node(self, init_node: Callable[..., Any], args: Tuple[Any, ...], kwds: Dict[str, Any]) -> None:
        """Call ``init_node``, with the reserved port if there is one.

        :raises rospy.ROSInitException: if the node has another name or address than the one that takes part.
        """
        if self._reserved is None:
            init_node(*args, **kwds)
            return
        if len(args) < _PORT_ARGUMENT:
            kwds = dict(kwds, xmlrpc_port=self._reserved.getsockname()[1])
        try:
            init_node(*args, **kwds)
        finally:
            self._reserved.close()
            self._reserved = None
        there = rospy.get_name(), rospy.get_node_uri()
        if there != (self._name, self._uri):
            raise rospy.ROSInitException('{} takes part in lockstep since before rospy.init_node, with the address {}; '
                                         'now it is {} with {}'.format(self._name, self._uri, *there))

    def program_has_ended(self, code: int) -> None:
        """Tell the time master, if it waits for this program, that the program has ended before it took part.

        ``code`` is the exit code.
        """
        if self._is_over or not self._name or rospy.core.is_initialized():
            return
        try:
            self._say_goodbye('its program ended with code {} before rospy.init_node'.format(code))
        except (OSError, Closed, rosgraph.MasterException, KeyError, ValueError, KeyboardInterrupt):
            pass  # there is no time master to be told

    def _say_goodbye(self, reason: str) -> None:
        if not is_awaited(self._name):
            return
        connection = connect(_PATIENCE_S)
        connection.send(wire.hello(self._name, '', 0, False, 0, secret()) + wire.leave(reason))
        connection.close()
