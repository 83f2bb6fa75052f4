"""Prepare rospy before a process of ours, or a program that the launcher starts, becomes a node."""
from . import own_address, rospy_waits


def prepare():
    """Shorten two waits of rospy, and make it listen only on the announced address. Comes before rospy.init_node."""
    rospy_waits.shorten()
    own_address.set_default()
    own_address.listen_there_only()
