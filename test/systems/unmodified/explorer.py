#!/usr/bin/env python3
"""Wait for frontiers and for a partner in loops without sleep, as hastily written programs do."""
import threading
import time

import rospy
from partner import Partner
from std_msgs.msg import Float64

frontiers = []
heard = 0


def on_frontier(message):
    global heard
    now = rospy.get_time()
    heard += 1
    if now != rospy.get_time():
        print('time went on in a callback')
    frontiers.append(message.data)


def watch():
    while True:
        if stop.is_set():
            break
    print('%.9f stopped' % rospy.get_time())


rospy.init_node('explorer')
rospy.Subscriber('/frontiers', Float64, on_frontier)
partner = Partner()
stop = threading.Event()
watcher = threading.Thread(target=watch)
watcher.start()
while len(frontiers) < 1:
    pass
print('%.9f frontier %.1f' % (rospy.get_time(), frontiers[0]))
word = partner.wait_for('come')
print('%.9f %s' % (rospy.get_time(), word))
stop.set()
while watcher.is_alive():
    continue
if rospy.get_param('~asks', False):
    partner.wait()
    print('%.9f %s' % (rospy.get_time(), partner.last))
if rospy.get_param('~computes', False):
    partner.wait_to_speak()
    print('%.9f %s' % (rospy.get_time(), partner.last))
while heard < 3000:
    time.sleep(0)
print('%.9f heard' % rospy.get_time())
while True:  # until another program ends the system
    pass
