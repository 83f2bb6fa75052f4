#!/usr/bin/env python3
"""Say orders and values that would come from addresses of objects, if these were not hashed and shown by number."""
import os
import sys

import rospy
from std_msgs.msg import String

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), 'dist-packages'))
import keeper  # noqa: E402 - a library, as its folder's name says


class Robot:
    def __init__(self, number):
        self.number = number


def orders():
    robots = {Robot(number) for number in range(40)}
    seen = []
    any(seen.append(robot.number) for robot in robots)
    yield seen
    yield [robot.number for robot in robots]
    many = sorted(robots, key=lambda robot: robot.number)
    for key in (repr, str, '{}'.format, lambda robot: '%s' % robot, lambda robot: f'{robot}'):
        yield [robot.number for robot in sorted(many[::-1], key=key)]
    yield [hash(robot) % 7 for robot in many], hash(Robot(1)) % 7
    by_address = {id(robot): robot for robot in many}
    yield [robot.number for robot in by_address.values()], id(many[3]) in by_address
    kept = keeper.Keeper()
    for robot in many:
        kept.add(robot)
        junk = [object() for _ in range(robot.number % 7)]  # noqa: F841 - takes addresses
        rospy.sleep(0.01)
    yield kept.orders()


rospy.init_node('addresses')
said = rospy.Publisher('said', String, queue_size=100)
for order in orders():
    print(order)
    said.publish(str(order))
