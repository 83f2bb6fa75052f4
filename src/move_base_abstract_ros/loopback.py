"""Start a ROS master of our own on 127.0.0.1, and nodes that use it.

All programs that start ROS nodes by themselves (demo, benchmarks, tests) use this. It never talks to a master that is
already running: the port is free when it is chosen, and every process, including the caller (adopt), gets its URI.

    with Loopback() as ros:
        ros.adopt()
        ros.run('time_master', 'time_master', parameters={'factor': 20.0})
        ros.run('move_base', 'move_base', namespace='/robot_0', parameters={'max_speed': 2.0})
        rospy.init_node('caller', disable_signals=True)
        ...
        ros.check()  # raises ChildEnded if a node has died

Threading: not thread-safe. Start the children from the main thread: the kernel ends them when that thread ends.
"""
from __future__ import annotations

import http.client
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import xmlrpc.client
from typing import TYPE_CHECKING, Any, BinaryIO, Dict, List, Mapping, Optional, Sequence, Type, Union

import rosgraph
import rospkg
from roslib import packages

from move_base_abstract.common import guard, processes, temporary

if TYPE_CHECKING:
    from move_base_abstract.common.processes import Forked

PACKAGE = 'move_base_abstract'
MASTER_TRIES = 3  # another process may take the free port before the master binds it
MASTER_TIMEOUT = 20.0  # s, wall
END_TIMEOUT = 15.0  # s, wall, from the polite signal to SIGKILL; as roslaunch's. A log is written in it
LOG_LINES = 12  # number of last lines that are shown of a child that died


class LoopbackError(RuntimeError):
    """The master or a node could not be started."""


class ChildEnded(LoopbackError):
    """A child process ended while it was still needed. The text names it and quotes its last lines."""


class Child:
    """One process that Loopback has started. ``log_path``: the file that takes its output."""

    def __init__(self, name: str, process: Forked, log_path: str) -> None:
        """process: a subprocess.Popen or processes.Forked, which only this object uses from now on.

        ``self.process`` has the same methods.
        """
        self.name = name
        self.process = processes.Held(process)
        self.log_path = log_path

    @property
    def pid(self) -> int:
        """The process id, which is also the id of its process group."""
        return self.process.pid

    def last_lines(self) -> str:
        """Return the last lines that the process has printed, indented."""
        with open(self.log_path, errors='replace') as log:
            lines = log.read().splitlines()[-LOG_LINES:]
        return '\n'.join('    ' + line for line in lines) or '    (it printed nothing)'

    def signal(self, number: int) -> None:
        """Send a signal to the whole process group, if it still exists."""
        self.process.signal_group(number)


