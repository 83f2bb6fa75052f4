#!/usr/bin/env python3
"""Say orders, texts and numbers that addresses of objects decide, each in a way in which people write it."""
import _thread
import asyncio
import collections
import concurrent.futures
import os
import random
import sys
import threading

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from slots import Slot
from std_msgs.msg import String
from std_srvs.srv import Empty

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), 'dist-packages'))
import keeper  # noqa: E402 - a library, as its folder's name says

Pair = collections.namedtuple('Pair', 'left right')


class Refusal(Exception):
    def __init__(self, number):
        super().__init__(number)
        self.number = number


def slots(count):
    made = []
    for number in range(count):
        made.append(Slot(number))
        junk = [object() for _ in range(number % 7)]  # noqa: F841 - takes addresses
        if number % 10 == 0:
            rospy.sleep(0.01)
    return made


def numbers(ordered):
    return [one.number for one in ordered]


def orders():
    many = slots(60)
    yield numbers(sorted(many[::-1], key=lambda slot: (slot.number % 3, id(slot))))  # a tie
    by_address = {id(slot): slot for slot in many[::-1]}
    yield numbers(by_address[key] for key in sorted(by_address))
    yield [key % 10007 for key in by_address]  # shown
    yield [slot.number for slot in {*many}]
    yield [refusal.number for refusal in {Refusal(number) for number in range(40)}]
    yield [go() for go in {slot.go for slot in many}]
    publishers = {rospy.Publisher('topic_%d' % number, String, queue_size=1) for number in range(20)}
    yield [publisher.name for publisher in publishers]
    yield keeper.names(publishers)
    yield keeper.names({publisher.publish for publisher in publishers})
    proxies = {rospy.ServiceProxy('service_%d' % number, Empty) for number in range(9)}
    yield [proxy.resolved_name for proxy in proxies]
    waits = [kind() for kind in (asyncio.Event, concurrent.futures.Future, random.Random) for _ in range(5)]
    yield [waits.index(wait) for wait in {*waits}], repr(waits[0])
    clients = [actionlib.SimpleActionClient('server_%d' % number, MoveBaseAction) for number in range(5)]
    yield [client.action_client.ns for client in sorted(clients[::-1], key=id)], keeper.names({*clients})
    yield [call() for call in {(lambda number=number: number) for number in range(30)}]  # functions
    yield str(many[5]), '%s' % many[6], f'{many[7]}', sorted(map(repr, many[::-1]))[0], repr(many[8].go)
    yield hash(many[1]), object.__hash__(many[2]), many[3].__hash__(), [*map(id, many[:2])]
    yield id(Pair(1, 2)), id(MoveBaseGoal()), [id(kind()) for kind in (type('Kind', (), {}) for _ in range(9))]
    yield threads(), sorted(heard) == [*heard], list(heard)


def threads():
    made = {}

    def make():
        for _ in range(9):
            rospy.sleep(0.003)
            one = Slot(threading.current_thread().name)
            made[id(one)] = one
            said.publish('from a thread')
    workers = [threading.Thread(target=make) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    rospy.sleep(0.1)
    return numbers(made[key] for key in sorted(made))


def make_beside():
    while not is_over.acquire(True, 0.001):  # by the wall clock
        Slot(0)


rospy.init_node('addressed')
is_over = _thread.allocate_lock()
is_over.acquire()
vars(threading)['_start_new_thread'](make_beside, ())  # Python's own function: this thread takes no turns
heard = {}
said = rospy.Publisher('said', String, queue_size=100)
rospy.Subscriber('said', String, lambda message: heard.setdefault(id(message), message))
for order in orders():
    print(order)
is_over.release()
