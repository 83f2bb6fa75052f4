#!/usr/bin/env python3
"""Drives a robot to its tasks, one after the other, and waits if their feedback shows that others are near."""
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionFeedback, MoveBaseGoal
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger

rospy.wait_for_service('/study/settings')
settings = rospy.ServiceProxy('/study/settings', Trigger)().message
rospy.init_node('queue')
me = rospy.get_namespace().strip('/')
tasks, others, is_started, avoided = [], {}, False, 0


def on_start(_message):
    global is_started
    is_started = True


def on_feedback(message, name):
    others[name] = message.feedback.base_position.pose.position


def is_near(feedback):
    here = feedback.base_position.pose.position
    return any(abs(other.x - here.x) + abs(other.y - here.y) < 2.0 for other in others.values())


def on_my_feedback(feedback):
    global avoided
    if is_near(feedback) and not stopped:
        rospy.logwarn('%s: too near, wait', me)
        stopped.append(True)
        avoided += 1
        client.cancel_goal()


def drive(x, y):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.header.stamp = rospy.Time.now()
    goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
    goal.target_pose.pose.orientation.w = 1.0
    del stopped[:]
    client.send_goal(goal, feedback_cb=on_my_feedback)
    client.wait_for_result(rospy.Duration(120.0))
    return not stopped


stopped = []
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()
done = rospy.Publisher('done', Int32, queue_size=10)
ready = rospy.Publisher('/study/ready', String, queue_size=10)
rospy.Subscriber('tasks', String, lambda message: tasks.append(message.data.split()))
rospy.Subscriber('/study/start', String, on_start)
for number in range(3):
    if me != 'robot_%d' % number:
        rospy.Subscriber('/robot_%d/move_base/feedback' % number, MoveBaseActionFeedback, on_feedback,
                         'robot_%d' % number)
while not is_started and not rospy.is_shutdown():
    pass
rospy.loginfo('%s: %s', me, settings)
rospy.sleep(1.0)
ready.publish(me)
rate = rospy.Rate(5)
while not rospy.is_shutdown():
    if tasks:
        number, x, y = tasks.pop(0)
        tries = 0
        while not drive(float(x), float(y)) and tries < 3:
            tries += 1
            rospy.sleep(2.0 + len(me))
        rospy.loginfo('%s: task %s after %d waits', me, number, avoided)
        done.publish(int(number))
    try:
        rate.sleep()
    except rospy.ROSInterruptException:
        pass
