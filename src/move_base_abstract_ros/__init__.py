"""The ROS shell around the core: the topics, services, parameters and time of ROS 1. It makes no decisions."""
import threading

from .replacing.replaced import replace

if not hasattr(threading.Thread, 'isAlive'):
    # rospy of Debian 11 calls isAlive when it shuts down, but Python 3.9 of Debian 11 does not have it any more.
    replace('threading.Thread.isAlive', lambda _none: threading.Thread.is_alive)
