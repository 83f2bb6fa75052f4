#!/usr/bin/env python3
"""A behaviour tree of py_trees_ros: it drives its robot to each of ~corners [m, map frame] in turn, and waits there."""
import sys

import py_trees
import py_trees_ros
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

PERIOD_MS = 500


def main():
    """Tick the tree until the run is over."""
    rospy.init_node('tree')
    root = py_trees.composites.Sequence('round')
    for number, (x, y) in enumerate(rospy.get_param('~corners')):
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
        goal.target_pose.pose.orientation.w = 1.0
        root.add_child(py_trees_ros.actions.ActionClient('drive {}'.format(number), MoveBaseAction, goal,
                                                         action_namespace='move_base'))
        root.add_child(py_trees.timers.Timer('wait {}'.format(number), duration=3.0))
    tree = py_trees_ros.trees.BehaviourTree(root, record_rosbag=False)  # a bag's name is the date's second
    rospy.on_shutdown(tree.interrupt)
    if not tree.setup(timeout=15):
        sys.exit(1)
    tree.tick_tock(PERIOD_MS)


if __name__ == '__main__':
    main()
