"""An event log in memory, as columns: the page lists it, and legs and states are found in it."""
from __future__ import annotations

import json
from array import array
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Sequence, Union

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.units import LAST_NS
from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log import EventLog
from move_base_abstract.runs.run_difference import MESSAGES

if TYPE_CHECKING:
    from pathlib import Path

    from move_base_abstract.runs.event_log import Event

#: so many events of a log are kept at most; more messages are left out, but never events of robots
MOST_EVENTS = 500_000


class ReplayError(SimulatorError):
    """A replay cannot be made; the text says of which file, and why."""


class Recording:
    """The events of one log, in their order: ``times`` [ns], ``names``, ``kinds`` and ``values`` (JSON), side by side.

    ``names`` and ``kinds`` hold numbers; ``name_of`` and ``kind_of`` have the texts for them. ``begin_ns`` and
    ``end_ns`` are the instants of the begin and the end of the log; ``remarks`` are what a reader must know of the run.
    """

    def __init__(self, path: Union[str, Path]) -> None:
        self.path = str(path)
        self.times = array('q')
        self.names = array('L')
        self.kinds = array('L')
        self.values: List[Any] = []
        self.name_of: List[Any] = []
        self.kind_of: List[Any] = []
        self.events = 0  # the number of events of the log
        self.left_out = 0  # the number of messages that were left out
        self.begin_ns = self.end_ns = 0
        self.remarks: List[Any] = []
        self.is_repeatable = True

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Any]:
        """Iterate over the kept events as (time [ns], name, kind, values as JSON)."""
        name_of, kind_of = self.name_of, self.kind_of
        return ((time_ns, name_of[name], kind_of[kind], values)
                for time_ns, name, kind, values in zip(self.times, self.names, self.kinds, self.values))

    def rows(self) -> Iterator[Any]:
        """Iterate over the kept events, but for messages, as (time [ns], name, kind, list of values)."""
        return ((time_ns, name, kind, json.loads(values)) for time_ns, name, kind, values in self
                if kind not in MESSAGES)


def read_recording(path: Union[str, Path], most: Any = MOST_EVENTS) -> Recording:
    """Return the :class:`Recording` of an event log. If it has more than ``most`` events, messages are left out.

    :raises EventLogError: if the file is no event log, or is damaged; it names file and line.
    :raises ReplayError: if its times are not in order, or out of range; it names file and line.
    """
    recording = Recording(path)
    names, kinds = _Numbers(recording.name_of), _Numbers(recording.kind_of)
    with event_log.open_text(path) as stream:
        log = EventLog(stream, recording.path)
        for event in log:
            _check_time(event, recording)
            recording.end_ns = event.time_ns
            if event.kind in MESSAGES and len(recording.times) >= most:
                recording.left_out += 1
                continue
            recording.times.append(event.time_ns)
            recording.names.append(names.of(event.robot))
            recording.kinds.append(kinds.of(event.kind))
            recording.values.append(event.values)
    first_ns = recording.times[0] if recording.times else log.start_ns
    recording.begin_ns = log.start_ns if 0 <= log.start_ns <= first_ns else first_ns
    recording.end_ns = max(recording.begin_ns, recording.end_ns)
    recording.events = log.events
    recording.remarks = log.remarks()
    recording.is_repeatable = not recording.remarks
    return recording


def is_number(value: Any) -> bool:
    """Return whether a value of a row is a number that a page can hold. Any program may write rows."""
    return type(value) in (int, float) and -1e300 < value < 1e300


def _check_time(event: Event, recording: Recording) -> None:
    if not recording.end_ns <= event.time_ns <= LAST_NS:
        raise ReplayError('{}:{}: got the time {} ns; allowed: {} (that of the line before) to {} ns'.format(
            recording.path, event.line, event.time_ns, recording.end_ns, LAST_NS))


class _Numbers:
    """Numbers texts in the order in which they come."""

    def __init__(self, texts: Sequence[Any]) -> None:
        self._texts: Any = texts
        self._numbers: Dict[Any, Any] = {}

    def of(self, text: str) -> int:
        number = self._numbers.get(text)
        if number is None:
            number = self._numbers[text] = len(self._texts)
            self._texts.append(text)
        return number
