#!/usr/bin/env python3
"""Sends a robot from place to place, and to urgent places first. ~correct: without the bug.

The bug: with a new goal, the simple client forgets the last one. If the result of the last goal is under way, it is
lost, and the robot drives to that place once more.
"""
import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import Empty, Float64


def goal_at(x):
    """Return the goal at ``x`` [m] on the x axis."""
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = x
    goal.target_pose.pose.orientation.w = 1.0
    return goal


class Coordinator:
    """The coordinator of one robot."""

    def __init__(self):
        self.client = actionlib.SimpleActionClient('robot_1/move_base', MoveBaseAction)
        self.client.wait_for_server()
        self.open = [10.0, 20.0]
        self.place = None
        rospy.Subscriber('urgent', Float64, self.on_urgent)

    def run(self):
        """Send the robot from place to place until all are visited."""
        while self.open or self.place is not None:
            if self.place is None:
                self.send(self.open.pop(0))
            rospy.sleep(0.5)

    def send(self, place):
        """Send the robot to a place."""
        self.place = place
        self.client.send_goal(goal_at(place), done_cb=self.on_done)

    def on_urgent(self, message):
        """Send the robot to the urgent place first, and to its present place later."""
        if self.place is not None:
            self.open.insert(0, self.place)
        self.send(message.data)

    def on_done(self, _state, _result):
        """Note that the robot has no goal any more."""
        self.place = None


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it keeps a handle of each goal, so no result is lost."""

    def __init__(self):
        self.goals = actionlib.ActionClient('robot_1/move_base', MoveBaseAction)
        self.handles = {}
        super().__init__()

    def send(self, place):
        """Send the robot to a place."""
        self.place = place
        self.handles[place] = self.goals.send_goal(goal_at(place), transition_cb=self.on_transition)

    def on_transition(self, handle):
        """Go on when the present goal ends; if an earlier goal succeeds, do not drive to its place again."""
        if handle.get_comm_state() != actionlib.CommState.DONE:
            return
        place = next(place for place, kept in self.handles.items() if kept == handle)
        if handle.get_goal_status() == GoalStatus.SUCCEEDED and place in self.open:
            self.open.remove(place)
        if place == self.place:
            self.place = None


def main():
    """Run until all places are visited."""
    rospy.init_node('coordinator')
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    finished = rospy.Publisher('finished', Empty, queue_size=1, latch=True)
    coordinator.run()
    finished.publish()
    rospy.sleep(1.0)


if __name__ == '__main__':
    main()
