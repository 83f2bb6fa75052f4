#!/usr/bin/env python3
"""Finds the robots by their topics, and gives each idle robot a task."""
import random

import rospy
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger, TriggerResponse


class Robot:
    """A robot. Robots are kept in a set, and compared as objects are."""

    def __init__(self, name):
        self.name = name
        self.tasks = rospy.Publisher('/%s/tasks' % name, String, queue_size=10)
        rospy.Subscriber('/%s/done' % name, Int32, self.on_done)

    def on_done(self, message):
        rospy.loginfo('%s: task %d is done', self.name, message.data)
        idle.add(self)
        done.append(message.data)


def on_ready(message):
    global is_ready
    rospy.loginfo('%s is ready', message.data)
    ready.append(message.data)
    is_ready = len(ready) >= len(robots)


rospy.init_node('coordinator')
rospy.loginfo('looking for robots')
idle, done, ready, robots, is_ready = set(), [], [], [], False
rospy.Service('/study/settings', Trigger, lambda _request: TriggerResponse(True, 'speed 1.0'))
names = {topic.split('/')[1] for topic, _ in rospy.get_published_topics() if topic.startswith('/robot_')}
numbers = sorted(int(name.split('_')[1]) for name in names)
robots = [Robot('robot_%d' % number) for number in numbers]
rospy.loginfo('%d robots', len(robots))
idle.update(robots)
rospy.Subscriber('/study/ready', String, on_ready)
start = rospy.Publisher('/study/start', String, queue_size=1, latch=True)
start.publish('go')
while not is_ready and not rospy.is_shutdown():
    pass
rospy.loginfo('all robots are ready')
given, total = 0, rospy.get_param('/tasks')
while len(done) < total and not rospy.is_shutdown():
    if idle and given < total:
        robot = next(iter(idle))
        idle.discard(robot)
        x, y = random.uniform(0.0, 20.0), random.uniform(0.0, 20.0)
        rospy.loginfo('task %d for %s', given, robot.name)
        robot.tasks.publish('%d %f %f' % (given, x, y))
        given += 1
rospy.loginfo('%d tasks in %.1f s', len(done), rospy.get_time())
