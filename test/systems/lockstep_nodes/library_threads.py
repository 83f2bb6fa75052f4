#!/usr/bin/env python3
"""Roles with threads of their own, and roles about the ends of nodes."""

import queue
import sys
import threading
import time

import rospy
from library_node import play
from std_msgs.msg import String
from std_srvs.srv import Trigger


def waits(say):
    """Wait in all ways that threads have, with time-outs."""
    box, event, semaphore = queue.Queue(), threading.Event(), threading.Semaphore(0)
    condition, lock = threading.Condition(), threading.Lock()

    def feed():
        rospy.sleep(1.5)
        box.put('in time')
        with lock:
            rospy.sleep(2)
        event.set()
        semaphore.release()
        with condition:
            condition.notify()
    thread = threading.Thread(target=feed)
    thread.start()
    try:
        box.get(timeout=1)
    except queue.Empty:
        say('empty')
    say('got', box.get(timeout=1))
    rospy.sleep(0.25)
    say('lock', lock.acquire(timeout=0.5), lock.acquire(timeout=10))
    say('event', event.wait(0.1), event.wait(), semaphore.acquire(timeout=1), semaphore.acquire(timeout=1))
    thread.join(1)
    say('joined', thread.is_alive())
    with condition:
        say('condition', condition.wait_for(lambda: False, timeout=0.75))


class SlowToEnd(threading.Thread):
    """A thread that Python takes long to end."""

    def _delete(self):
        time.sleep(0.05)
        super()._delete()


def joins(say):
    def live():
        rospy.sleep(2)
        say('thread')
    thread = SlowToEnd(target=live)
    thread.start()
    thread.join(0.5)
    say('alive', thread.is_alive())
    while thread.is_alive():
        rospy.sleep(0.4)
    say('ended')
    thread.join()
    say('joined')


def main_ends_first(say):
    def live():
        for _ in range(3):
            rospy.sleep(1)
            say('thread')
    threading.Thread(target=live).start()
    rospy.Timer(rospy.Duration(0.75), lambda event: say('timer'))
    say('main ends')


def stops_at_its_end(say):
    """Publish a last word in a hook at the end; what is due at that instant still happens."""
    publisher = rospy.Publisher('chat', String, queue_size=1)
    rospy.on_shutdown(lambda: publisher.publish('stop'))
    rospy.sleep(2)
    say('main ends')


def speaks_at_its_end(_say):
    """Publish a last word when the wait is interrupted."""
    publisher = rospy.Publisher('chat', String, queue_size=1)
    rospy.on_shutdown(lambda: publisher.publish('stop'))
    rospy.spin()


def listens(say):
    rospy.Subscriber('chat', String, lambda message: say('hears', message.data))
    rospy.spin()


def hears_the_end(say):
    rospy.Subscriber('chat', String, lambda message: say('hears', message.data))
    rospy.sleep(5)


def exits(_say):
    rospy.sleep(1)
    sys.exit(7)


def fails(_say):
    rospy.sleep(1)
    raise KeyError('the end')


def shuts_down(say):
    rospy.Timer(rospy.Duration(2), lambda event: rospy.signal_shutdown('enough'), oneshot=True)
    rospy.spin()
    say('never')


def speaks_too_late(_say):
    """Publish on a topic that the own end has closed, as threads with a heart beat do."""
    topic = rospy.Publisher('/late', String, queue_size=1)
    rospy.sleep(1)
    rospy.signal_shutdown('enough')
    topic.impl.close()
    topic.publish('never')


# Waits without end, to be interrupted.

def in_spin(_say):
    rospy.spin()


def in_sleep(_say):
    rospy.sleep(1e9)


def in_loop(_say):
    rate = rospy.Rate(1000)
    while not rospy.is_shutdown():
        rate.sleep()


def in_message(_say):
    rospy.wait_for_message('nothing', String)


def in_service(_say):
    rospy.wait_for_service('nothing')


def in_call(_say):
    rospy.Service('sleeps', Trigger, lambda request: rospy.sleep(1e9))
    rospy.ServiceProxy('sleeps', Trigger)()


def in_queue(_say):
    queue.Queue().get()


def in_event(_say):
    threading.Event().wait()


def in_join(_say):
    thread = threading.Thread(target=rospy.spin)
    thread.start()
    thread.join()


def in_thread(_say):
    threading.Thread(target=rospy.spin).start()


def stuck(_say):
    """Wait for ever without a look whether the node has ended, as some state machines do."""
    def wait():
        while True:
            threading.Event().wait(0.1)
    threading.Thread(target=wait, name='waits for ever').start()
    rospy.spin()


def works_on(_say):
    """Compute after the end, for longer than a wait would be allowed."""
    rospy.spin()
    until = time.monotonic() + 7.0
    while time.monotonic() < until:
        sum(range(1000))
    print('has ended its work', flush=True)


if __name__ == '__main__':
    play(globals())
