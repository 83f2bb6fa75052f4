"""Make this process listen only on the address that ROS_IP or ROS_HOSTNAME names.

Unless that is a loopback address, rospy listens on all addresses of the computer. Then any other computer that reaches
this one can call a node's XML-RPC server, which shuts the node down if it is asked to.
"""
import os
import re
import socket

_LOCAL_MASTER = re.compile(r'https?://(localhost|127\.[0-9.]+)(:|/|$)')
_LOOPBACK = '127.0.0.1'
_ALL = '0.0.0.0'  # noqa: S104


def set_default(environment=os.environ):
    """Set ROS_IP to 127.0.0.1, if neither it nor ROS_HOSTNAME is set, and ROS_MASTER_URI names this computer."""
    if 'ROS_IP' not in environment and 'ROS_HOSTNAME' not in environment and _LOCAL_MASTER.match(
            environment.get('ROS_MASTER_URI', 'http://localhost:11311')):
        environment['ROS_IP'] = _LOOPBACK


def listen_there_only():
    """Make rospy's servers listen on the announced address. Call this before rospy.init_node."""
    import rosgraph.network

    from .replaced import replace

    def make(original):
        def get_bind_address(address=None):
            found = original(address)
            announced = address or rosgraph.network.get_address_override()
            return _resolved(announced) or found if found == _ALL and announced else found
        return get_bind_address
    replace('rosgraph.network.get_bind_address', make)


def _resolved(name):
    """Return the address of ``name`` if it is one of this computer, or None: it may be that of a router before it."""
    try:
        with socket.socket() as trial:
            trial.bind((socket.gethostbyname(name), 0))
            return trial.getsockname()[0]
    except OSError:
        return None
