#!/usr/bin/env python3
"""Counts the messages on each topic of the robots; a topic that it does not know is an error."""
import rospy
from std_msgs.msg import String

rospy.init_node('metrics')
counts = {}


def on_any(_message, topic):
    rospy.loginfo('%s: %d', topic, counts[topic])
    counts[topic] += 1


report = rospy.Publisher('/metrics', String, queue_size=10)
known = [topic for topic, _ in rospy.get_published_topics('/') if topic.startswith('/robot_')]
for topic in sorted(known):
    rospy.Subscriber(topic, rospy.AnyMsg, on_any, topic)
    rospy.loginfo('%s is counted', topic)
    counts[topic] = 0
rate = rospy.Rate(1.0)
while not rospy.is_shutdown():
    report.publish(' '.join('%s=%d' % item for item in sorted(counts.items())))
    try:
        rate.sleep()
    except rospy.ROSInterruptException:
        pass
