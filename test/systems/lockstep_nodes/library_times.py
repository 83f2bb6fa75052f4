#!/usr/bin/env python3
"""Roles with rospy.sleep, Rate and Timer, and the order of events at one instant."""

import sys
import threading

import rospy
from library_node import play
from std_msgs.msg import String


def sleeper(say):
    say('begin')
    for pause in (0.5, rospy.Duration(0, 1), 1e-9, 0, -1, 2):
        rospy.sleep(pause)
        say('slept', rospy.Time.now().to_nsec(), rospy.get_rostime().to_nsec(), round(rospy.get_time(), 9))


def rates(say):
    rate = rospy.Rate(3)
    for _ in range(4):
        rate.sleep()
        say('third', rospy.Time.now().to_nsec())
    late = rospy.Rate(1)
    rospy.sleep(2.5)
    late.sleep()
    say('late')
    late.sleep()
    say('late too')
    late.sleep()
    say('on time')


def timers(say):
    def tick(event):
        say('tick', event.current_expected.to_sec(), event.current_real.to_sec(),
            event.last_real.to_sec() if event.last_real else None)

    def slow(_event):
        say('slow begins')
        rospy.sleep(1.5)
        say('slow ends')
    timer = rospy.Timer(rospy.Duration(1), tick)
    rospy.Timer(rospy.Duration(2), lambda event: say('once'), oneshot=True)
    rospy.sleep(3.25)
    timer.shutdown()
    rospy.Timer(rospy.Duration(1), slow, oneshot=True)
    rospy.sleep(5)
    say('end')


def order(say):
    """Have a message, a thread that it wakes, a timer and the main thread at the same instant."""
    woken = threading.Event()
    publisher = rospy.Publisher('chat', String, queue_size=1)
    rospy.Subscriber('chat', String, lambda message: (say('message', message.data), woken.set()))

    def wait():
        for _ in range(3):
            woken.wait()
            woken.clear()
            say('thread')
    threading.Thread(target=wait, daemon=True).start()
    rospy.Timer(rospy.Duration(1), lambda event: say('timer'))
    for index in range(3):
        rospy.sleep(1)
        say('main')
        publisher.publish(str(index))
    rospy.sleep(0.5)


def now_before_joining(say):
    say('now', rospy.Time.now().to_nsec(), rospy.get_param('/use_sim_time'))
    sys.exit(3)


if __name__ == '__main__':
    play(globals())
