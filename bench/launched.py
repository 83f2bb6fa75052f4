"""Runs lockstep_launch, and times it from outside: to the first event, the last event, and the prompt; or roslaunch.

The first event is the start of the clock, for which the time master writes a note file. The last event is the last
byte of the event log. Processor time is that of all processes of the run.
"""

import collections
import hashlib
import json
import os
import signal
import subprocess
import tempfile
import time

import cpu
import psutil
import rosgraph

from move_base_abstract_ros.loopback import Loopback, find_executable

LINES = 30  # last lines of the output that are shown if a run fails
LOOK_S = 0.005  # wall
GRACE_S = 20.0  # wall, from SIGINT to SIGKILL
OUTPUT = 'output.txt'
STARTED_S, SETTLED_S = 60.0, 2.0  # wall, until roslaunch has started all nodes, and from there to the start of time
CRASH = 'lockstep_launch: crash: '

#: start_s, run_s, end_s: wall time; cpu_s: whole run; run_cpu_s: from first to last event; digest: of the event log;
#: crashes: of nodes, in words, with --crashes allow
Run = collections.namedtuple('Run', 'start_s run_s end_s cpu_s run_cpu_s simulated_s rounds messages end digest '
                             'crashes')


class Failed(RuntimeError):
    """lockstep_launch ended with an error, too late, or without a note of the clock; the message has its last lines.

    ``why``: the same in words without them. ``code``: its exit code; None if it was ended, since it was too late.
    """

    def __init__(self, why, path, code=None):
        super().__init__(why + ':\n' + _tail(path))
        self.why, self.code = why, code


def launch(words, timeout):
    """Run lockstep_launch with these words and an event log of our own; return a Run.

    :param timeout: wall time after which the run is ended [s].
    :raises Failed: if the run did not end well.
    """
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, 'events.jsonl')
        before, begin = cpu.of_children(), time.time()
        run_cpu = _follow([find_executable('lockstep_launch'), '--event-log', log, '--notes', folder, *words], folder,
                          timeout)
        done, used = time.time(), cpu.of_children() - before
        first, last = (os.stat(path).st_mtime_ns * 1e-9 for path in (os.path.join(folder, 'start'), log))
        with open(os.path.join(folder, 'end')) as stream:
            note = json.load(stream)
        start_ns, end, digest = _read(log)
        with open(os.path.join(folder, OUTPUT), errors='replace') as output:
            crashes = [line[len(CRASH):].rstrip() for line in output if line.startswith(CRASH)]
    return Run(first - begin, last - first, done - last, used, run_cpu, (note['at_ns'] - start_ns) * 1e-9,
               note['rounds'], note['messages'], end, digest, crashes)


def plain_cpu(words, simulated_s):
    """Run a launch file by roslaunch on the scaled clock at 1x; return the processor time of a simulated second [s].

    As in lockstep, time starts when all nodes are there, and what comes before does not count.

    :raises Failed: if a node does not start, or roslaunch ends before the time is over.
    """
    names = set(subprocess.run(['roslaunch', '--nodes', *words], check=True, text=True,
                               stdout=subprocess.PIPE).stdout.split())
    with Loopback() as ros:
        started = ros.spawn('roslaunch', ['roslaunch', *words])
        try:
            master = rosgraph.Master('/bench', master_uri=ros.uri)
            _await(lambda: names <= {node for group in master.getSystemState() for _, nodes in group for node in nodes},
                   started)
            time.sleep(SETTLED_S)
            before = _cpu_of_family()
            ros.run('time_master', 'time_master', parameters={'mode': 'scaled', 'factor': 1.0})
            time.sleep(simulated_s)
            used = _cpu_of_family() - before
            if started.process.poll() is not None:
                raise Failed(f'roslaunch has ended with {started.process.poll()}', started.log_path)
        finally:
            _end_all(started)
    return used / simulated_s


def _await(condition, started):
    deadline = time.monotonic() + STARTED_S
    while not condition():
        if started.process.poll() is not None or time.monotonic() > deadline:
            raise Failed(f'not all nodes are there after {STARTED_S:g} s, or roslaunch has ended', started.log_path)
        time.sleep(LOOK_S)


def _cpu_of_family():
    """Return the processor time [s] of all processes below this one."""
    return sum(cpu.of_family(child.pid) for child in psutil.Process().children())


def _end_all(started):
    """Let roslaunch end its nodes, which lead sessions of their own; kill what is left."""
    try:
        family = psutil.Process(started.pid).children(recursive=True)
    except psutil.NoSuchProcess:
        family = []
    started.signal(signal.SIGINT)
    _, left = psutil.wait_procs(family, GRACE_S)
    for process in left:
        process.kill()


def _follow(command, folder, timeout):
    """Run a command to its end; return the processor time [s] between the two notes in ``folder``. Raises Failed."""
    used = {}
    path, deadline = os.path.join(folder, OUTPUT), time.monotonic() + timeout
    with open(path, 'wb') as output, subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output,
                                                      stderr=subprocess.STDOUT) as process:
        try:
            while process.poll() is None and time.monotonic() < deadline:
                for note in ('start', 'end'):
                    if note not in used and os.path.exists(os.path.join(folder, note)):
                        used[note] = cpu.of_family(process.pid)
                time.sleep(LOOK_S)
            is_late = process.poll() is None
        finally:
            _end(process)
    if is_late:
        raise Failed(f'not over after {timeout:g} s', path)
    if process.returncode:
        raise Failed(f'lockstep_launch has ended with {process.returncode}', path, process.returncode)
    if len(used) < 2:
        raise Failed('the time master has written no note of its start or of its end', path, 0)
    return used['end'] - used['start']


def _tail(path):
    with open(path, errors='replace') as output:
        return ''.join(collections.deque(output, LINES))


def _read(log):
    """Return the first instant of an event log [ns], its end record, and the SHA-256 of its bytes."""
    with open(log, 'rb') as stream:
        text = stream.read()
    lines = text.splitlines()
    return json.loads(lines[0])['start_ns'], json.loads(lines[-1])['end'], hashlib.sha256(text).hexdigest()


def _end(process):
    """End lockstep_launch if it still runs; it then ends the processes that it has started."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            process.kill()
