"""Prepare rospy before a process of ours, or a program that the launcher starts, becomes a node."""
from . import own_address, rospy_waits
from .replaced import replace


def prepare():
    """Shorten two waits of rospy, make it listen only on the announced address, and let it end while it starts.

    Comes before rospy.init_node.
    """
    rospy_waits.shorten()
    own_address.set_default()
    own_address.listen_there_only()
    replace('rospy.impl.tcpros_base.TCPServer.run', _run_until_closed)


def _run_until_closed(run):
    def run_until_closed(server):
        """Accept connections. That the socket is closed is no error.

        If rospy shuts down before this thread has run, the thread forgets that (`is_shutdown = False`), and fails.
        """
        try:
            run(server)
        except OSError:
            if server.server_sock.fileno() >= 0:
                raise
    return run_until_closed
