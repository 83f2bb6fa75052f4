#!/usr/bin/env python3
"""Show addresses of objects to which no arena belongs."""
import os.path
import threading

import rospy


class Own:
    __slots__ = ()


def function():
    pass


rospy.init_node('unplaced')
own = [Own() for _ in range(9)]
print(sorted(map(id, own)), [one.__name__ for one in {function, os.path.join}])
print([type(one) for one in {*own}])
print(id([]))  # labelled
print(id(threading.Lock()))  # labelled
print([one.name for one in {threading.Thread() for _ in range(9)}])  # labelled
print(id(Own))  # labelled
text = str(function)  # labelled
print([one for one in {print, len}])  # labelled
print(function.__hash__() % 7)  # labelled
# A thread without turns gives one back, and few objects keep much memory.
box = [Own()]
vars(threading)['_start_new_thread'](box.clear, ())
while box:
    pass
few = [Own() for _ in range(400000)][::100]
print(len([Own() for _ in range(100000)]))
rospy.sleep(1.0)
