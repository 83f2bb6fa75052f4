#!/usr/bin/env python3
"""Print what Python and its library get from the machine, and what the program gets, beside its own C libraries."""
import ctypes
import os
import ssl
import subprocess
import sys
import threading
import time

import numpy
import rospy

ASK = """
import ctypes, os, time
print(any('_shim' in line for line in open('/proc/self/maps')), 'LD_PRELOAD' in os.environ, time.time() > 1.7e9,
      ctypes.CDLL(None).time(None) > 1.7e9)
"""


def main():
    rospy.init_node('native_needs')
    rospy.sleep(0.5)
    print(ssl.RAND_bytes(8).hex())
    print(subprocess.check_output([sys.executable, '-c', ASK], text=True).strip())
    child = os.fork()
    if child == 0:
        time.sleep(0.01)
        os._exit(ctypes.CDLL(None).usleep(1000))
    print(os.waitpid(child, 0)[1])
    lock = threading.Lock()
    lock.acquire()
    print(lock.acquire(timeout=0.25), rospy.get_time())
    print(numpy.datetime64('now'), numpy.datetime64('today'), ctypes.CDLL(None).time(None), time.time())


main()
