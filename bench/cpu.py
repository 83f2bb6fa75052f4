"""CPU time of the nodes over a stretch of wall time."""

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
