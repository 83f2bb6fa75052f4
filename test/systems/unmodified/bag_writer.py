#!/usr/bin/env python3
"""Records a topic into a bag, and reads the bag at the end."""
import rosbag
import rospy
from std_msgs.msg import Float64

path = rospy.myargv()[1]
rospy.init_node('recorder')
bag = rosbag.Bag(path, 'w')
subscriber = rospy.Subscriber('numbers', Float64, lambda msg: bag.write('numbers', msg, rospy.Time.now()))
rospy.sleep(2.2)
subscriber.unregister()
bag.close()
with rosbag.Bag(path) as bag:
    for topic, msg, t in bag.read_messages():
        print('%.9f %s %.1f' % (t.to_sec(), topic, msg.data))
