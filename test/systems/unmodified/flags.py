#!/usr/bin/env python3
"""Drive to a place and back; callbacks set flags, and the main loop reads them."""
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String

arrived = False
feedbacks = 0


def done(state, result):
    global arrived
    arrived = True


def feedback(fb):
    global feedbacks
    feedbacks += 1


def go_to(client, x):
    global arrived
    arrived = False
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.header.stamp = rospy.Time.now()
    goal.target_pose.pose.position.x = x
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal(goal, done_cb=done, feedback_cb=feedback)
    looks = 0
    while not arrived and not rospy.is_shutdown():
        rospy.sleep(0.05)
        looks += 1
    return looks


rospy.init_node('flags')
pub = rospy.Publisher('/events', String, queue_size=10)
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()
for x in [2.0, 0.0]:
    looks = go_to(client, x)
    print('%.9f at %.1f after %d looks' % (rospy.get_time(), x, looks))
    pub.publish('%s at %.1f' % (rospy.get_name(), x))
print('feedbacks: %d' % feedbacks)
