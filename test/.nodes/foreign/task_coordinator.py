#!/usr/bin/env python3
"""Publishes tasks as text, some at once and some when others are done."""
import random

import rospy
from std_msgs.msg import String

ROBOTS = ['robot_0', 'robot_1', 'robot_2']


def main():
    rospy.init_node('coordinator')
    total = rospy.get_param('~tasks', 30)
    publishers = {name: rospy.Publisher('/%s/tasks' % name, String, queue_size=1) for name in ROBOTS}
    finished = rospy.Publisher('/finished', String, queue_size=1, latch=True)
    rospy.sleep(1.0)  # let the connections come up

    sent = 0
    for name in ROBOTS:
        for _ in range(2):
            publishers[name].publish('goto %.1f %.1f' % (random.uniform(-20, 20), random.uniform(-20, 20)))
            sent += 1
            rospy.sleep(0.1)
    done = 0
    while done < total:
        message = rospy.wait_for_message('/done', String)
        done += 1
        robot, what = message.data.split()
        rospy.loginfo('%s: %s (%d of %d)', robot, what, done, total)
        if sent < total:
            publishers[robot].publish('goto %.1f %.1f' % (random.uniform(-20, 20), random.uniform(-20, 20)))
            sent += 1
    finished.publish('all %d tasks are done' % total)
    rospy.sleep(2.0)  # let all nodes hear it


if __name__ == '__main__':
    main()
