"""Finds the moment when all work of a step of Stage is done: no thread of the watched processes runs or wants to run.

The next step comes only then, so a busy machine makes a recording slower, but not wrong: in simulated time every
program is as quick as on a machine with cores to spare. A thread that never stops is not waited for (move_base tries to
plan without a pause until its patience is over). It gets as much of a core as a step's time in the first step, and a
fifth of that in each further step, until it sleeps.
"""
import os
import time

_FIRST_LOOK = 0.002  # wall s: roscpp looks at the simulated clock every 1 ms
_BETWEEN = 0.0011  # wall s
_LOOKS = 3  # looks in a row that must find all threads asleep
_LIST_EVERY = 20  # waits
_STEP_TICKS = os.sysconf('SC_CLK_TCK') // 10  # of a core in a step of 0.1 s
_BUSY_TICKS = _STEP_TICKS // 5  # for a thread that did not sleep in the step before


class Pace:
    """Watches all threads of the processes ``pids``."""

    def __init__(self, pids):
        self._pids = tuple(pids)
        self._files = {}
        self._waits = 0
        self._used, self._before = {}, {}  # ticks of a core by path: now, and at the begin of the step
        self._busy, self._left = set(), set()  # paths of threads without a wait: in the step before, in the last look

    def watch(self, pid):
        """Watch one more process."""
        self._pids += (pid,)
        self.look_anew()

    def look_anew(self):
        """At the next wait, look for threads that have begun since the last look."""
        self._waits = 0

    def wait(self, limit=300.0):
        """Wait until several looks in a row find all threads done; return whether that is within ``limit`` [wall s]."""
        if self._waits % _LIST_EVERY == 0:
            self._list_threads()
        self._waits += 1
        self._before = dict(self._used)
        end, quiet = time.monotonic() + limit, 0
        time.sleep(_FIRST_LOOK)
        while quiet < _LOOKS:
            if time.monotonic() > end:
                return False
            quiet = quiet + 1 if self._all_done() else 0
            time.sleep(_BETWEEN)
        self._busy = self._left
        return True

    def close(self):
        """Close the files of /proc."""
        for descriptor in self._files.values():
            os.close(descriptor)
        self._files = {}

    def _list_threads(self):
        found = ['/proc/{}/task/{}/stat'.format(pid, task) for pid in self._pids for task in _tasks(pid)]
        for path in [path for path in self._files if path not in found]:
            os.close(self._files.pop(path))
        for path in found:
            if path not in self._files:
                try:
                    self._files[path] = os.open(path, os.O_RDONLY)
                except OSError:
                    pass  # it has ended since

    def _all_done(self):
        self._left = set()
        for path, descriptor in list(self._files.items()):
            try:
                line = os.pread(descriptor, 512, 0)
            except OSError:  # the thread has ended
                os.close(self._files.pop(path))
                continue
            fields = line[line.rindex(b')') + 2:].split(b' ', 13)
            self._used[path] = used = int(fields[11]) + int(fields[12])
            if fields[0] not in b'SIZX':
                self._left.add(path)
                if used - self._before.setdefault(path, used) < (_BUSY_TICKS if path in self._busy else _STEP_TICKS):
                    return False
        return True


def _tasks(pid):
    try:
        return os.listdir('/proc/{}/task'.format(pid))
    except OSError:
        return []
