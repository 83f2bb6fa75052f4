"""The warm process of `lockstep_launch`: it has imported what Python nodes import, and becomes each node by a fork.

It forks twice, and its client adopts orphans. So each node is a child of the client: the client gets its status, and
the node does not end with this process. If a fork cannot be the same as a Python that was started, the fork executes
the program. This process has one thread, and ends with its client.
"""
import contextlib
import functools
import gc
import importlib
import os
import select
import socket
import sys

from move_base_abstract.common import processes

from ..lockstep.programs import address_layout, native_library
from . import request, ros_master

_NODES = ('rospy', 'move_base_abstract_ros.lockstep.program', 'move_base_abstract_ros.nodes.lockstep_launcher')
_NAME = 'lockstep_launch: the warm process, which Python nodes are forked from'


def main(descriptor, launcher, has_master):
    """Serve until the client has gone, then return None. In a fork, return the function that the fork must call.

    descriptor: of the socket to the client; launcher: the path of our launcher; has_master: whether to start a ROS
    master first.
    """
    processes.die_with(os.getppid())
    if address_layout.choose(os.environ):  # start again, once, with one layout of memory, as the launcher does
        native_library.preload(os.environ)
        with open('/proc/self/cmdline', 'rb') as stream:
            os.execv(sys.executable, stream.read().split(b'\0')[:-1])
    processes.show_name('python3', _NAME)
    os.setsid()  # so that Ctrl-C does not reach it
    client = socket.socket(fileno=descriptor)
    become = _fork_master(client) if has_master else None
    return become or _serve(client, launcher)


def _fork_master(client):
    """Fork a ROS master, which sends its URI to the client. Return None; in the fork, the function that it calls."""
    importlib.import_module('rosmaster.master')
    if _fork():
        return None
    os.setsid()
    processes.show_name('rosmaster', 'rosmaster', '--core')
    os.environ.update(ROS_IP='127.0.0.1')
    os.environ.pop('ROS_HOSTNAME', None)
    processes.die_with(os.getppid())
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(nothing, number)

    def tell(uri):
        request.answer(client, [os.getpid(), uri])
        client.close()
    return lambda: ros_master.serve(tell)


def _serve(client, launcher):
    """Import what nodes import, and serve()."""
    for name in _NODES:
        importlib.import_module(name)
    from ..replacing.replaced import look_up
    from . import warm_nodes
    look_up()
    warm_nodes.log_settings()
    told = request.receive(client)
    for path in told.words if told is not None else ():
        warm_nodes.import_for(path, os.path.dirname(launcher))
    return serve(client, lambda asked: _become(asked, launcher))


def _become(asked, launcher):
    processes.show_name(os.path.basename(sys.executable if asked.words[0] == launcher else asked.words[0]),
                        sys.executable, *asked.words)
    from . import warm_nodes
    warm_nodes.be_or_start(asked.words, asked.environment, launcher)


def serve(client, become):
    """Fork for each request until the client has gone, then return None. In a fork, return the function that it calls.

    That function has no arguments, and calls ``become(request)``. Only forks read requests, so that they all begin with
    the same memory, whatever was started before.
    """
    gc.collect()
    gc.freeze()  # so that no garbage collection in a fork touches, and so copies, the present objects
    while True:
        select.select([client], [], [])
        taken, take = os.pipe()
        if _fork(taken):
            os.close(take)
            is_there = os.read(taken, 1)
            os.close(taken)
            if not is_there:
                return None
            continue
        asked = request.receive(client)
        if asked is None:
            os._exit(0)
        os.setsid()  # before the client knows the process to which it may send signals
        os.write(take, b'1')
        request.answer(client, os.getpid())
        client.detach()
        _be_started(asked)
        return functools.partial(become, asked)


def _fork(*not_for_fork):
    """Fork twice; return True in this process and False in the second fork, which goes on once it is an orphan.

    The second fork closes the descriptors ``not_for_fork``.
    """
    processes.assert_one_thread()
    gate, opener = os.pipe()
    first = os.fork()
    if first:
        os.waitpid(first, 0)
        os.close(gate)
        os.close(opener)
        return True
    if os.fork():
        os._exit(0)
    os.close(opener)
    with os.fdopen(gate, 'rb') as stream:
        stream.read()
    for descriptor in not_for_fork:
        os.close(descriptor)
    return False


def _be_started(asked):
    """Make this process like a program that has just started: its open files, working folder and outputs."""
    for target, output in zip((1, 2), asked.outputs):
        os.dup2(output, target)
    for name in os.listdir('/proc/self/fd'):
        with contextlib.suppress(OSError):
            if int(name) > 2:
                os.close(int(name))
    os.chdir(asked.cwd)
    processes.renew_outputs(asked.environment)
    multiprocessing = sys.modules.get('multiprocessing.process')
    if multiprocessing is not None:
        multiprocessing.ORIGINAL_DIR = asked.cwd
