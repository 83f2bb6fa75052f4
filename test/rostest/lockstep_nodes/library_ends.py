#!/usr/bin/env python3
"""Roles that go on until somebody ends them."""

import time

import rospy
from library_node import play
from std_msgs.msg import String


def ticks(say):
    """Tell others of each second, also at the end."""
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
    """Its main thread, which takes signals, is nearly always in the middle of a round when one comes."""
    while not rospy.is_shutdown():
        rospy.sleep(1.0)
        _compute()
        say('has thought')


def computes(say):
    """A callback of it is."""
    def on_tick(message):
        _compute()
        say('has computed', message.data)
    rospy.Subscriber('ticks', String, on_tick)
    rospy.spin()


def shuts_down_late(say):
    """Takes its time, of the wall clock, to end."""
    rospy.Subscriber('ticks', String, lambda message: say('hears', message.data))
    rospy.spin()
    time.sleep(1.5)


def ends_soon(_say):
    """Has a mission that is over at 3.5 s."""
    rospy.sleep(2.5)


if __name__ == '__main__':
    play({'ticks': ticks, 'thinks': thinks, 'computes': computes, 'shuts_down_late': shuts_down_late,
          'ends_soon': ends_soon})
