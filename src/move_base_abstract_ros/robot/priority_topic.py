"""The topic ``~priority`` of one robot: which priority it has where it waits for zones and lanes, from now on."""
import rospy
from std_msgs.msg import Int32


class PriorityTopic:
    """Of the robot with ``names``, whose place in traffic is ``traveller`` (Traveller)."""

    def __init__(self, names, clock, traveller):
        self._clock = clock
        self._traveller = traveller
        self._subscriber = rospy.Subscriber(names.own('priority'), Int32, self._on_priority, queue_size=10,
                                            tcp_nodelay=True)

    def close(self):
        """Leave the graph."""
        self._subscriber.unregister()

    def _on_priority(self, message):
        with self._clock.lock:
            self._traveller.set_priority(message.data, self._clock.now_ns())
