"""Make this process have only one connection to each publisher of a topic.

rospy connects to all publishers of a topic whenever the ROS master tells it of one more. If a connection to one of the
others is still being made at that moment, rospy makes a second one and drops the first, with all messages on it: for
example the first goal of a client that started before the server.
"""
from __future__ import annotations

import threading
from typing import Any, Callable, Dict, Tuple

import rospy
from rospy.impl.registration import get_registration_listeners, get_topic_manager

from .replaced import replace


class _OneAtATime:
    """Calls rospy's function for connecting to a publisher, one call at a time for each publisher of a topic.

    That function checks first whether there is a connection already.
    """

    def __init__(self, connect: Callable[..., Any]) -> None:
        self._connect = connect
        self._lock = threading.Lock()
        self._under_way: Dict[Tuple[str, str], Tuple[Any, int]] = {}  # {(topic, URI): (lock, number of waiting calls)}

    def __call__(self, topic: str, uri: str) -> Tuple[int, str, int]:
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


def connect_one_at_a_time() -> None:
    """Make rospy never make two connections to one publisher of a topic at once. May be called twice."""
    for manager in get_registration_listeners().listeners:
        handler = getattr(manager, 'handler', None)
        if handler is not None and not isinstance(handler._connect_topic, _OneAtATime):
            replace('rospy.impl.masterslave.ROSHandler._connect_topic', _OneAtATime, on=handler)


def keep_apart(topic: str) -> None:
    """Do not connect this process's subscription of ``topic`` (absolute) to its own publisher.

    Call this before the ROS master knows of the subscription, inside a bulk_registration.
    """
    subscription = get_topic_manager().get_subscriber_impl(topic)
    own_uri = rospy.get_node_uri()
    replace('rospy.topics._TopicImpl.has_connection',
            lambda has_connection: lambda uri: uri == own_uri or has_connection(uri), on=subscription)