class Loopback:
    """A ROS master on a free loopback port, and its child nodes. Use it as a context manager.

    ``use_sim_time``: the value of the parameter /use_sim_time.

    :raises LoopbackError: if the master or its folder for logs cannot be made.
    """

    def __init__(self, use_sim_time: bool = True) -> None:
        self._use_sim_time = use_sim_time
        self._children: List[Any] = []
        try:
            self.log_dir = temporary.make('')
        except OSError as error:
            raise LoopbackError(f'no folder for the logs can be made in TMPDIR or /tmp: {error.strerror}') from None
        self.uri: Any = None

    def __enter__(self) -> Loopback:
        try:
            self._start_master()
        except BaseException as error:
            self.close(keep_logs=isinstance(error, Exception))
            raise
        return self

    def __exit__(self, kind: Optional[Union[Type[Any], Type[ChildEnded]]], error: Any, trace: Any) -> None:
        self.close(keep_logs=kind is not None and issubclass(kind, Exception))

    @property
    def environment(self) -> Dict[str, str]:
        """The environment for a process that uses this master."""
        environment: Any = {key: value for key, value in os.environ.items()
                            if key not in ('ROS_HOSTNAME', 'ROS_NAMESPACE')}
        environment.update(ROS_MASTER_URI=self.uri, ROS_IP='127.0.0.1', ROS_LOG_DIR=self.log_dir, PYTHONUNBUFFERED='1')
        return environment

    def adopt(self) -> None:
        """Make this process use the master. Call it before rospy.init_node. Arguments in sys.argv are removed."""
        environment = self.environment
        for key in [key for key in os.environ if key not in environment]:
            del os.environ[key]
        os.environ.update(environment)
        del sys.argv[1:]

    def set_param(self, name: str, value: Any) -> None:
        """Set a parameter on the master."""
        rosgraph.Master('/loopback', master_uri=self.uri).setParam(name, value)

    def run(self, executable: str, name: str, namespace: str = '/', parameters: Optional[Mapping[str, Any]] = None,
            arguments: Sequence[str] = ()) -> Child:
        """Start a node of this package and return its Child.

        name: node name; namespace: absolute; parameters: {name: value}, the node's private ones; arguments: they come
        before ROS's own arguments.

        :raises LoopbackError: if the executable is not found, or its output cannot be written.
        """
        full_name = rosgraph.names.ns_join(namespace, name)
        for key, value in (parameters or {}).items():
            self.set_param(rosgraph.names.ns_join(full_name, key), value)
        command = [find_executable(executable), *arguments, f'__ns:={namespace}', f'__name:={name}']
        return self.spawn(full_name, command)

    def check(self) -> None:
        """Raise ChildEnded if one of the processes has ended."""
        for child in self._children:
            code = child.process.poll()
            if code is not None:
                how = f'signal {signal.Signals(-code).name}' if code < 0 else f'exit code {code}'
                raise ChildEnded(f'{child.name} ended unexpectedly ({how}); its last lines:\n{child.last_lines()}')

    def end(self, child: Child) -> None:
        """End one child, which check() does not look at any more."""
        self._children.remove(child)
        _end([child])

    def close(self, keep_logs: bool = False) -> None:
        """End all children, the master last. Remove the folder of logs unless ``keep_logs``."""
        master, nodes = self._children[:1], self._children[1:]
        self._children = []
        _end(nodes)
        _end(master)
        if keep_logs:
            temporary.keep(self.log_dir)
        else:
            temporary.remove(self.log_dir)

    def _start_master(self) -> None:
        for attempt in range(1, MASTER_TRIES + 1):
            port = free_port()
            self.uri = f'http://127.0.0.1:{port}/'
            self.spawn('rosmaster', [_find_program('rosmaster'), '--core', '-p', str(port)])
            try:
                self._wait_for_master()
                break
            except ChildEnded:
                _end(self._children)
                self._children.clear()
                if attempt == MASTER_TRIES:
                    raise
        self.set_param('/use_sim_time', self._use_sim_time)

    def _wait_for_master(self) -> None:
        deadline = time.monotonic() + MASTER_TIMEOUT
        while True:
            pid = self._master_pid()
            if pid == self._children[0].pid:
                return
            if pid is not None:  # another program got the same free port, and was quicker
                raise ChildEnded(f'another master answers at {self.uri}')
            self.check()
            if time.monotonic() > deadline:
                raise LoopbackError(f'rosmaster does not answer at {self.uri} after {MASTER_TIMEOUT:g} s; its last '
                                    f'lines:\n{self._children[0].last_lines()}')
            time.sleep(0.02)

    def _master_pid(self) -> Optional[int]:
        """Return the process id of the master that answers at the URI; None if none answers."""
        try:
            return rosgraph.Master('/loopback', master_uri=self.uri).getPid()
        except (OSError, rosgraph.MasterException, http.client.HTTPException, xmlrpc.client.Error):
            return None

    def spawn(self, name: str, command: Sequence[str]) -> Child:
        """Start a process in a group of its own, and return its Child. The kernel kills it when this process ends.

        :raises LoopbackError: if its output cannot be written, or setpriv is not installed.
        """
        log_path = self._log_path(name)
        with _open_log(log_path) as log:
            process = self._start(command, log)
        return self._child(name, process, log_path)

    def _start(self, command: Sequence[str], log: BinaryIO) -> Any:
        """Start a process; return its subprocess.Popen, or processes.Forked."""
        setpriv: Any = [_find_program('setpriv'), '--pdeathsig', 'INT' if guard.is_there() else 'KILL', '--']
        return subprocess.Popen(setpriv + command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                                env=self.environment, start_new_session=True)

    def _log_path(self, name: str) -> str:
        return os.path.join(self.log_dir, f'{len(self._children):02d}{name.replace("/", "-")}.out')

    def _child(self, name: str, process: Forked, log_path: str) -> Child:
        self._children.append(Child(name, process, log_path))
        return self._children[-1]


def _open_log(path: str) -> BinaryIO:
    try:
        return open(path, 'wb')
    except OSError as error:
        raise LoopbackError(f'{path}: cannot be written: {error.strerror}') from None


def find_executable(name: str) -> str:
    """Return the path of an executable of this package. :raises LoopbackError: if it is not found."""
    try:
        paths = packages.find_node(PACKAGE, name)
    except rospkg.ResourceNotFound:
        paths = []
    if not paths:
        raise LoopbackError(f"executable '{name}' of the package {PACKAGE} is not found; build the package (make build)"
                            ' and source its setup.sh in this shell')
    return paths[0]


def free_port() -> int:
    """Return a TCP port of 127.0.0.1 on which no program listens."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def _find_program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        raise LoopbackError(f"program '{name}' is not on PATH; is ROS installed (make deps) and sourced?")
    return path


def _end(children: Sequence[Child]) -> None:
    """End processes and their groups: by SIGTERM first, and by SIGKILL after END_TIMEOUT."""
    for child in children:
        child.signal(signal.SIGTERM)
    deadline = time.monotonic() + END_TIMEOUT
    for child in children:
        try:
            child.process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            pass
    for child in children:
        child.signal(signal.SIGKILL)
        child.process.release()
