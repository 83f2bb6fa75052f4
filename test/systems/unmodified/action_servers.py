#!/usr/bin/env python3
"""Action servers of each kind in actionlib, for TestAction: a goal of n takes n seconds, and a negative goal fails."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestResult


class Executing:
    """A server with an execute_cb, which runs in a thread of its own."""

    def __init__(self):
        self.server = actionlib.SimpleActionServer('executing', TestAction, self.execute, auto_start=False)
        self.server.start()

    def execute(self, goal):
        if goal.goal < 0:
            self.server.set_aborted(TestResult(goal.goal), 'no')
            return
        rate = rospy.Rate(2)
        for i in range(2 * goal.goal):
            if self.server.is_preempt_requested():
                self.server.set_preempted(TestResult(i), 'stopped')
                return
            self.server.publish_feedback(TestFeedback(i))
            rate.sleep()
        self.server.set_succeeded(TestResult(goal.goal), 'done')


class Accepting:
    """A server with goal and pre-empt callbacks, and a timer for the work."""

    def __init__(self):
        self.end = None
        self.server = actionlib.SimpleActionServer('accepting', TestAction, auto_start=False)
        self.server.register_goal_callback(self.on_goal)
        self.server.register_preempt_callback(self.on_preempt)
        self.server.start()
        rospy.Timer(rospy.Duration(0.1), self.work)

    def on_goal(self):
        goal = self.server.accept_new_goal()
        print('%.9f accepted %d' % (rospy.get_time(), goal.goal))
        self.end = rospy.Time.now() + rospy.Duration(goal.goal)

    def on_preempt(self):
        print('%.9f pre-empt, new goal: %s' % (rospy.get_time(), self.server.is_new_goal_available()))
        if self.server.is_active():
            self.server.set_preempted()

    def work(self, event):
        if self.server.is_active() and rospy.Time.now() >= self.end:
            self.server.set_succeeded(TestResult(1))


class Handling:
    """A server with many goals at a time, by handles."""

    def __init__(self):
        self.server = actionlib.ActionServer('handling', TestAction, self.on_goal, self.on_cancel, auto_start=False)
        self.timers = {}
        self.server.start()

    def on_goal(self, handle):
        goal = handle.get_goal().goal
        if goal < 0:
            handle.set_rejected(None, 'never')
            return
        handle.set_accepted('at it')
        self.timers[handle.get_goal_id().id] = rospy.Timer(
            rospy.Duration(goal), lambda event: self.on_end(handle, goal), oneshot=True)

    def on_end(self, handle, goal):
        if handle.get_goal_id().id in self.timers:
            handle.set_succeeded(TestResult(goal), 'done')

    def on_cancel(self, handle):
        timer = self.timers.pop(handle.get_goal_id().id, None)
        if timer:
            timer.shutdown()
            handle.set_canceled(TestResult(-1), 'cancelled')


rospy.init_node('servers')
servers = [Executing(), Accepting(), Handling()]
rospy.spin()
