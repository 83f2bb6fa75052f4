#!/usr/bin/env python3
"""Have thread pools work and threads race, and publish the order of their results."""
import concurrent.futures
import multiprocessing.pool
import random
import threading
import time

import rospy
from std_msgs.msg import String

rospy.init_node('pools')
said = rospy.Publisher('said', String, queue_size=100)
rospy.Subscriber('said', String, lambda text: None)


def job(number):
    rospy.sleep(0.1 * (number * 7 % 3))
    return number, time.time(), random.random(), rospy.Time.now().to_nsec()


def say(*words):
    said.publish(' '.join(str(word) for word in words))


def race(name, shared):
    for _ in range(5):
        shared.append(name)
        time.sleep(0)
        if random.random() < 0.3:
            rospy.sleep(0.01)


with concurrent.futures.ThreadPoolExecutor(3) as pool:
    say(*pool.map(job, range(8)))
    futures = [pool.submit(job, number) for number in range(9)]
    for _ in range(2):  # while they end, then when all have ended
        say(*[future.result()[0] for future in concurrent.futures.as_completed(futures)])
    say(*[future.result()[0] for future in concurrent.futures.wait(futures).done])
with concurrent.futures.ThreadPoolExecutor(3) as pool:
    begin, came = rospy.get_time(), []
    futures = [pool.submit(rospy.sleep, 0.2 * number) for number in (1, 2, 3)]
    try:
        for future in concurrent.futures.as_completed(futures, timeout=0.5):
            came.append(futures.index(future))
    except concurrent.futures.TimeoutError:
        print('timeout after %.1f' % (rospy.get_time() - begin), came)
with multiprocessing.pool.ThreadPool(3) as pool:
    say(*pool.map(job, range(5)))
    say(*[result[0] for result in pool.imap_unordered(job, range(7))])
order = []
threads = [threading.Thread(target=race, args=(number, order)) for number in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
say(*order)
timer = threading.Timer(0.5, lambda: say('timer', time.monotonic()))
timer.start()
timer.join()
rospy.sleep(0.1)
