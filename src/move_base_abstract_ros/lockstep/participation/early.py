"""A program that waits for others before rospy.init_node takes part from there on, if its name is known.

Others may be held in their own init_node until this program is there: a service that it waits for is not offered, a
question to the ROS master is answered with what happens to be there, and nobody moves. So the first such call has the
program take part: what it does until then, and init_node itself, belong to its first round.
"""
import atexit
import socket
import threading
from contextlib import ExitStack

import rosgraph
import rospy
import rospy.client
from rosgraph import network
from rospy.impl import tcpros_service

from move_base_abstract.lockstep import wire

from ...replacing.replaced import replaced
from ..exchange.access import secret
from ..exchange.connection import Closed, Connection
from ..waiting.waits import replaced_within

_PORT_ARGUMENT = 8  # how many arguments of init_node come up to xmlrpc_port
#: so many looks at one parameter are a loop that waits for it
_LOOKS = 20


class Early:
    """Stands before rospy.init_node.

    ``name`` is the node's, '' where it is not known; ``join(name, uri)`` takes part.
    """

    def __init__(self, name, join):
        self._name = name
        self._join = join
        self._stack = ExitStack()
        self._reserved = None
        self._uri = ''
        self._looks = {}
        self._is_told = False
        self._is_over = False

    def install(self):
        """Begin to watch for calls that wait for others."""
        enter = self._stack.enter_context
        enter(replaced_within(tcpros_service.wait_for_service, lambda wait: self._before(
            'rospy.wait_for_service', lambda: tcpros_service.wait_for_service, wait)))
        enter(replaced('rospy.impl.tcpros_service.ServiceProxy.call', lambda call: self._before(
            'a service call', lambda: tcpros_service.ServiceProxy.call, call)))
        for function in (rospy.client.get_param, rospy.client.has_param):
            enter(replaced_within(function, lambda look, function=function: self._looking(function, look)))

    def _before(self, what, present, original):
        def call(*args, **kwds):
            return (present() if self.take_part(what) else original)(*args, **kwds)
        return call

    def _looking(self, function, original):
        def look(name, *args, **kwds):
            self._looks[name] = self._looks.get(name, 0) + 1
            is_loop = self._looks[name] > _LOOKS and self.take_part('a loop that looks at parameter {}'.format(name))
            return (function if is_loop else original)(name, *args, **kwds)
        return look

    def take_part(self, what):
        """Take part now, before ``what``; return whether that has been possible."""
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

    def end(self):
        """Watch no more: the program takes part."""
        self._is_over = True
        self._stack.close()

    def _tell(self, what):
        if not self._is_told:
            self._is_told = True
            rospy.logwarn('lockstep: %s comes before rospy.init_node, by a program whose name is not known yet. If it '
                          'waits for a node that takes part, that one waits for all to be there, and nobody moves: '
                          'give it __name:=NAME, or call rospy.init_node first', what)

    def _reserve_address(self):
        """Keep a port for the node's server of XML-RPC, so that its address can be told now."""
        family = socket.AF_INET6 if network.use_ipv6() else socket.AF_INET
        self._reserved = socket.socket(family, socket.SOCK_STREAM)
        self._reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # the server binds the same one
        self._reserved.bind((network.get_bind_address(), 0))
        self._uri = network.create_local_xmlrpc_uri(self._reserved.getsockname()[1])

    def init_node(self, init_node, args, kwds):
        """Call ``init_node`` with that port, if it has been told."""
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

    def program_has_ended(self, code):
        """Have the time master know, if it waits for this program, that it has gone before it took part."""
        if self._is_over or not self._name or rospy.core.is_initialized():
            return
        try:
            self._say_goodbye('its program ended with code {} before rospy.init_node'.format(code))
        except (OSError, Closed, rosgraph.MasterException, KeyError, ValueError):
            pass  # then there is nobody to tell

    def _say_goodbye(self, reason):
        named = rospy.get_param('/time_master/participants', [])
        if not isinstance(named, list) or self._name.strip('/') not in [str(name).strip('/') for name in named]:
            return
        host, _, port = str(rospy.get_param('/time_master/lockstep_address', '')).rpartition(':')
        connection = Connection(host, int(port), 1.0)
        connection.send(wire.hello(self._name, '', 0, False, 0, secret()) + wire.leave(reason))
        connection.close()
