#!/usr/bin/env python3
"""Threads that wait for somebody outside who never comes, and one that is told something at last; one word a second."""
import multiprocessing
import os
import signal
import socket
import sys
import threading

import rospy
from std_msgs.msg import String

from move_base_abstract_ros.lockstep.waiting import outside

outside._LONGEST = 0.2  # 5 s for each of them are long for a test
rospy.init_node('waits_outside')
rospy.Subscriber('words', String, lambda word: print(word.data, flush=True))
words = rospy.Publisher('words', String, queue_size=10)
reader, writer = os.pipe()
nobody, _open = os.pipe()
os.dup2(nobody, 0)
server = socket.create_server(('127.0.0.1', 0))
server.settimeout(None)
lock = threading.Lock()


def told():
    with lock:
        assert os.read(reader, 1) == b'x'
    said = rospy.get_time()
    rospy.sleep(0.5)
    words.publish('heard')
    print('told %s, slept for %.9f' % (said >= 2.0, rospy.get_time() - said), flush=True)


def tell(_event):
    rospy.loginfo('one second more')
    print('%.9f' % rospy.get_time(), flush=True)
    if rospy.get_time() == 2.0:
        os.write(writer, b'x')


def read():
    with open(sys.argv[1]) as fifo:
        fifo.read()


def accept():
    server.accept()


def locks():
    with lock:
        print('locked', flush=True)


for wait in (told, sys.stdin.readline, read, accept, multiprocessing.Queue().get, locks):
    threading.Thread(target=wait, daemon=True).start()
rospy.Timer(rospy.Duration(1), tell)
rospy.on_shutdown(lambda: os._exit(0))
signal.pause()
