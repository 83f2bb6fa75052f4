"""One connection of this process to each publisher of a topic.

rospy connects to all publishers of a topic whenever the ROS master tells it of one more. If the connection to the
others is still being made at that moment, it makes a second one and drops the first, with all that is on its way:
the first goal of a client that was there before the server, say.
"""
import threading

import rospy
from rospy.impl.registration import get_registration_listeners, get_topic_manager

from .replaced import replace


class _OneAtATime:
    """rospy's way of connecting, which looks first whether there is a connection; one call per publisher at a time."""

    def __init__(self, connect):
        self._connect = connect
        self._lock = threading.Lock()
        self._under_way = {}

    def __call__(self, topic, uri):
        key = topic, uri
        with self._lock:
            turn, waiting = self._under_way.get(key, (threading.Lock(), 0))
            self._under_way[key] = turn, waiting + 1
        try:
            with turn:
                return self._connect(topic, uri)
        finally:
            with self._lock:
                turn, waiting = self._under_way.pop(key)
                if waiting > 1:
                    self._under_way[key] = turn, waiting - 1


def connect_one_at_a_time():
    """Have rospy never make two connections to one publisher of a topic at once. May be said twice."""
    for manager in get_registration_listeners().listeners:
        handler = getattr(manager, 'handler', None)
        if handler is not None and not isinstance(handler._connect_topic, _OneAtATime):
            replace('rospy.impl.masterslave.ROSHandler._connect_topic', _OneAtATime, on=handler)


def keep_apart(topic):
    """Do not connect this process's subscription of ``topic`` (absolute) to its own publisher.

    To be said before the ROS master knows of the subscription: within a bulk_registration.
    """
    subscription = get_topic_manager().get_subscriber_impl(topic)
    own_uri = rospy.get_node_uri()
    replace('rospy.topics._TopicImpl.has_connection',
            lambda has_connection: lambda uri: uri == own_uri or has_connection(uri), on=subscription)
