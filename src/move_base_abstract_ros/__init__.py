"""The ROS shell around the core: topics, services, parameters and time of ROS 1. It decides nothing."""
import threading

from .replacing.replaced import replace

if not hasattr(threading.Thread, 'isAlive'):
    # rospy of Debian 11 calls it when it shuts down, and Python 3.9 of Debian 11 has it no more.
    replace('threading.Thread.isAlive', lambda _none: threading.Thread.is_alive)
