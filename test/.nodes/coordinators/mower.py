#!/usr/bin/env python3
"""Mows rows of 10 s and publishes its pose twice a second. It is an error if a row begins somewhere else."""
import rospy
from geometry_msgs.msg import Point, Pose2D
from std_msgs.msg import Int32

from move_base_abstract_ros import lockstep


def main():
    """Run until the last row is done."""
    rospy.init_node('mower')
    lockstep.join()
    orders = []
    poses = rospy.Publisher('pose', Pose2D, queue_size=10)
    done = rospy.Publisher('row_done', Int32, queue_size=10)
    rospy.Subscriber('rows', Point, orders.append)
    rospy.sleep(1.0)
    x = 0.0
    for row in range(4):
        poses.publish(x, 0.0, 0.0)
        done.publish(row)
        while not orders:
            rospy.sleep(0.5)
        order = orders.pop(0)
        if order.x != x:
            raise RuntimeError('row {} is to begin at {:.1f} m, the mower is at {:.1f} m'.format(row + 1, order.x, x))
        for step in range(1, 20):
            rospy.sleep(0.5)
            poses.publish(x + (order.y - x) * step / 20.0, 0.0, 0.0)
        rospy.sleep(0.5)
        x = order.y


if __name__ == '__main__':
    main()
