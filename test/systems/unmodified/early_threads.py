#!/usr/bin/env python3
"""Start threads before ROS, which do their work after rospy.init_node."""
import concurrent.futures
import random
import tempfile
import threading
import time

import rospy

NAME = 'stray'
lines = []
is_node = threading.Event()
began = threading.Semaphore(0)


def work(name):
    lines.append('%s %.3f %.6f' % (name, time.time(), random.SystemRandom().random()))
    began.release()
    is_node.wait()
    for _ in range(3):
        threading.Event().wait(0.3)
        lines.append('%s %.3f %.6f' % (name, time.time(), random.random()))


pool = concurrent.futures.ThreadPoolExecutor(1)
future = pool.submit(work, 'pool')
thread = threading.Thread(target=work, args=('thread',))
thread.start()
for _ in range(2):
    began.acquire()
tempfile.mkdtemp()
rospy.init_node(NAME)
is_node.set()
thread.join()
future.result()
print('\n'.join(lines))
