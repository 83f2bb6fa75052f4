#!/usr/bin/env python3
"""A script with all the habits that do not suit simulated time."""
import datetime
import multiprocessing
import os
import random
import socket
import subprocess
import time
import uuid
from time import sleep

import rospy
from std_msgs.msg import String


def child(number):
    os.write(1, b'child %d\n' % number)


rospy.init_node('habits')
pub = rospy.Publisher('said', String, queue_size=10)
heard = []
rospy.Subscriber('said', String, heard.append)
time.sleep(0.3)  # let them connect
pub.publish('hello')
for i in range(3):
    sleep(0.1)
print('%.9f heard %d' % (rospy.get_time(), len(heard)))
start = time.time()
stamp = datetime.datetime.now()
rng = random.Random()
listener = socket.socket()
listener.bind(('127.0.0.1', 0))
listener.listen(1)
connection = socket.create_connection(listener.getsockname())
print(subprocess.check_output(['echo', 'hi']).decode().strip())
process = multiprocessing.get_context('fork').Process(target=child, args=(7,))
process.start()
process.join()
elapsed = time.time() - start
for i in range(2):
    rospy.sleep(1.0)
    pub.publish('again')
rospy.sleep(0.5)
print('%.9f heard %d' % (rospy.get_time(), len(heard)))
print('id %s' % uuid.uuid4())
