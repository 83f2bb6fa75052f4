#!/usr/bin/env python3
"""Drive to and fro, and wait without sleep for a flag, for the goal's state, for a time, for a listener."""
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String

arrived = False


def done(state, result):
    global arrived
    arrived = True


def goal_to(x):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = x
    goal.target_pose.pose.orientation.w = 1.0
    return goal


rospy.init_node('looking')
events = rospy.Publisher('/events', String, queue_size=10)
while events.get_num_connections() < 1:
    pass
print('%.9f heard' % rospy.get_time())
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()

client.send_goal(goal_to(2.0), done_cb=done)
while not rospy.is_shutdown():
    if arrived:
        break
print('%.9f by a flag' % rospy.get_time())
events.publish('there')

client.send_goal(goal_to(0.0))
while client.get_state() in (actionlib.GoalStatus.PENDING, actionlib.GoalStatus.ACTIVE):
    pass
print('%.9f by the state' % rospy.get_time())
events.publish('back')

end = rospy.Time.now() + rospy.Duration(0.25)
while rospy.Time.now() < end:
    pass
print('%.9f by the time' % rospy.get_time())
