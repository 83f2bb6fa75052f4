#!/usr/bin/env python3
"""Ask for time and chance in all ways whose answers are followed, before and after init_node; publish the answers."""
import concurrent.futures
import datetime as dates
import email.utils
import glob
import gzip
import io
import logging
import os
import pathlib
import queue
import random
import sched
import secrets
import select
import shutil
import sqlite3
import sys
import tempfile
import threading
import time
import uuid
from datetime import date, datetime
from time import monotonic, strftime

import numpy as np
import rospy
from std_msgs.msg import String

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), 'dist-packages'))
from dated import present  # noqa: E402


class Clock:
    read = time.time  # an attribute that takes no self


def seconds():
    return [time.time(), time.time_ns(), time.monotonic(), time.monotonic_ns(), time.perf_counter(),
            time.perf_counter_ns(), time.process_time(), time.process_time_ns(), time.thread_time(),
            time.thread_time_ns(), time.clock_gettime(time.CLOCK_REALTIME), time.clock_gettime(time.CLOCK_MONOTONIC),
            time.clock_gettime_ns(time.CLOCK_PROCESS_CPUTIME_ID), monotonic(), Clock().read()]


def dated():
    utc = dates.timezone.utc
    return [time.gmtime()[:6], time.localtime()[5], time.ctime()[-2:], time.asctime(time.gmtime()), time.asctime()[-4:],
            time.strftime('%S'), strftime('%Y', time.gmtime()), str(datetime.now(utc)), str(dates.datetime.utcnow()),
            datetime.now().second, datetime.today().microsecond, date.today().year, datetime.now(tz=utc).minute,
            gzip.compress(b'x')[4:8].hex(), email.utils.formatdate(),
            str(email.utils.localtime())[:19], present()]


def drawn():
    np.random.seed()
    numbers = [np.random.random(), np.random.default_rng().random(), np.random.RandomState().rand(),
               np.random.Generator(np.random.PCG64()).random(), np.random.SeedSequence().entropy]
    random.seed()
    numbers += [random.random(), random.Random().random(), random.SystemRandom().random(), secrets.token_hex(8),
                secrets.randbelow(1000), os.urandom(8).hex(), os.urandom(0), uuid.uuid1(), uuid.uuid4(), hash('text')]
    random.seed(time.time())
    numbers.append(random.random())
    random.seed(os.urandom(8))
    numbers.append(random.random())
    with sqlite3.connect(':memory:') as database:
        numbers += database.execute('SELECT random(), hex(randomblob(4))').fetchone()
    numbers.append(os.getrandom(8).hex())
    return [str(number) for number in numbers]


def itself():
    """Return what a program learns about its threads and the computer, and dates in logs and databases."""
    stream = io.StringIO()
    handler = logging.StreamHandler(stream)
    handler.setFormatter(logging.Formatter('%(asctime)s %(message)s'))
    log = logging.getLogger('mine')
    log.propagate = False
    log.handlers = [handler]
    log.warning('said')
    with sqlite3.connect(':memory:') as database:
        database.execute("CREATE TABLE told (at DEFAULT current_timestamp, day DEFAULT (date('now')), what)")
        database.execute("INSERT INTO told (what) VALUES (strftime('%H:%M:%f'))")
        row = database.execute("SELECT at, day, what, datetime('2001-02-03', '+1 day'), date(at) FROM told").fetchone()
    return [threading.Thread().name, threading.Thread(target=names).name, os.cpu_count(), stream.getvalue().strip(),
            row, concurrent.futures.ThreadPoolExecutor()._max_workers, repr(Clock()).partition(' at ')[0], str(memory())]


def memory():
    full = np.full(999, 7.0)
    del full
    return [float(np.empty(999).sum()), int(np.empty_like(np.ones(999), int).sum()), np.empty(1, dtype=object)[0]]


def names():
    folder = tempfile.mkdtemp()
    for name in ('b', 'c', 'a', 'ab'):
        open(os.path.join(folder, name), 'w').close()
    with tempfile.NamedTemporaryFile() as file, os.scandir(folder) as entries:
        told = [folder, file.name, os.listdir(folder), [entry.name for entry in entries],
                glob.glob(folder + '/*'), [path.name for path in pathlib.Path(folder).iterdir()],
                [found[2] for found in os.walk(folder)]]
    shutil.rmtree(folder)
    return told


def waits():
    """Wait in ways that time out; after each comes the reading of the monotonic clock."""
    told = []
    for wait in (lambda: queue.Queue().get(timeout=0.25), lambda: threading.Event().wait(0.125),
                 lambda: select.select([], [], [], 0.0625), lambda: time.sleep(0.03125), timed_futures, scheduled, spin):
        try:
            told.append(str(wait()))
        except queue.Empty:
            told.append('empty')
        told.append('%.6f' % time.monotonic())
    return told


def timed_futures():
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        futures = [pool.submit(rospy.sleep, pause) for pause in (0.5, 0.25)]
        try:
            return [futures.index(one) for one in concurrent.futures.as_completed(futures, timeout=0.375)]
        except concurrent.futures.TimeoutError:
            return rospy.get_time()


def scheduled():
    told = []
    scheduler = sched.scheduler(time.time, rospy.sleep)
    for pause in (0.2, 0.1):
        scheduler.enter(pause, 1, lambda pause=pause: told.append((pause, rospy.get_time())))
    scheduler.run()
    return told


def spin():
    end = time.time() + 0.01
    while time.time() < end:
        pass
    looked = rospy.get_time()
    end, steps = time.monotonic() + 0.002, 0
    while time.monotonic() < end:
        steps += 1
    return looked, steps, rospy.get_time()


early = [seconds(), dated(), drawn(), names(), itself()]
rospy.init_node('sources')
said = rospy.Publisher('said', String, queue_size=100)
rospy.Subscriber('said', String, lambda text: None)
rospy.sleep(1.5)
later = [seconds(), dated(), drawn(), names(), itself(), waits(), seconds()]
for line in early + later:
    said.publish(repr(line))
    print(repr(line))
    rospy.sleep(0.5)
