#!/usr/bin/env python3
"""Roles with programs that look at their subscribers."""

import rospy
from library_node import play
from std_msgs.msg import String


class Connected(rospy.SubscribeListener):
    """Greets each new subscriber, and logs that."""

    def __init__(self, say):
        super().__init__()
        self._say = say

    def peer_subscribe(self, _topic, _publish, publish_single):
        self._say('a listener has come')
        publish_single(String('welcome'))

    def peer_unsubscribe(self, _topic, count):
        self._say('a listener has gone', count)


def speaker(say):
    publisher = rospy.Publisher('chat', String, subscriber_listener=Connected(say), queue_size=10)
    for number in range(8):
        say('listeners', publisher.get_num_connections())
        publisher.publish(str(number))
        rospy.sleep(1.0)


def hearer(say):
    rospy.sleep(2.0)
    subscriber = rospy.Subscriber('chat', String, lambda message: say('hears', message.data))
    rospy.sleep(4.0)
    subscriber.unregister()
    rospy.sleep(4.0)


if __name__ == '__main__':
    play({'speaker': speaker, 'hearer': hearer})
