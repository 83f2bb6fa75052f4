#!/usr/bin/env python3
"""Roles that go on until they are ended from outside."""

import time

import rospy
from library_node import play
from std_msgs.msg import String


def ticks(say):
    """Publish a tick every second, and a last word at the end."""
    publisher = rospy.Publisher('ticks', String, queue_size=1)
    rospy.on_shutdown(lambda: (publisher.publish('a last word'), say('a last word')))
    number = 0
    while not rospy.is_shutdown():
        rospy.sleep(1.0)
        number += 1
        publisher.publish(str(number))
        say('ticks', number)


def _compute():
    until = time.monotonic() + 0.05
    while time.monotonic() < until:
        pass


def thinks(say):
    """Compute in the main thread, so that a signal nearly always comes in the middle of a round."""
    while not rospy.is_shutdown():
        rospy.sleep(1.0)
        _compute()
        say('has thought')


def computes(say):
    """Compute in a callback, so that a signal nearly always comes in the middle of a round."""
    def on_tick(message):
        _compute()
        say('has computed', message.data)
    rospy.Subscriber('ticks', String, on_tick)
    rospy.spin()


def shuts_down_late(say):
    """Take 1.5 s of wall time to end."""
    rospy.Subscriber('ticks', String, lambda message: say('hears', message.data))
    rospy.spin()
    time.sleep(1.5)


def ends_soon(_say):
    """Run a mission that is over at 3.5 s."""
    rospy.sleep(2.5)


if __name__ == '__main__':
    play({'ticks': ticks, 'thinks': thinks, 'computes': computes, 'shuts_down_late': shuts_down_late,
          'ends_soon': ends_soon})
