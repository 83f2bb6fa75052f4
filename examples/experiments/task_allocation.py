#!/usr/bin/env python3
"""Gives tasks to robots as the tasks arrive: an ordinary coordinator, with the stock action client.

The tasks of /tasks are the same for every allocator. A robot drives to its task, works on it, and takes the next one of
its own queue. /response_time has the time from each task's arrival to its end [s].
"""
import collections
import math

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task

SPEED = 1.0  # m/s, as in the launch file


def distance(one, other):
    """Return the distance of two points [m]."""
    return math.hypot(one.x - other.x, one.y - other.y)


class Robot:
    """One robot: its action clients, its queue, and the expected time and place at which it will be free."""

    def __init__(self, name, done):
        self.queue = collections.deque()
        self.task = None
        self.free_at = 0.0  # s
        self._done = done
        self._drive = actionlib.SimpleActionClient('/{}/move_base'.format(name), MoveBaseAction)
        self._work = actionlib.SimpleActionClient('/{}/work'.format(name), PlaceTaskAction)
        self._drive.wait_for_server()
        self._work.wait_for_server()
        #: the place of its last task
        self.place = rospy.wait_for_message('/{}/base_pose_ground_truth'.format(name), Odometry).pose.pose.position

    def cost(self, task):
        """Return the expected time at which the robot would finish ``task``, if it came last in the queue [s]."""
        way = distance(task.pose.position, self.place)
        return max(rospy.get_time(), self.free_at) + way / SPEED + task.duration.to_sec()

    def take(self, task):
        """Put a task into the queue, and begin it if the robot is idle."""
        self.free_at, self.place = self.cost(task), task.pose.position
        self.queue.append(task)
        if self.task is None:
            self._begin()

    def _begin(self):
        self.task = self.queue.popleft()
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id, goal.target_pose.pose = self.task.header.frame_id, self.task.pose
        self._drive.send_goal(goal, done_cb=self._arrived)

    def _arrived(self, state, _result):
        if state == GoalStatus.SUCCEEDED:
            self._work.send_goal(PlaceTaskGoal(self.task), done_cb=self._finished)
        else:
            self._finished(state, None)

    def _finished(self, state, _result):
        task, self.task = self.task, None
        if state != GoalStatus.SUCCEEDED:
            rospy.logerr('task %s is not done: %s', task.id, GoalStatus.to_string(state))
        if self.queue:
            self._begin()
        self._done(task)


def round_robin(robots, _task, number):
    """Return the robots in turn, wherever they are."""
    return robots[number % len(robots)]


def nearest(robots, task, _number):
    """Return the robot whose last task is nearest, however much it has to do."""
    return min(robots, key=lambda robot: distance(task.pose.position, robot.place))


def auction(robots, task, _number):
    """Return the robot that would finish the task first."""
    return min(robots, key=lambda robot: robot.cost(task))


ALLOCATORS = {'round_robin': round_robin, 'nearest': nearest, 'auction': auction}


class Coordinator:
    """Gives each task to a robot when the task arrives."""

    def __init__(self):
        self._allocate = ALLOCATORS[rospy.get_param('~allocator', 'nearest')]
        self._response = rospy.Publisher('/response_time', Float64, queue_size=100)
        self._robots = [Robot('robot_{}'.format(number + 1), self._done)
                        for number in range(rospy.get_param('~robots', 3))]
        self._number = 0
        rospy.Subscriber('/tasks', Task, self._arrives, queue_size=100)

    def _arrives(self, task):
        self._allocate(self._robots, task, self._number).take(task)
        self._number += 1

    def _done(self, task):
        self._response.publish((rospy.Time.now() - task.header.stamp).to_sec())


def main():
    """Run the node."""
    rospy.init_node('coordinator')
    _coordinator = Coordinator()
    rospy.spin()


if __name__ == '__main__':
    main()
