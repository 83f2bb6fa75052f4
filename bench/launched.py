"""A run of lockstep_launch, timed from outside: from the prompt to the first event, to the last one, to the prompt.

The first event is the clock's start, whose line the time master stamps with the wall clock; the last one is the last
byte of the event log. Processor time is that of all processes of the run, whoever started them.
"""

import collections
import hashlib
import json
import os
import re
import resource
import signal
import subprocess
import tempfile
import threading
import time

import psutil

from move_base_abstract_ros.loopback import find_executable

STARTS = re.compile(r'\[([0-9]+\.[0-9]+)(?:, [0-9.]+)?\]: the clock starts at ([0-9.]+) s')
ENDS = re.compile(r'the run ended at ([0-9.]+) s after ([0-9]+) rounds with ([0-9]+) messages')
LINES = 30  # of the output, shown where a run has failed
GRACE_S = 20.0  # wall, from the polite signal to SIGKILL

#: start_s, run_s, end_s: wall; cpu_s: of all; run_cpu_s: between the first and the last event; digest: of the event log
Run = collections.namedtuple('Run', 'start_s run_s end_s cpu_s run_cpu_s simulated_s rounds messages end digest')


class Failed(RuntimeError):
    """lockstep_launch has ended with an error, too late, or without a word of the clock; its last lines are told."""


def launch(words, timeout):
    """Run lockstep_launch with these words and an event log of our own; return a Run.

    timeout: s, wall, after which the run is ended. Raises Failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, 'events.jsonl')
        before, begin = _cpu_of_children(), time.time()
        heard = _follow([find_executable('lockstep_launch'), '--event-log', log, *words], timeout)
        done, used = time.time(), _cpu_of_children() - before
        last = os.stat(log).st_mtime_ns * 1e-9
        end, digest = _read(log)
    first, started_at = (float(text) for text in heard.starts.groups())
    ended_at, rounds, messages = (float(text) for text in heard.ends.groups())
    return Run(first - begin, last - first, done - last, used, heard.ends_cpu_s - heard.starts_cpu_s,
               ended_at - started_at, int(rounds), int(messages), end, digest)


def _follow(command, timeout):
    """Run a command to its end; return what was Heard. Raises Failed."""
    # Else roscpp keeps its lines back while its output is no terminal.
    environment = dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED='1')
    late = threading.Event()
    with subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors='replace') as process:
        guard = threading.Timer(timeout, lambda: (late.set(), _end(process)))
        guard.start()
        try:
            heard = _Heard(process)
            code = process.wait()
        finally:
            guard.cancel()
            _end(process)
    if late.is_set():
        raise Failed(f'not over after {timeout:g} s:\n' + heard.tail())
    if code:
        raise Failed(f'lockstep_launch has ended with {code}:\n' + heard.tail())
    if heard.starts is None or heard.ends is None:
        raise Failed('nothing was heard of the clock; has its time master output="screen"?\n' + heard.tail())
    return heard


class _Heard:
    """What a run says: when its clock starts and ends, the processor time [s] used by then, and its last lines."""

    def __init__(self, process):
        self.starts = self.ends = None
        self.starts_cpu_s = self.ends_cpu_s = 0.0
        self._lines = collections.deque(maxlen=LINES)
        for line in process.stdout:
            self._lines.append(line)
            if self.starts is None and STARTS.search(line):
                self.starts, self.starts_cpu_s = STARTS.search(line), cpu_of(process.pid)
            elif self.ends is None and ENDS.search(line):
                self.ends, self.ends_cpu_s = ENDS.search(line), cpu_of(process.pid)

    def tail(self):
        """Return the last lines."""
        return ''.join(self._lines)


def cpu_of(pid):
    """Return the processor time [s] of a process, of what it has started, and of what has ended and was waited for."""
    try:
        one = psutil.Process(pid)
        family = [*one.children(recursive=True), one]
    except psutil.NoSuchProcess:
        return 0.0
    used = 0.0
    for member in family:
        try:
            used += sum(member.cpu_times()[:4])  # user, system, and those of its children
        except psutil.NoSuchProcess:
            pass  # whoever waited for it has its time
    return used


def _read(log):
    """Return the end record of an event log, and the SHA-256 of its bytes."""
    with open(log, 'rb') as stream:
        text = stream.read()
    return json.loads(text.splitlines()[-1])['end'], hashlib.sha256(text).hexdigest()


def _cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _end(process):
    """End lockstep_launch if it still runs; it ends what it has started."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            process.kill()
