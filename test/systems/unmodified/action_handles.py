#!/usr/bin/env python3
"""Follows several goals at once with actionlib.ActionClient."""
import actionlib
import rospy
from actionlib import CommState, TerminalState
from actionlib.msg import TestAction, TestGoal


def on_transition(handle):
    state = handle.get_comm_state()
    print('%.9f %s %s' % (rospy.get_time(), handle.comm_state_machine.action_goal.goal.goal, CommState.to_string(state)))
    if state == CommState.DONE:
        print('%.9f %s %s %r' % (rospy.get_time(), TerminalState.to_string(handle.get_terminal_state()),
                                 handle.get_result().result, handle.get_goal_status_text()))


rospy.init_node('handles')
client = actionlib.ActionClient('handling', TestAction)
client.wait_for_server()
handles = [client.send_goal(TestGoal(n), on_transition) for n in (3, 1, 5, -1, 2)]
rospy.sleep(0.5)
handles[4].cancel()
rospy.sleep(3.0)
client.cancel_all_goals()
while any(handle.get_comm_state() != CommState.DONE for handle in handles):
    rospy.sleep(0.01)
print('%.9f %s' % (rospy.get_time(), [handle.get_goal_status() for handle in handles]))
