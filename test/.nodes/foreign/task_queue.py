#!/usr/bin/env python3
"""The queue of tasks of one robot, which it drives with move_base."""
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String


class TaskQueue:
    def __init__(self):
        self.robot = rospy.get_namespace().strip('/')
        self.tasks = []
        self.finished = False
        self.client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
        self.client.wait_for_server()
        self.done = rospy.Publisher('/done', String, queue_size=10)
        rospy.Subscriber('tasks', String, self.on_task)
        rospy.Subscriber('/finished', String, self.on_finished)

    def on_task(self, message):
        self.tasks.append(message.data)

    def on_finished(self, message):
        self.finished = True

    def run(self):
        rate = rospy.Rate(2)
        while not rospy.is_shutdown() and not self.finished:
            if self.tasks:
                _, x, y = self.tasks.pop(0).split()
                goal = MoveBaseGoal()
                goal.target_pose.header.frame_id = 'map'
                goal.target_pose.header.stamp = rospy.Time.now()
                goal.target_pose.pose.position.x = float(x)
                goal.target_pose.pose.position.y = float(y)
                goal.target_pose.pose.orientation.w = 1.0
                self.client.send_goal(goal)
                if not self.client.wait_for_result(rospy.Duration(12)):
                    self.client.cancel_goal()
                    self.done.publish('%s late' % self.robot)
                else:
                    self.done.publish('%s ok' % self.robot)
            rate.sleep()


if __name__ == '__main__':
    rospy.init_node('task_queue')
    TaskQueue().run()
