#!/usr/bin/env python3
"""Sends goals with and without a feedback callback, and listens to poses, tf and status now and then."""
import actionlib
import rospy
from actionlib_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage


def say(what, *values):
    print('%.9f %s %s' % (rospy.get_time(), what, ' '.join(str(value) for value in values)))


def goal_at(x):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = x
    goal.target_pose.pose.orientation.w = 1.0
    return goal


def listen_for(seconds):
    """Listen to the topics of robot_1 for ``seconds``, from now on."""
    topics = (('/robot_1/odom', Odometry), ('/robot_1/amcl_pose', PoseWithCovarianceStamped))
    heard = [rospy.Subscriber(topic, kind, lambda message, topic=topic: say(
        topic, message.header.stamp, message.pose.pose.position.x)) for topic, kind in topics]
    heard.append(rospy.Subscriber('/robot_1/move_base/status', GoalStatusArray, lambda message: say(
        'status', message.header.stamp, len(message.status_list))))
    heard.append(rospy.Subscriber('/tf', TFMessage, lambda message: [say(
        'tf', transform.child_frame_id, transform.header.stamp, transform.transform.translation.x)
        for transform in message.transforms]))
    rospy.sleep(seconds)
    for subscriber in heard:
        subscriber.unregister()


if __name__ == '__main__':
    rospy.init_node('listener')
    clients = [actionlib.SimpleActionClient('/robot_%d/move_base' % i, MoveBaseAction) for i in range(2)]
    for client in clients:
        client.wait_for_server()
    for client in clients:
        client.send_goal(goal_at(9.5))
    for begins, seconds in ((3.35, 0.5), (6.0, 0.3), (7.2, 1.0)):
        rospy.sleep(begins - rospy.get_time() if begins > rospy.get_time() else 0.01)
        listen_for(seconds)
    for client in clients:
        client.wait_for_result()
    clients[0].send_goal(goal_at(0.25), feedback_cb=lambda feedback: say(
        'feedback', feedback.base_position.header.stamp, feedback.base_position.pose.position.x))
    clients[1].send_goal(goal_at(5.0))
    clients[0].wait_for_result()
    say('end', clients[0].get_state(), clients[1].get_state())
