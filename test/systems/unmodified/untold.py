#!/usr/bin/env python3
"""Make all calls whose results differ from run to run."""
import collections
import ctypes
import getpass
import logging
import multiprocessing
import os
import platform
import random
import resource
import select
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import uuid
import xmlrpc.client

import rosgraph
import rosparam
import rospy
from std_msgs.msg import String


class Slot:
    __slots__ = ()


def connect():
    listener = socket.socket()
    listener.bind(('127.0.0.1', 0))
    listener.listen(1)
    return socket.create_connection(listener.getsockname())


def fork():
    child = multiprocessing.get_context('fork').Process(target=time.time)
    child.start()
    child.join()


def fork_at_a_terminal():
    child, terminal = os.forkpty()
    if child == 0:
        os._exit(0)
    os.waitpid(child, 0)
    os.close(terminal)


def handled(pipe=os.pipe()):
    os.write(pipe[1], b'x')
    return select.select([pipe[0]], [], [], 1.0)


def execute():
    sys.stdin = open(os.devnull)
    try:
        os.execv('/nowhere/to/be/found', ['found'])
    except OSError:
        pass


def ask():
    try:
        return input()
    except EOFError:
        return ''


def interrupted():
    signal.signal(signal.SIGALRM, signal.SIG_IGN)
    signal.setitimer(signal.ITIMER_REAL, 0.01)
    signal.alarm(1)


def by_texts():
    pairs = [(threading.Lock(), 1), (threading.Lock(), 2)]
    return (sorted(pairs, key=str), '%s' % (pairs[0],), f'{pairs}', '{}'.format(connect), list(map(repr, pairs)),
            str(threading.current_thread()))


def by_keys():
    kept = {id(rospy): 1, id(sys): 2}
    asked = collections.defaultdict(list)
    asked[id(rospy)].append(1)
    return (sorted(kept),  # by id(rospy)
            '%d' % list(kept)[0],  # the id
            random.Random(next(iter(kept))), int(next(iter(kept))),  # the id
            sum(asked),  # by id
            id(rospy) < id(sys))


def by_numbers():
    uri = rospy.get_node_uri()
    master = rosgraph.Master('/untold')
    return (multiprocessing.current_process().pid,
            threading.current_thread().native_id, sorted([threading.current_thread().ident, 2]),
            xmlrpc.client.ServerProxy(uri).getBusStats('/untold'),
            xmlrpc.client.ServerProxy(uri).getSubscriptions('/untold'),
            logging.Formatter('%(process)d %(message)s'),
            os.path.realpath('/proc/self'),
            master.getPid(), rospy.get_master().getPid())


def by_hash():
    return sorted([Slot(), Slot()], key=hash)


def by_name():
    return (object.__hash__(rospy),
            threading.Lock().__hash__(), 'text'.__hash__())


def listed():
    return os.listdir('/proc')


def by_rosparam():
    try:
        return rosparam.get_param('/run_id')
    except rosgraph.MasterError:
        return ''


WAYS = {
    'os.getpid': lambda: os.getpid(), 'os.getppid': lambda: os.getppid(), 'os.times': lambda: os.times(),
    'os.getloadavg': lambda: os.getloadavg(), 'resource.getrusage': lambda: resource.getrusage(resource.RUSAGE_SELF),
    'signal.setitimer signal.alarm': interrupted, 'select.select': handled, 'select.poll': lambda: select.poll(),
    'signal.sigtimedwait': lambda: signal.sigtimedwait([signal.SIGUSR1], 0.01),
    'select.epoll': lambda: select.epoll(), 'id id id id id id': lambda: ('%d' % id(rospy), by_keys()),
    'multiprocessing.process.BaseProcess.pid threading.Thread.native_id id rospy.get_node_uri getBusStats': by_numbers,
    'xmlrpc.client.ServerProxy logging.Formatter open getPid': str,  # by the function before
    'repr str str format f-string %': by_texts,
    'hash hash hash hash': lambda: (hash(threading.Lock()), by_hash(), by_name()),
    'open open os.getpid': lambda: (open('/proc/%d/stat' % os.getpid()).read(1), listed()),
    'os.system': lambda: os.system('true'),
    'os.exec': execute, 'builtins.input': ask,
    'subprocess.Popen': lambda: subprocess.check_output(['date', '+%N']), 'os.fork': fork,
    'os.forkpty': fork_at_a_terminal,
    'os.posix_spawn': lambda: os.waitpid(os.posix_spawn('/bin/true', ['true'], {}), 0),
    'socket.bind socket.connect': connect, 'os.getpgrp': lambda: os.getpgrp(),
    'threading.get_native_id': lambda: threading.get_native_id(), 'threading.enumerate': lambda: threading.enumerate(),
    'threading.active_count': lambda: threading.active_count(), 'socket.gethostname': lambda: socket.gethostname(),
    'threading.get_ident': lambda: '%d' % threading.get_ident(), 'socket.getfqdn': lambda: socket.getfqdn('a b'),
    'platform.node': lambda: platform.node(), 'os.uname': lambda: os.uname(),
    'getpass.getuser': lambda: getpass.getuser(), 'uuid.getnode': lambda: uuid.getnode(),
    'os.sched_getaffinity': lambda: os.sched_getaffinity(0),
    'shutil.disk_usage': lambda: shutil.disk_usage('/'), 'os.path.getmtime': lambda: os.path.getmtime('/'),
    'os.path.getctime': lambda: os.path.getctime('/'), 'os.path.getatime': lambda: os.path.getatime('/'),
    'os.stat': lambda: os.stat('/').st_mtime, 'rospy.get_param rospy.get_param': lambda: (rospy.get_param('/run_id', ''), by_rosparam()),
    'ctypes.dlsym': lambda: ctypes.CDLL('libc.so.6').time(None),
}
EARLY = ('os.getpid', 'open open os.getpid')  # before the program is a node


def main():
    for what in EARLY:
        WAYS[what]()
    rospy.init_node('untold')
    said = rospy.Publisher('said', String, queue_size=100)
    for what in WAYS:
        WAYS[what]()
        said.publish(what)
    assert socket.getfqdn('127.0.0.1') == 'localhost'  # no label: it is the same everywhere
    seen = {id(said): 1}
    print(id(said) in seen, hash('text') == hash('text'))


main()
