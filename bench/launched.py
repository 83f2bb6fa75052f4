"""Runs lockstep_launch and times it from outside: to the first event, to the last event, and to the prompt.

The first event is the start of the clock, for which the time master writes a note file. The last event is the last
byte of the event log. Processor time is that of all processes of the run.
"""

import collections
import hashlib
import json
import os
import resource
import signal
import subprocess
import tempfile
import time

import psutil

from move_base_abstract_ros.loopback import find_executable

LINES = 30  # last lines of the output that are shown if a run fails
LOOK_S = 0.005  # wall
GRACE_S = 20.0  # wall, from SIGINT to SIGKILL
OUTPUT = 'output.txt'
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
        before, begin = _cpu_of_children(), time.time()
        run_cpu = _follow([find_executable('lockstep_launch'), '--event-log', log, '--notes', folder, *words], folder,
                          timeout)
        done, used = time.time(), _cpu_of_children() - before
        first, last = (os.stat(path).st_mtime_ns * 1e-9 for path in (os.path.join(folder, 'start'), log))
        with open(os.path.join(folder, 'end')) as stream:
            note = json.load(stream)
        start_ns, end, digest = _read(log)
        with open(os.path.join(folder, OUTPUT), errors='replace') as output:
            crashes = [line[len(CRASH):].rstrip() for line in output if line.startswith(CRASH)]
    return Run(first - begin, last - first, done - last, used, run_cpu, (note['at_ns'] - start_ns) * 1e-9,
               note['rounds'], note['messages'], end, digest, crashes)


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
                        used[note] = cpu_of(process.pid)
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


def cpu_of(pid):
    """Return the processor time [s] of a process and all processes below it, also of ended ones."""
    try:
        one = psutil.Process(pid)
        family = [*one.children(recursive=True), one]
    except psutil.NoSuchProcess:
        return 0.0
    used = 0.0
    for member in family:
        try:
            used += sum(member.cpu_times()[:4])  # user and system time, of the process and of its ended children
        except psutil.NoSuchProcess:
            pass  # its time counts for the process that waited for it
    return used


def _read(log):
    """Return the first instant of an event log [ns], its end record, and the SHA-256 of its bytes."""
    with open(log, 'rb') as stream:
        text = stream.read()
    lines = text.splitlines()
    return json.loads(lines[0])['start_ns'], json.loads(lines[-1])['end'], hashlib.sha256(text).hexdigest()


def _cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _end(process):
    """End lockstep_launch if it still runs; it then ends the processes that it has started."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            process.kill()
