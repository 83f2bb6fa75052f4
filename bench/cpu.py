"""CPU time: of the nodes over a stretch of wall time, and of processes with all that they start."""

import resource
import statistics
import time

import psutil


class CpuWatch:
    """The CPU share of groups of processes, {group: [pid, ...]}; 100 % is one core."""

    def __init__(self, groups):
        self._groups = {name: [psutil.Process(pid) for pid in pids] for name, pids in groups.items()}
        self._begin = self._read()

    def _read(self):
        return time.monotonic(), {name: [sum(process.cpu_times()[:2]) for process in processes]
                                  for name, processes in self._groups.items()}

    def percent(self):
        """Return {group: median CPU share of its processes [%]} since the last call, or since the start."""
        (begin, before), (now, after) = self._begin, self._read()
        self._begin = now, after
        return {name: statistics.median(100.0 * (b - a) / (now - begin) for a, b in zip(before[name], after[name]))
                for name in after}


def of_family(pid):
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


def of_children():
    """Return the processor time [s] of all ended child processes of this one, and of those that they waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
