#!/usr/bin/env python3
"""Roles with actions, tf2 and message_filters, and nodes that do some of everything."""

import random
import threading

import actionlib
import message_filters
import rospy
import tf2_ros
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from geometry_msgs.msg import PointStamped, TransformStamped
from library_node import play
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse


def simple_server(say):
    def execute(goal):
        say('begins', goal.goal)
        for step in range(goal.goal):
            if server.is_preempt_requested():
                say('is preempted', step)
                server.set_preempted(TestResult(-step))
                return
            server.publish_feedback(TestFeedback(step))
            rospy.sleep(1)
        server.set_succeeded(TestResult(goal.goal * 10), 'done')
    server = actionlib.SimpleActionServer('work', TestAction, execute, auto_start=False)  # noqa: TID251 - the stock one
    rospy.sleep(0.5)
    server.start()
    rospy.sleep(30)
    rospy.signal_shutdown('its thread goes on for as long as the node does')


def simple_client(say):
    client = actionlib.SimpleActionClient('work', TestAction)
    say('server', client.wait_for_server(rospy.Duration(0.25)))
    say('server', client.wait_for_server())
    client.send_goal(TestGoal(3), feedback_cb=lambda feedback: say('feedback', feedback.feedback))
    say('result', client.wait_for_result(rospy.Duration(1.5)), client.wait_for_result(), client.get_result().result,
        client.get_state())
    say('again', client.send_goal_and_wait(TestGoal(2), rospy.Duration(10)), client.get_result().result)
    say('too long', client.send_goal_and_wait(TestGoal(5), rospy.Duration(1.75), rospy.Duration(3)),
        client.get_result().result)
    client.send_goal(TestGoal(5), done_cb=lambda state, result: say('done', state, result.result))
    rospy.sleep(1.25)
    client.cancel_goal()
    client.wait_for_result()
    say('end', client.get_state())


def two_at_once(say):
    """Send four goals by one ActionClient to a stock ActionServer, which ends each in a thread of its own."""
    client = actionlib.ActionClient('many', TestAction)
    say('server', client.wait_for_server(rospy.Duration(5)))
    open_goals = set()
    over = threading.Event()

    def on_transition(handle):
        if handle.get_comm_state() == actionlib.CommState.DONE:
            say('done', handle.get_result().result, handle.get_terminal_state())
            open_goals.discard(handle)
            if not open_goals:
                over.set()
    for number in (3, 1, 2, 2):
        open_goals.add(client.send_goal(TestGoal(number), on_transition))
    say('over', over.wait(20))


def many_server(_say):
    def work(handle):
        number = handle.get_goal().goal
        rospy.sleep(number)
        handle.set_succeeded(TestResult(number))

    def on_goal(handle):
        handle.set_accepted()
        threading.Thread(target=work, args=(handle,), daemon=True).start()
    actionlib.ActionServer('many', TestAction, on_goal, auto_start=False).start()
    rospy.sleep(10)


def _transform(parent, child, x):
    transform = TransformStamped()
    transform.header.stamp = rospy.Time.now()
    transform.header.frame_id, transform.child_frame_id = parent, child
    transform.transform.translation.x = x
    transform.transform.rotation.w = 1.0
    return transform


def broadcaster(_say):
    fixed, moving = tf2_ros.StaticTransformBroadcaster(), tf2_ros.TransformBroadcaster()
    fixed.sendTransform(_transform('map', 'odom', 10.0))
    rospy.sleep(1)
    rate = rospy.Rate(10)
    for step in range(30):
        moving.sendTransform(_transform('odom', 'base', 0.1 * step))
        rate.sleep()


def transformer(say):
    buffer = tf2_ros.Buffer()
    listener = tf2_ros.TransformListener(buffer)
    try:
        buffer.lookup_transform('map', 'base', rospy.Time(0), rospy.Duration(0.5))
    except tf2_ros.TransformException as error:
        say('error', type(error).__name__)
    found = buffer.lookup_transform('map', 'base', rospy.Time(2, 350000000), rospy.Duration(5))
    say('found', round(found.transform.translation.x, 6))
    say('can', buffer.can_transform('map', 'nowhere', rospy.Time(0), rospy.Duration(1)))
    assert listener is not None


def filtered(say):
    def on_both(first, second):
        say('both', first.point.x, second.point.x)
    synchronizer = message_filters.TimeSynchronizer(
        [message_filters.Subscriber('left', PointStamped), message_filters.Subscriber('right', PointStamped)], 10)
    synchronizer.registerCallback(on_both)
    rospy.sleep(5)


def _points(topic, pause, count):
    publisher = rospy.Publisher(topic, PointStamped, queue_size=1)
    point = PointStamped()
    for step in range(count):
        rospy.sleep(pause)
        point.header.stamp = rospy.Time.now()
        point.point.x = step
        publisher.publish(point)


def left(_say):
    _points('left', 0.5, 8)


def right(_say):
    _points('right', 1.0, 4)


# Some of everything, drawn from generators with fixed seeds. The drawn values depend on the order of events.

def mixed_1(say):
    _mixed(say, 1)


def mixed_2(say):
    _mixed(say, 2)


def mixed_3(say):
    _mixed(say, 3)


class _Mixed:
    """The state that the threads and callbacks of one node share."""

    def __init__(self, say, number):
        self.say = say
        self.random = random.Random(number)
        self.lock = threading.Lock()
        self.count = 0
        self.publisher = rospy.Publisher('talk', String, queue_size=2)
        self.note = rospy.Publisher('note', String, queue_size=1, latch=True)
        rospy.Service('ask_{}'.format(number), Trigger, self.on_ask)
        rospy.Subscriber('talk', String, self.on_talk, queue_size=3)
        self.proxies = [rospy.ServiceProxy('ask_{}'.format(other), Trigger) for other in (1, 2, 3)]

    def draw(self, longest):
        """Return a random number, which depends on the order of the draws."""
        self.count += 1
        return round(self.random.uniform(0.0, longest), 1)

    def on_talk(self, message):
        with self.lock:
            self.say('hears', message.data, self.draw(1.0))
            if self.random.random() < 0.3:
                rospy.sleep(self.draw(0.3))

    def on_ask(self, _request):
        rospy.sleep(self.draw(0.4))
        return TriggerResponse(True, str(self.draw(100.0)))

    def on_timer(self, _event):
        self.publisher.publish('timer {}'.format(self.draw(10.0)))

    def work(self, name):
        while rospy.get_time() < 8.0:
            rospy.sleep(self.draw(0.5))
            with self.lock:
                rospy.sleep(0.1)
                self.publisher.publish('{} {}'.format(name, self.draw(10.0)))
            self.say(name, self.count)


def _mixed(say, number):
    mixed = _Mixed(say, number)
    for other in (1, 2, 3):
        rospy.wait_for_service('ask_{}'.format(other))
    rospy.Timer(rospy.Duration(0.5), mixed.on_timer)
    threads = [threading.Thread(target=mixed.work, args=('{}{}'.format(name, number),)) for name in 'ab']
    for thread in threads:
        thread.start()
    while rospy.get_time() < 8.0:
        mixed.note.publish(mixed.random.choice(mixed.proxies)().message)
        say('note', rospy.wait_for_message('note', String).data)
        rospy.sleep(mixed.draw(0.8))
    for thread in threads:
        thread.join()
    rospy.sleep(2)


if __name__ == '__main__':
    play(globals())
