#!/usr/bin/env python3
"""Calls all methods of a SimpleActionClient."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestGoal
from actionlib_msgs.msg import GoalStatus


def say(what, *values):
    print(' '.join(['%.9f' % rospy.get_time(), what] + [str(value) for value in values]))


def result(client):
    r = client.get_result()
    return '%s %s %r' % (GoalStatus.to_string(client.get_state()), r and r.result, client.get_goal_status_text())


rospy.init_node('client')
nobody = actionlib.SimpleActionClient('nobody', TestAction)
say('server', nobody.wait_for_server(rospy.Duration(2.0)))
name = rospy.get_param('~server')
client = actionlib.SimpleActionClient(name, TestAction)
say('server', client.wait_for_server())
say('no goal', client.wait_for_result(), client.get_state())

say('and wait', client.send_goal_and_wait(TestGoal(2)), result(client))
say('not in time', client.send_goal_and_wait(TestGoal(9), rospy.Duration(1.2), rospy.Duration(2.0)), result(client))

client.send_goal(TestGoal(3), done_cb=lambda state, r: say('done_cb', state, r.result),
                 active_cb=lambda: say('active_cb'), feedback_cb=lambda f: say('feedback_cb', f.feedback))
say('in time', client.wait_for_result(rospy.Duration(1.25)), result(client))
say('in time', client.wait_for_result(rospy.Duration(5.0)), result(client))

client.send_goal(TestGoal(9))
rospy.sleep(0.6)
client.cancel_goal()
client.wait_for_result()
say('cancelled', result(client))

client.send_goal(TestGoal(9))
rospy.sleep(0.6)
client.cancel_all_goals()
client.wait_for_result()
say('all cancelled', result(client))

client.send_goal(TestGoal(9))
rospy.sleep(0.6)
client.cancel_goals_at_and_before_time(rospy.Time.now())
client.wait_for_result()
say('cancelled by time', result(client))

client.send_goal(TestGoal(5))
rospy.sleep(1.0)
client.send_goal(TestGoal(1))
client.wait_for_result()
say('replaced', result(client))

client.send_goal(TestGoal(1), done_cb=lambda state, r: say('never said'))
client.stop_tracking_goal()
say('not followed', client.get_state(), client.wait_for_result(rospy.Duration(1.0)))
rospy.sleep(2.0)

client.send_goal(TestGoal(-3))
client.wait_for_result()
say('refused', result(client))
