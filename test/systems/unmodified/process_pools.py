#!/usr/bin/env python3
"""Have pools of processes and single processes work."""
import concurrent.futures
import multiprocessing

import rospy


def square(number):
    return number * number


if __name__ == '__main__':
    rospy.init_node('process_pools')
    rospy.sleep(1.0)
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        print('%.9f %s' % (rospy.get_time(), list(pool.map(square, range(5)))))
    with multiprocessing.get_context('fork').Pool(2) as pool:  # at its end it ends its processes by SIGTERM
        print('%.9f %s' % (rospy.get_time(), pool.map(square, range(5))))
    forked = multiprocessing.get_context('fork').Process(target=multiprocessing.Semaphore(0).acquire)
    forked.start()
    forked.terminate()
    forked.join()
    print('%.9f %s' % (rospy.get_time(), forked.exitcode))
    spawned = multiprocessing.get_context('spawn').Process(target=square, args=(2,))
    spawned.start()
    spawned.join()
    print('%.9f %s' % (rospy.get_time(), spawned.exitcode))
