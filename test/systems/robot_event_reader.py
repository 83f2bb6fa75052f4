#!/usr/bin/env python3
"""Send robots goals; the next goal of each depends on the ~events of the other."""
import rospy
from geometry_msgs.msg import PoseStamped

from move_base_abstract.msg import RobotEvent

PLACES = [(3.0, 0.0), (3.0, 4.0), (0.0, 4.0), (0.0, 0.0)]


def send(robot):
    goal = PoseStamped()
    goal.header.frame_id = 'map'
    goal.pose.position.x, goal.pose.position.y = PLACES[sent[robot] % len(PLACES)]
    goal.pose.orientation.w = 1.0
    sent[robot] += 1
    goals[robot].publish(goal)


def on_event(event):
    print(event.stamp.to_nsec(), event.robot, event.kind, list(event.texts), list(event.numbers))
    if event.kind == 'ended':
        send('robot_1' if event.robot == 'robot_0' else 'robot_0')


rospy.init_node('event_reader')
sent = {'robot_0': 0, 'robot_1': 2}
goals = {robot: rospy.Publisher('/{}/move_base_simple/goal'.format(robot), PoseStamped, queue_size=5) for robot in sent}
rospy.Subscriber('/fleet/events', RobotEvent, on_event, queue_size=1000)
rospy.sleep(1.0)
send('robot_0')
rospy.spin()
