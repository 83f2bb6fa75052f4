#!/usr/bin/env python3
"""Have pools of processes work."""
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
    pool = multiprocessing.get_context('fork').Pool(2)
    print('%.9f %s' % (rospy.get_time(), pool.map(square, range(5))))
    pool.close()  # terminate() would wait for its processes, in which rospy catches SIGTERM
    pool.join()
    spawned = multiprocessing.get_context('spawn').Process(target=square, args=(2,))
    spawned.start()
    spawned.join()
    print('%.9f %s' % (rospy.get_time(), spawned.exitcode))
