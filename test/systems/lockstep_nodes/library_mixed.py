#!/usr/bin/env python3
"""Nodes that do some of everything, drawn from generators with fixed seeds: values depend on the order of events."""

import random
import threading

import rospy
from library_node import play
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse


def mixed_1(say):
    _mixed(say, 1)


def mixed_2(say):
    _mixed(say, 2)


def mixed_3(say):
    _mixed(say, 3)


class _Mixed:
    """The state that the threads and callbacks of one node share."""

    def __init__(self, say, number):
        self.say = say
        self.random = random.Random(number)
        self.lock = threading.Lock()
        self.count = 0
        self.publisher = rospy.Publisher('talk', String, queue_size=2)
        self.note = rospy.Publisher('note', String, queue_size=1, latch=True)
        rospy.Service('ask_{}'.format(number), Trigger, self.on_ask)
        rospy.Subscriber('talk', String, self.on_talk, queue_size=3)
        self.proxies = [rospy.ServiceProxy('ask_{}'.format(other), Trigger) for other in (1, 2, 3)]

    def draw(self, longest):
        """Return a random number, which depends on the order of the draws."""
        self.count += 1
        return round(self.random.uniform(0.0, longest), 1)

    def on_talk(self, message):
        with self.lock:
            self.say('hears', message.data, self.draw(1.0))
            if self.random.random() < 0.3:
                rospy.sleep(self.draw(0.3))

    def on_ask(self, _request):
        rospy.sleep(self.draw(0.4))
        return TriggerResponse(True, str(self.draw(100.0)))

    def on_timer(self, _event):
        self.publisher.publish('timer {}'.format(self.draw(10.0)))

    def work(self, name):
        while rospy.get_time() < 8.0:
            rospy.sleep(self.draw(0.5))
            with self.lock:
                rospy.sleep(0.1)
                self.publisher.publish('{} {}'.format(name, self.draw(10.0)))
            self.say(name, self.count)


def _mixed(say, number):
    mixed = _Mixed(say, number)
    for other in (1, 2, 3):
        rospy.wait_for_service('ask_{}'.format(other))
    rospy.Timer(rospy.Duration(0.5), mixed.on_timer)
    threads = [threading.Thread(target=mixed.work, args=('{}{}'.format(name, number),)) for name in 'ab']
    for thread in threads:
        thread.start()
    while rospy.get_time() < 8.0:
        mixed.note.publish(mixed.random.choice(mixed.proxies)().message)
        say('note', rospy.wait_for_message('note', String).data)
        rospy.sleep(mixed.draw(0.8))
    for thread in threads:
        thread.join()
    rospy.sleep(2)


if __name__ == '__main__':
    play(globals())
