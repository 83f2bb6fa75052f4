#!/usr/bin/env python3
"""Make and give back objects of all kinds of classes, in turns and beside them, and see that nothing breaks."""
import abc
import collections
import copy
import ctypes
import datetime
import enum
import gc
import os
import pickle
import random
import threading
import tracemalloc
import weakref

import numpy
import rospy


class Slotted:
    __slots__ = ('a', '__weakref__')


class Cyclic:
    ended = 0

    def __init__(self):
        self.me = self

    def __del__(self):
        Cyclic.ended += 1


class Meta(type):
    def __call__(cls, *args):
        return super().__call__(*args)


class Made(metaclass=Meta):
    pass


class Large(ctypes.Structure):
    _fields_ = [('a', ctypes.c_int * 30000)]


class View(numpy.ndarray):
    pass


def derived(base, *values):
    return type('Derived', (base,), {})(*values)


def several(makers):
    return [random.choice(makers)() for _ in range(100)]


MAKERS = [Slotted, Cyclic, Made, Large, lambda: numpy.zeros(3).view(View), lambda: weakref.ref(Slotted()),
          lambda: derived(list, 'abc'), lambda: derived(tuple, range(random.randrange(9))), lambda: derived(float, 1.5),
          lambda: derived(int, random.getrandbits(random.randrange(1, 300))), lambda: derived(str, 'ä' * 50),
          lambda: derived(bytes, b'a' * 50), lambda: derived(set, 'abc'), lambda: derived(dict, {'a': 1}),
          lambda: derived(collections.OrderedDict, [(1, 2)]), lambda: derived(collections.deque, 'abc'),
          lambda: derived(OSError, 1, 'x'), lambda: derived(datetime.datetime, 2020, 1, 1), lambda: derived(abc.ABC),
          lambda: derived(Made), lambda: derived(threading.local), lambda: Meta('Kind', (), {})(),
          lambda: collections.namedtuple('Pair', 'a b')(1, 2), lambda: enum.Enum('Kind', 'A B').A,
          lambda: hash(lambda: 0), lambda: {Made().__init__, several}, lambda: copy.deepcopy([Slotted(), Made()]),
          lambda: pickle.loads(pickle.dumps(Made()))]
rospy.init_node('kinds')
random.seed(1)
is_over = threading.Event()


def beside(chance=random.Random(2)):
    while not is_over.is_set():
        [chance.choice(MAKERS)() for _ in range(20)]


for _ in range(2):
    vars(threading)['_start_new_thread'](beside, ())  # Python's own function: these threads take no turns
kept, figures = [], []
for number in range(120):
    kept += several(MAKERS)
    if len(kept) > 3000:
        random.shuffle(kept)
        del kept[random.randrange(2000):]
    if number % 20 == 0:
        gc.collect()
        rospy.sleep(0.1)
        with open('/proc/self/status') as status:
            figures.append(int(next(line for line in status if line.startswith('VmRSS:')).split()[1]))
    if number in (40, 60):
        (tracemalloc.start if number == 40 else tracemalloc.stop)()
    if number == 80 and os.fork() == 0:
        kept += several(MAKERS)
        del kept[:]
        gc.collect()
        os._exit(0)
is_over.set()
changed = Made()
changed.__class__ = type('Other', (), {})
del kept[:], changed
print('ended', Cyclic.ended > 100, os.wait()[1], figures[-1] < figures[1] * 1.5 + 50000)
