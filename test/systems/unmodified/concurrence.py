#!/usr/bin/env python3
"""Run three states at the same time, each in a thread, until one of them ends the others; then do so again.

The program is written like concurrent states in libraries of state machines. The threads are no daemons and wait for an
event. Each stores its outcome under a condition. The main thread checks ten times a second whether they are alive.
"""
import threading

import rospy
from std_msgs.msg import Empty, String


class Concurrence:
    def __init__(self, states, is_over):
        self.states = states
        self.is_over = is_over
        self.ready = threading.Event()
        self.done = threading.Condition()
        self.outcomes = {}

    def run_state(self, name):
        self.ready.wait()
        outcome = self.states[name]()
        with self.done:
            self.outcomes[name] = outcome
            if self.is_over(self.outcomes):
                self.done.notify_all()

    def execute(self):
        threads = [threading.Thread(target=self.run_state, args=(name,)) for name in self.states]
        for thread in threads:
            thread.start()
        with self.done:
            self.ready.set()
            self.done.wait()
        stop.set()
        while not rospy.is_shutdown() and any(thread.is_alive() for thread in threads):
            with self.done:
                self.done.wait(0.1)
        return self.outcomes


def work(period, steps):
    for step in range(steps):
        if stop.is_set():
            return 'preempted at step %d' % step
        rospy.sleep(period)
        said.publish('%.3f %s' % (rospy.get_time(), period))
    return 'done'


def monitor():
    heard.clear()
    heard.wait()
    return 'heard'


def on_tick(_message):
    ticks.append(rospy.get_time())
    if len(ticks) % 6 == 0:
        heard.set()


rospy.init_node('concurrence')
stop, heard, ticks = threading.Event(), threading.Event(), []
said = rospy.Publisher('/said', String, queue_size=100)
rospy.Subscriber('/said', String, lambda message: None)
rospy.Subscriber('/tick', Empty, on_tick)
tick = rospy.Publisher('/tick', Empty, queue_size=10)
rospy.Timer(rospy.Duration(0.7), lambda event: tick.publish(Empty()))
for number in range(int(rospy.myargv()[1])):
    stop.clear()
    ended = Concurrence({'short': lambda: work(0.3, 3), 'long': lambda: work(0.5, 10 ** 9), 'monitor': monitor},
                        lambda outcomes: 'monitor' in outcomes).execute()
    print('%.3f %d %s' % (rospy.get_time(), number, sorted(ended.items())))
