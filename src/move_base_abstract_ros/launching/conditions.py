"""Conditions that must not change a run. `verify` changes them from one run to the next."""
import os
import subprocess
import sys
from contextlib import contextmanager
from typing import NamedTuple

from ..lockstep.participation.report_delays import VARIABLE as DELAY

LAYOUT = 'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT'  # read by the launcher of unmodified programs
LIMIT = 50.0  # times real time, the lowest speed limit
_LONGEST_LIMITED = 60.0  # s, wall
_DELAY = '1:4'  # seed, ms; it is short because dense systems report a hundred thousand times
_HASH_SEED = '1'
# A program that keeps a core busy. It ends by itself when the process that started it has gone.
_BUSY = 'import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    for _ in range(100000): pass\n'


class Condition(NamedTuple):
    """One way to run a system.

    ``what``: the condition in words. ``points_at``: the likely cause if a run differs under this condition, but not
    under those before it.
    """

    name: str
    what: str
    points_at: str
    options: tuple = ()  # of lockstep_launch
    environment: tuple = ()  # (name, value)
    is_busy: bool = False
    is_limited: bool = False
    with_messages: bool = True  # whether messages are compared; not if senders have other names


_FAST = 'the result depends on how fast the machine is: a program reads the wall clock, or waits by it'
CONDITIONS = (
    Condition('plain', 'as it is', ''),
    Condition('again', 'as it is, once more', 'chance or time from outside: random numbers, the wall clock, addresses '
              '(sets of objects), process ids, files of the run before, the order in which nodes have registered with '
              'the ROS master (if a node asks it for topics, nodes or parameters), another run beside this one '
              '(files in /tmp, shared memory, ports)'),
    Condition('order', 'nodes start one after another, the last of the launch file first',
              'the result depends on the order in which nodes have registered with the ROS master: a program asks it '
              'which topics, services, nodes or parameters there are, and goes by their order',
              options=('--start-order', 'reversed')),
    Condition('busy', 'every core busy', _FAST, is_busy=True),
    Condition('limited', 'limited to {:g} times real time'.format(LIMIT), _FAST, is_limited=True),
    Condition('delays', 'random wall delays before reports',
              'the order of arrival matters somewhere: nodes talk past lockstep (files, sockets, parameters)',
              environment=((DELAY, _DELAY),)),
    Condition('hash', "other hash seed of this package's own nodes",
              'an error of this package: something in it has an order that is not defined; please report it',
              options=('--own-hash-seed', _HASH_SEED)),
    Condition('addresses', 'another address layout',
              'an order by addresses: sets or dicts of objects that are iterated, id(), pointers that are compared',
              environment=((LAYOUT, 'random'),)),
    Condition('split', 'the fleet in two processes; messages are not compared',
              'an error of this package, or a node that depends on names of processes',
              options=('--parts', '2'), with_messages=False),
)
NAMES = tuple(condition.name for condition in CONDITIONS)


def limit_for(simulated):
    """Return the speed limit for a run of ``simulated`` seconds, so that it takes a minute of wall time at most."""
    return max(LIMIT, simulated / _LONGEST_LIMITED)


@contextmanager
def busy(count=os.cpu_count() or 1):
    """Keep ``count`` cores busy inside the context; by default every core."""
    processes = [subprocess.Popen([sys.executable, '-c', _BUSY]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()
