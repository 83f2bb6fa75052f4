#!/usr/bin/env python3
"""One thread for each robot, which drives its robot around and adds to a common list."""
import threading

import actionlib
import rospy
from geometry_msgs.msg import Point
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

lock = threading.Lock()
visited = []


def drive(name, places):
    client = actionlib.SimpleActionClient(name + '/move_base', MoveBaseAction)
    client.wait_for_server(rospy.Duration(10.0))
    for place in places:
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position = place
        goal.target_pose.pose.orientation.w = 1.0
        state = client.send_goal_and_wait(goal, execute_timeout=rospy.Duration(6.0))
        with lock:
            visited.append((name, place.x, state))
            print('%.9f %s is at %.1f (%d), %d so far' % (rospy.get_time(), name, place.x, state, len(visited)))
        rospy.sleep(1.0)


def main():
    rospy.init_node('threads')
    names = rospy.get_param('~robots')
    threads = []
    for i, name in enumerate(names):
        # all ways have the same length, so that they end at the same instant
        places = [Point(x=1.0 * k, y=10.0 * i) for k in (3, 1, 20)]
        threads.append(threading.Thread(target=drive, args=(name, places)))
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    print('%.9f %s' % (rospy.get_time(), [v[0] for v in visited]))


if __name__ == '__main__':
    main()
