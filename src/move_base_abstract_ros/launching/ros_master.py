"""A ROS master for one run: on a free port of 127.0.0.1, in a process forked from this one."""
import contextlib
import http.client
import os
import select
import signal
import sys
import time
import xmlrpc.client

from move_base_abstract.common import guard, processes
from move_base_abstract.common.errors import SimulatorError

from ..process.ros_master_watch import proxy_of

_START_S = 20.0  # wall
_ALIVE_S = 0.5  # wall
_ORPHANED_LOOKS = 3  # after its parent's end, while nodes unregister
_ANSWER_S = 20.0  # wall
_REGISTERED_S, _LOOK_S = 10.0, 0.01  # wall


class MasterError(SimulatorError):
    """The ROS master did not start, or refused a parameter."""


def start(output):
    """Start a ROS master; return (process id, URI). ``output``: the path of a file for its output.

    :raises MasterError: if it does not start within 20 s of wall time.
    """
    read, write = os.pipe()
    pid = processes.fork(lambda: _serve(read, write), output, ends_by=0 if guard.is_there() else signal.SIGKILL)
    os.close(write)
    try:
        ready, _, _ = select.select([read], [], [], _START_S)
        uri = os.read(read, 4096).decode() if ready else ''
    finally:
        os.close(read)
    if not uri:
        raise MasterError(f'the ROS master did not start; its output is in {output}')
    return pid, uri


def _serve(read, write):
    os.close(read)

    def tell(uri):
        os.write(write, uri.encode())
        os.close(write)
    serve(tell)


def serve(tell):
    """Be a ROS master until the end of the process, or soon after its parent's. Call ``tell(uri)`` when it answers."""
    from rosmaster.master import Master
    parent, looks = os.getppid(), 0
    master = Master(0)
    master.start()
    tell(master.uri)
    with contextlib.suppress(KeyboardInterrupt):
        while master.ok() and looks < _ORPHANED_LOOKS:
            time.sleep(_ALIVE_S)
            looks += os.getppid() != parent
    sys.exit(0)


def set_parameters(uri, parameters, cleared=()):
    """Set parameters, (key, value) pairs, in this order and in one call. :raises MasterError: if one cannot be set.

    cleared: names below which all parameters are deleted before.
    """
    master = proxy_of(uri, _ANSWER_S)
    calls = xmlrpc.client.MultiCall(master)
    for key, value in parameters:
        calls.setParam('/experiment', key, value)
    try:
        for name in cleared:
            if master.hasParam('/experiment', name)[2]:
                master.deleteParam('/experiment', name)
        for code, text, _ in calls():
            if code != 1:
                raise MasterError(f'a parameter cannot be set: {text}')
    except (OSError, http.client.HTTPException) as error:
        raise _silent(uri, error) from None
    except (TypeError, OverflowError, xmlrpc.client.Error) as error:
        raise MasterError(f'the parameters cannot be set: {error}') from None


def _silent(uri, error):
    return MasterError(f'the ROS master at {uri} does not answer: {error}; allowed: one that answers within '
                       f'{_ANSWER_S:g} s, over a loopback interface that is up (ip address show lo)')


def await_registered(uri, pid, name, statuses):
    """Wait until a ROS master knows the node ``name``, its process has ended, or 10 s of wall time are over.

    The time is limited because the node may wait for one that starts later. ``statuses`` gets the statuses of children
    that have ended, see processes.reap.
    """
    master, deadline = proxy_of(uri, _ANSWER_S), time.monotonic() + _REGISTERED_S
    while pid not in statuses and time.monotonic() < deadline:
        try:
            if master.lookupNode('/experiment', name)[0] == 1:
                return
        except (OSError, http.client.HTTPException) as error:
            raise _silent(uri, error) from None
        processes.reap(statuses)
        time.sleep(_LOOK_S)
