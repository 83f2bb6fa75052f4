#!/usr/bin/env python3
"""Leaves objects in cycles that publish when they are finalized; one of them also waits then."""
import rospy
from std_msgs.msg import String

left = 30


class Litter:
    def __init__(self, number):
        self.number = number
        self.me = self

    def __del__(self):
        global left
        left -= 1
        last_words.publish('%d at %.9f' % (self.number, rospy.get_time()))
        print('%d at %.9f' % (self.number, rospy.get_time()))
        if self.number == 29:
            begin = rospy.get_time()
            rospy.sleep(0.25)
            print('waited %.2f' % (rospy.get_time() - begin))


rospy.init_node('litter')
last_words = rospy.Publisher('last_words', String, queue_size=100)
rospy.Subscriber('last_words', String, lambda text: None)
for i in range(30):
    Litter(i)
    for j in range(1000):  # so many that the collector would run
        cycle = []
        cycle.append(cycle)
print('at once %d' % (30 - left))
rate = rospy.Rate(10.0)
for _ in range(200):
    rate.sleep()
