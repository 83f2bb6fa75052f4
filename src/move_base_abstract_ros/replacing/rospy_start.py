"""What is done to rospy before a process of ours, or a program that the launcher starts, becomes a node."""
from . import own_address, rospy_waits


def prepare():
    """Shorten two of rospy's waits, and have it listen on the announced address only. Comes before rospy.init_node."""
    rospy_waits.shorten()
    own_address.set_default()
    own_address.listen_there_only()
