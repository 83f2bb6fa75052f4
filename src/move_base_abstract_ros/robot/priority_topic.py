"""The topic ``~priority`` of one robot: it sets the robot's priority when it waits for zones and lanes."""
import rospy
from std_msgs.msg import Int32


class PriorityTopic:
    """Sets the priority of ``traveller`` (Traveller), which is the robot with ``names`` in the traffic."""

    def __init__(self, names, clock, traveller):
        self._clock = clock
        self._traveller = traveller
        self._subscriber = rospy.Subscriber(names.own('priority'), Int32, self._on_priority, queue_size=10,
                                            tcp_nodelay=True)

    def close(self):
        """Unregister the topic."""
        self._subscriber.unregister()

    def _on_priority(self, message):
        with self._clock.lock:
            self._traveller.set_priority(message.data, self._clock.now_ns())
