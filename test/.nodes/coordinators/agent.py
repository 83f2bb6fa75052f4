#!/usr/bin/env python3
"""Does jobs of 5 s, one at a time, and ends the run after four jobs. It is an error if a job comes during another."""
import rospy
from std_msgs.msg import Empty, Int32, String


def main():
    """Run until four jobs are done."""
    rospy.init_node('agent')
    jobs = []
    state = rospy.Publisher('state', String, queue_size=10)
    ready = rospy.Publisher('ready', Empty, queue_size=10)
    rospy.Subscriber('work', Int32, jobs.append)
    rospy.sleep(1.0)
    for _ in range(4):
        state.publish('idle')
        ready.publish()
        while not jobs:
            rospy.sleep(0.5)
        job = jobs.pop(0)
        state.publish('works')
        rospy.sleep(5.0)
        if jobs:
            raise RuntimeError('got job {} while job {} was not done'.format(jobs[0], job))


if __name__ == '__main__':
    main()
