"""The event log of a run that goes on, as far as it is written: its rows, what they tell, and what they break."""
from __future__ import annotations

import contextlib
import os
from typing import IO, Dict, List, Optional, Sequence, Tuple

from move_base_abstract.common.own_files import PART
from move_base_abstract.properties.judgement import judge_log
from move_base_abstract.runs import event_log
from move_base_abstract.runs.built_in import ALL, Broken
from move_base_abstract.runs.event_log import EventLog
from move_base_abstract.runs.story import Story
from move_base_abstract.runs.trace import TraceEntry

_END = (b'{"end"', b'# {"end"')
_GOAL = 'departed'  # the kind of rows that say where a goal is


class LogSoFar:
    """The event log ``path``, or its part that is there while the run goes on. ``lines``: its rows as bytes."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._head_lines = 2 if path.endswith('.csv') else 1
        self.head: List[bytes] = []
        self.lines: List[bytes] = []
        self.end = b''  # the end record, if it is there
        self.targets: Dict[str, Sequence[float]] = {}  # {robot: (x, y, yaw) for which it departed last}
        self._stream: Optional[IO[bytes]] = None
        self._begun = b''  # of a line that is not whole yet
        self._story: Optional[Story] = None
        self._told = 0  # the number of rows in the story

    def read(self) -> None:
        """Read what has been written since the last call."""
        if self._stream is None:
            for path in (self.path + PART, self.path):
                with contextlib.suppress(FileNotFoundError):
                    self._stream = open(path, 'rb')  # noqa: SIM115
                    break
            else:
                return
        *lines, self._begun = (self._begun + self._stream.read()).split(b'\n')
        for line in lines:
            if len(self.head) < self._head_lines:
                self.head.append(line + b'\n')
            elif line.startswith(_END):
                self.end = line + b'\n'
            else:
                self.lines.append(line + b'\n')

    def close(self) -> None:
        """Read no more."""
        if self._stream is not None:
            self._stream.close()

    def entries(self, first: int, end: int) -> List[TraceEntry]:
        """Return the rows with the numbers ``first`` to ``end`` - 1; the first row of the log has the number 0."""
        return list(self._log(self.lines[first:end]).rows()) if first < end else []

    def story(self) -> Story:
        """Return the Story of the rows so far."""
        if self._story is None:
            if not self.head:
                return Story(0)
            self._story = Story(self._log([]).start_ns)
        for row in self.entries(self._told, len(self.lines)):
            self._story.take(*row)
            if row.kind == _GOAL:
                self.targets[row.robot] = tuple(row.values[:3])
        self._told = len(self.lines)
        return self._story

    def broken(self, count: int, properties: Sequence[str] = (ALL,)) -> List[Broken]:
        """Return the properties that the first ``count`` rows break; with one more than there are, also by the end."""
        lines = self.lines[:count]
        if count > len(self.lines):
            lines = [*lines, self.end]
        return list(judge_log(self._log(lines), properties=properties).broken)

    def first_break(self, low: int, known: Sequence[Broken],
                    properties: Sequence[str] = (ALL,)) -> Optional[Tuple[int, Broken]]:
        """Return (number of rows, Broken) of the first row by which a property is broken, or None.

        The end of the log counts as one more row. ``low``: a number of rows that break only what is ``known``.
        """
        def new(count: int) -> List[Broken]:
            return [one for one in self.broken(count, properties) if one not in known]
        high = len(self.lines) + bool(self.end)
        found = new(high)
        while found and high - low > 1:
            middle = (low + high) // 2
            so_far = new(middle)
            low, high, found = (low, middle, so_far) if so_far else (middle, high, found)
        return (high, found[0]) if found else None

    def difference_from(self, other: Sequence[bytes], first: int = 0) -> Optional[int]:
        """Return the number, from 1 on, of the first row that is not as in ``other``, as far as both go; None: none.

        ``first``: so many rows are known to be equal.
        """
        end = min(len(self.lines), len(other))
        if other is self.lines or self.lines[first:end] == other[first:end]:
            return None
        return next(number + 1 for number in range(first, end) if self.lines[number] != other[number])

    def before(self, time_ns: int) -> int:
        """Return the number of rows before the instant ``time_ns`` [ns]."""
        low, high = 0, len(self.lines)
        while low < high:
            middle = (low + high) // 2
            if self.entries(middle, middle + 1)[0].time_ns < time_ns:
                low = middle + 1
            else:
                high = middle
        return low

    def _log(self, lines: Sequence[bytes]) -> EventLog:
        return event_log.of_bytes(b''.join([*self.head, *lines]), os.path.basename(self.path))
