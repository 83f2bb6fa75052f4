#!/usr/bin/env python3
"""Waits in the kernel for messages, again and again: for descriptors, sockets and locks, each with a time-out."""
import _thread
import multiprocessing
import queue
import select
import selectors
import socket
import time

import rospy
from std_msgs.msg import String

rospy.init_node('kernel_waits')
messages = []
rospy.Subscriber('greeting', String, messages.append)
ours, theirs = socket.socketpair()
ours.settimeout(0.25)
selector = selectors.DefaultSelector()
selector.register(ours, selectors.EVENT_READ)
poll = select.poll()
poll.register(ours, select.POLLIN)
epoll = select.epoll()
epoll.register(ours, select.EPOLLIN)
jobs, event, lock, mutex = multiprocessing.Queue(), multiprocessing.Event(), _thread.allocate_lock(), multiprocessing.Lock()
lock.acquire()
mutex.acquire()


def get():
    try:
        jobs.get(timeout=0.25)
    except queue.Empty:
        pass


def receive():
    try:
        ours.recv(1)
    except socket.timeout:
        pass


for name, wait in (('selector', lambda: selector.select(0.25)), ('poll', lambda: poll.poll(250)),
                   ('epoll', lambda: epoll.poll(timeout=0.25, maxevents=1)),
                   ('select', lambda: select.select([ours], [], [], 0.25)), ('recv', receive), ('queue', get),
                   ('event', lambda: event.wait(0.25)), ('mutex', lambda: mutex.acquire(timeout=0.25)),
                   ('lock', lambda: lock.acquire(timeout=0.25))):
    looks, count = 0, len(messages)
    while len(messages) == count:
        wait()
        looks += 1
    print('%s %.9f after %d looks' % (name, rospy.get_time(), looks))
theirs.send(b'x')
print(len(selector.select(0.25)), len(poll.poll(250)), len(select.select([ours], [], [], 0.25)[0]), ours.recv(1))
for n in range(40):  # a sleep for the rest of a time that is shorter than a nanosecond
    end = time.monotonic() + 0.001 * n
    while time.monotonic() < end:
        time.sleep(end - time.monotonic())
print('slept')
