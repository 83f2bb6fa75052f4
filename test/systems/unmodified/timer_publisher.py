#!/usr/bin/env python3
"""Publishes a battery level from a Timer; another node charges the battery by a topic."""
import rospy
from std_msgs.msg import Float32, Empty


class Battery:
    def __init__(self):
        self.level = 1.0
        self.pub = rospy.Publisher('battery', Float32, queue_size=1)
        rospy.Subscriber('charge', Empty, self.charge)
        rospy.Timer(rospy.Duration(0.25), self.drain)
        rospy.Timer(rospy.Duration(1.0), self.publish)

    def drain(self, event):
        self.level -= 0.01
        assert event.current_real == rospy.Time.now()

    def publish(self, event):
        self.pub.publish(self.level)
        print('%.9f expected %.9f level %.2f' % (
            event.current_real.to_sec(), event.current_expected.to_sec(), self.level))

    def charge(self, msg):
        print('%.9f charged' % rospy.get_time())
        self.level = 1.0


if __name__ == '__main__':
    rospy.init_node('battery')
    battery = Battery()
    rospy.spin()
