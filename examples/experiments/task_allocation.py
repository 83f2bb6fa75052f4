#!/usr/bin/env python3
"""Gives tasks to robots as they arrive: a coordinator as anybody would write it, with the stock action client.

Tasks arrive as a Poisson process, each at a place and with a duration of its own, the same for every allocator.
A robot drives to its task, works on it, and takes the next one of its own queue. On /response_time: how long each
task took from its arrival to its end [s].
"""
import collections
import math
import random

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import Float64

SIDE = 40.0  # m
SPEED = 1.0  # m/s, as in the launch file
STARTS = ((0.0, 0.0), (40.0, 40.0), (0.0, 40.0), (40.0, 0.0), (20.0, 0.0), (20.0, 40.0), (0.0, 20.0), (40.0, 20.0))

Task = collections.namedtuple('Task', 'number arrival place duration')


def drawn_tasks(count, rate, duration, seed):
    """Return the tasks in the order of their arrival: exponential gaps and durations, places even in the square."""
    chance = random.Random(seed)
    tasks, arrival = [], 0.0
    for number in range(count):
        arrival += chance.expovariate(rate)
        place = (chance.uniform(0.0, SIDE), chance.uniform(0.0, SIDE))
        tasks.append(Task(number, arrival, place, chance.expovariate(1.0 / duration)))
    return tasks


class Robot:
    """One robot: its action client, its queue, and when and where it will be free as far as is known."""

    def __init__(self, number, done):
        self.number = number
        self.queue = collections.deque()
        self.task = None
        self.place = STARTS[number]  # of its last task
        self.free_at = 0.0  # s
        self._done = done
        self._client = actionlib.SimpleActionClient('/robot_{}/move_base'.format(number + 1), MoveBaseAction)

    def wait(self):
        """Wait for its server."""
        self._client.wait_for_server()

    def cost(self, task, now):
        """Return when it would have finished one more task, if it came last [s]."""
        way = math.hypot(task.place[0] - self.place[0], task.place[1] - self.place[1])
        return max(now, self.free_at) + way / SPEED + task.duration

    def take(self, task, now):
        """Put a task into its queue, and begin if it has nothing to do."""
        self.free_at, self.place = self.cost(task, now), task.place
        self.queue.append(task)
        if self.task is None:
            self._begin()

    def _begin(self):
        self.task = self.queue.popleft()
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = self.task.place
        goal.target_pose.pose.orientation.w = 1.0
        self._client.send_goal(goal, done_cb=self._arrived)

    def _arrived(self, state, _result):
        if state != GoalStatus.SUCCEEDED:
            rospy.logerr('robot %d did not reach task %d', self.number + 1, self.task.number)
        rospy.Timer(rospy.Duration(self.task.duration), self._finished, oneshot=True)

    def _finished(self, _event):
        task, self.task = self.task, None
        if self.queue:
            self._begin()
        self._done(task)


def round_robin(robots, task, _now):
    """One after the other, wherever they are."""
    return robots[task.number % len(robots)]


def nearest(robots, task, _now):
    """Whose last task is nearest, however much it has to do."""
    return min(robots, key=lambda robot: math.hypot(task.place[0] - robot.place[0], task.place[1] - robot.place[1]))


def auction(robots, task, now):
    """Who would have finished it first."""
    return min(robots, key=lambda robot: robot.cost(task, now))


ALLOCATORS = {'round_robin': round_robin, 'nearest': nearest, 'auction': auction}


class Coordinator:
    """Allocates each task when it arrives."""

    def __init__(self):
        self._allocate = ALLOCATORS[rospy.get_param('~allocator', 'nearest')]
        self._tasks = drawn_tasks(rospy.get_param('~tasks', 50), rospy.get_param('~rate', 0.05),
                                  rospy.get_param('~duration', 10.0), rospy.get_param('~seed', 0))
        self._response = rospy.Publisher('/response_time', Float64, queue_size=100)
        self._robots = [Robot(k, self._done) for k in range(rospy.get_param('~robots', 3))]
        self._begin = 0.0
        self._left = len(self._tasks)

    def run(self):
        """Run to the end of the last task."""
        for robot in self._robots:
            robot.wait()
        self._begin = rospy.get_time()
        for task in self._tasks:
            rospy.sleep(self._begin + task.arrival - rospy.get_time())
            now = rospy.get_time() - self._begin
            self._allocate(self._robots, task, now).take(task, now)
        while self._left:
            rospy.sleep(1.0)

    def _done(self, task):
        self._response.publish(rospy.get_time() - self._begin - task.arrival)
        self._left -= 1


def main():
    """Run the node."""
    rospy.init_node('coordinator')
    Coordinator().run()


if __name__ == '__main__':
    main()
