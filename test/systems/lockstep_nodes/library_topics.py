#!/usr/bin/env python3
"""Roles with topics."""

import time

import rospy
from library_node import play
from std_msgs.msg import Int32, String


class Peers(rospy.SubscribeListener):
    """Logs subscribers that come and go."""

    def __init__(self, say):
        self._say = say

    def peer_subscribe(self, topic_name, topic_publish, peer_publish):
        self._say('peer comes', topic_name)
        topic_publish(String('to all'))
        peer_publish(String('to you'))

    def peer_unsubscribe(self, topic_name, num_peers):
        self._say('peer goes', topic_name, num_peers)


def talker(say):
    chatter = rospy.Publisher('chatter', String, queue_size=1)
    note = rospy.Publisher('note', String, queue_size=1, latch=True)
    note.publish('first')
    note.publish('latched')
    say('connections', chatter.get_num_connections(), note.get_num_connections())
    rospy.sleep(1)
    say('connections', chatter.get_num_connections(), note.get_num_connections())
    for index in range(5):
        chatter.publish(str(index))  # more than queue_size at one instant, and none is lost
    rospy.sleep(2)
    say('connections', chatter.get_num_connections(), note.get_num_connections())
    chatter.unregister()
    rospy.sleep(1)
    chatter = rospy.Publisher('chatter', String, queue_size=1)
    rospy.sleep(1)
    chatter.publish('again')
    rospy.sleep(1)


def listener(say):
    def on_message(message):
        say('hears', message.data, message._connection_header['callerid'], message._connection_header['latching'])
    chatter = rospy.Subscriber('chatter', String, on_message)
    rospy.Subscriber('note', String, on_message)
    say('connections', chatter.get_num_connections())
    rospy.sleep(0.5)
    say('connections', chatter.get_num_connections())
    rospy.sleep(2)
    late = rospy.Subscriber('note', String, lambda message: say('late', message.data))
    rospy.sleep(1)
    say('connections', chatter.get_num_connections())
    late.unregister()
    rospy.sleep(2)
    say('connections', chatter.get_num_connections())


def any_listener(say):
    def on_any(message):
        say('any', message._connection_header['type'], String().deserialize(message._buff).data)
    rospy.Subscriber('chatter', rospy.AnyMsg, on_any)
    rospy.sleep(6)


def slow_listener(say):
    """Listen with a callback that takes 1 s and a queue of two, which keeps the newest messages."""
    def on_number(message):
        say('begins', message.data)
        rospy.sleep(1.0)
        say('ends', message.data)
    rospy.Subscriber('numbers', Int32, on_number, queue_size=2)
    rospy.Subscriber('others', Int32, lambda message: say('other', message.data))
    rospy.sleep(6)


def counter(_say):
    numbers = rospy.Publisher('numbers', Int32, queue_size=10)
    others = rospy.Publisher('others', Int32, queue_size=10)
    rospy.sleep(0.5)
    for index in range(10):
        rospy.sleep(0.3)
        numbers.publish(index)
        others.publish(index)
    rospy.sleep(3)


def welcomer(say):
    publisher = rospy.Publisher('chatter', String, Peers(say), queue_size=10)
    for number in range(8):
        say('listeners', publisher.get_num_connections())
        publisher.publish(str(number))
        rospy.sleep(1)


def guest(say):
    for pause in (1.5, 1):
        rospy.sleep(pause)
        chatter = rospy.Subscriber('chatter', String, lambda message: say('hears', message.data))
        rospy.sleep(2)
        chatter.unregister()
    rospy.sleep(2)


def itself(say):
    """Publish to itself, also from the callback."""
    publisher = rospy.Publisher('numbers', Int32, queue_size=1)

    def on_number(message):
        say('hears', message.data)
        if message.data % 3:
            publisher.publish(message.data + 1)
        else:
            raise KeyError('shown, and nothing more')
    rospy.Subscriber('numbers', Int32, on_number)
    for start in (1, 4):
        rospy.sleep(1)
        publisher.publish(start)
    rospy.sleep(1)


def hearer(say):
    """Listen to nodes that publish at the same instant."""
    rospy.Subscriber('names', String, lambda message: say('hears', message.data))
    rospy.sleep(10)


def _speak(name, times):
    publisher = rospy.Publisher('names', String, queue_size=10)
    for _ in range(times):
        rospy.sleep(1)
        publisher.publish(name)


def speaker_2(_say):
    _speak('speaker_2', 5)


def speaker_10(_say):
    _speak('speaker_10', 5)


def speaker_9(_say):
    _speak('speaker_9 with rank', 5)


def outside_talker():
    publisher = rospy.Publisher('chatter', String, queue_size=1)
    while not rospy.is_shutdown():
        publisher.publish('from outside')
        time.sleep(0.02)


def hears_outside(say):
    message = rospy.wait_for_message('chatter', String)
    say('hears', message.data)


if __name__ == '__main__':
    play(globals())
