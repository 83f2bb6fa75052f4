"""Send one goal by a stock client and print its ending: 'STATE text'."""
import sys

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

# Only guards; the clock of the launch file runs at 10x.
SERVER_LIMIT = 200.0  # s, simulated
GOAL_LIMIT = 200.0  # s, simulated


def main():
    """Drive 3 m along x in the map frame."""
    rospy.init_node('install_space_client')
    client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
    if not client.wait_for_server(rospy.Duration(SERVER_LIMIT)):
        sys.exit('no action server move_base')
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = 3.0
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal(goal)
    if not client.wait_for_result(rospy.Duration(GOAL_LIMIT)):
        sys.exit('the goal did not end')
    print(GoalStatus.to_string(client.get_state()), client.get_goal_status_text())


main()
