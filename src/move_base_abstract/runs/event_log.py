"""Reads the event logs of the event-driven clock, and finds the first difference of two.

A log is text, one record per line, as JSON lines or as CSV:

    {"event_log":1,"start_ns":1000000000}
    {"time_ns":1500000000,"robot":"robot_0","kind":"arrived","values":[1.5,0.0]}
    {"end":{"events":1,"repeatable":true,"not_repeatable_because":[],"degraded_because":[],"reason":"SIGTERM"}}

In CSV the first and the last record are the same JSON after '# '. The second line names the columns, and the values of
an event are a JSON array in one field. If a log has no end record, the run did not end properly; the time master calls
such a file NAME.part. Only events are compared, by value, so a JSON log may be compared with a CSV log.
"""
from __future__ import annotations

import csv
import decimal
import io
import itertools
import json
import os
from contextlib import contextmanager
from typing import (
    IO,
    TYPE_CHECKING,
    Any,
    ContextManager,
    Dict,
    Iterable,
    Iterator,
    List,
    NamedTuple,
    Optional,
    Tuple,
)

from ..common.errors import SimulatorError
from ..common.input_files import open_text_input
from .trace import TraceEntry

if TYPE_CHECKING:
    from ..common.type_names import StrPath

FORMAT = 1
_ENDS = ('{"end"', '# ')  # how end records begin
CSV_COLUMNS = ['time_ns', 'robot', 'kind', 'values']


class EventLogError(SimulatorError):
    """A file is not an event log, or is damaged. The text names the file and the line."""


class Event(NamedTuple):
    """One event, with its line in the file."""

    time_ns: int
    robot: str
    kind: str
    values: str  # JSON, in one spelling for equal values
    line: int
    text: str  # the line as it stands in the file

    @property
    def compared(self) -> Tuple[int, str, str, str]:
        """The values by which two events are compared."""
        return self[:4]

    @property
    def row(self) -> TraceEntry:
        """The event as a row, with its values as a list."""
        return TraceEntry(self.time_ns, self.robot, self.kind, json.loads(self.values))


def labels_of(end: Dict[str, Any]) -> List[str]:
    """Return the labels in an end record (a dict), as texts: why the run is not called repeatable, or is degraded."""
    return [*end['not_repeatable_because'], *end['degraded_because'], *_cut(end)]


def _cut(end: Dict[str, Any]) -> List[str]:
    """Return [a text that says when the run was ended from outside], or [] if it ended by itself."""
    if 'cut_ns' not in end:
        return []
    return ['the run was ended from outside at {:.9f} s: it is repeatable up to there, and another run may end '
            'elsewhere'.format(decimal.Decimal(end['cut_ns']).scaleb(-9))]


class EventLog:
    """An event log, which is read while it is iterated over; ``end`` is known when all events have been read.

    :raises EventLogError: if it is not an event log or is damaged, also while it is iterated over.
    """

    def __init__(self, lines: Iterable[str], name: str) -> None:
        """``lines``: the lines of the log, with their line ends; ``name``: the name of the log in error texts."""
        self.name = name
        self.events = 0  # the number of events read so far
        self.start_ns = 0  # when the clock began, if the head says so
        self.end: Optional[Dict[str, Any]] = None  # the end record, a dict; None: the run did not end properly
        self._lines = enumerate(lines, 1)
        self._csv = False
        self._read_head()

    def __iter__(self) -> Iterator[Event]:
        for number, line, row in self._numbered():
            yield Event(row.time_ns, row.robot, row.kind, json.dumps(row.values, sort_keys=True), number,
                        line.rstrip('\r\n'))

    def rows(self, words: Tuple[str, ...] = ()) -> Iterator[TraceEntry]:
        """Yield each event as a row, with its values as a list; this costs less than to iterate over the log.

        With ``words``, lines that have none of them are counted but not understood, which costs a tenth.
        """
        return (row for _, _, row in self._numbered(words))

    def _numbered(self, words: Tuple[str, ...] = ()) -> Iterator[Tuple[int, str, TraceEntry]]:
        """Yield (number of the line, line, row) of each event."""
        for number, line in self._lines:
            if words and not (line.startswith(_ENDS) or any(word in line for word in words)) and line.endswith('\n'):
                self.events += 1
                continue
            record = self._record(number, line)
            if self.end is not None:
                raise self._error(number, 'there is text after the end record', line)
            if record is None:
                continue
            if 'end' in record:
                self._take_end(number, record, line)
            else:
                self.events += 1
                yield number, line, self._row(number, line, record)

    @property
    def bags(self) -> Dict[str, List[Dict[str, Any]]]:
        """The run's bags in the end record, with digests: {node: [{'node', 'name', 'bytes', 'sha256'}]}."""
        found: Dict[str, List[Dict[str, Any]]] = {}
        for bag in (self.end or {}).get('bags', []):
            found.setdefault(bag['node'], []).append(bag)
        return found

    def remarks(self) -> List[str]:
        """Return all remarks on the run besides its events, as texts. Call this after all events have been read."""
        if self.end is None:
            return ['has no end record: the run did not end properly']
        return [*_cut(self.end),
                *(f'not repeatable: {why}' for why in self.end['not_repeatable_because']),
                *(f'degraded: {why}' for why in self.end['degraded_because']),
                *([f'ended by a fault: {self.end.get("reason", "")}'] if self.end.get('by_fault') else [])]

    def _read_head(self) -> None:
        number, line = next(self._lines, (1, ''))
        self._csv = line.startswith('# ')
        head = self._json(number, line[2:] if self._csv else line)
        version = head.get('event_log') if isinstance(head, dict) else None
        if version != FORMAT or isinstance(version, bool):
            raise self._error(number, f'is not the head of an event log of format {FORMAT}', line)
        start_ns = head.get('start_ns')
        self.start_ns = start_ns if type(start_ns) is int and _is_ns(start_ns) else 0
        if self._csv:
            number, line = next(self._lines, (2, ''))
            if line.rstrip('\r\n').split(',') != CSV_COLUMNS:
                raise self._error(number, f"must name the columns {','.join(CSV_COLUMNS)}", line)

    def _record(self, number: int, line: str) -> Optional[Dict[str, Any]]:
        """Return what a line holds, an event or the end record, or None for a last line that was cut off."""
        if not line.endswith('\n'):
            return None
        if not self._csv:
            record = self._json(number, line)
            return record if isinstance(record, dict) else {}
        if line.startswith('# '):
            end = self._json(number, line[2:])
            return {'end': None, **(end if isinstance(end, dict) else {})}
        try:
            time_ns, robot, kind, values = next(csv.reader([line], strict=True))
            return {'time_ns': int(time_ns), 'robot': robot, 'kind': kind, 'values': self._json(number, values)}
        except (ValueError, csv.Error) as error:
            raise self._error(number, f"must hold {','.join(CSV_COLUMNS)} ({error})", line) from error

    def _row(self, number: int, line: str, record: Dict[str, Any]) -> TraceEntry:
        kinds = {'time_ns': int, 'robot': str, 'kind': str, 'values': list}
        if set(record) != set(kinds) or not all(
                type(record[key]) is kind for key, kind in kinds.items()) or not _is_ns(record['time_ns']):
            raise self._error(number, 'must hold time_ns (a whole number of 64 bits), robot and kind (texts) and '
                                      'values (a list)', line)
        return TraceEntry(record['time_ns'], record['robot'], record['kind'], record['values'])

    def _take_end(self, number: int, record: Dict[str, Any], line: str) -> None:
        end = record.get('end')
        if not isinstance(end, dict) or not all(isinstance(end.get(key), list) and all(
                isinstance(why, str) for why in end[key]) for key in ('not_repeatable_because', 'degraded_because')):
            raise self._error(number, 'must be an end record with not_repeatable_because and degraded_because', line)
        if type(end.get('cut_ns', 0)) is not int:
            raise self._error(number, 'must be an end record whose cut_ns, if there is one, is a whole number', line)
        if not _are_bags(end.get('bags', [])):
            raise self._error(number, 'has bags that are not a list of node, name, bytes and sha256', line)
        if end.get('events') != self.events:
            raise self._error(number, f'the end record has another number of events than were read, {self.events}',
                              line)
        self.end = end

    def _json(self, number: int, text: str) -> Any:
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:
            raise self._error(number, f'is not JSON ({error})', text) from error

    def _error(self, number: int, what: str, line: str) -> EventLogError:
        shown = line.rstrip('\r\n')
        return EventLogError(f"{self.name}:{number}: {what}; got '{shown[:100]}{'...' if len(shown) > 100 else ''}'")


def _is_ns(value: int) -> bool:
    return -2 ** 63 <= value < 2 ** 63


def _are_bags(bags: Any) -> bool:
    kinds = {'node': str, 'name': str, 'bytes': int, 'sha256': str}
    return isinstance(bags, list) and all(isinstance(bag, dict) and all(
        type(bag.get(key)) is kind for key, kind in kinds.items()) for bag in bags)


def uncovered_bag(node: str, why: str) -> str:
    """Return the label of a run in which ``node`` records a bag that is not covered, for the reason ``why``."""
    return f"the bag of '{node}' is not covered: {why}"


class BagDifference(NamedTuple):
    """The first bags of a node that differ, as in the end records; None: that run has no further bag of the node."""

    node: str
    number: int  # among the node's bags, from 1 on
    first: Any
    second: Any


def compare_bags(first: EventLog, second: EventLog) -> Tuple[Optional[BagDifference], List[str]]:
    """Compare the bags of two EventLogs that have been read to their ends.

    Return the first difference, or None, and the sorted names of the nodes of whose bags only one log has digests. The
    names of the bags are not compared.
    """
    one, other = first.bags, second.bags
    for node in sorted(set(one) & set(other)):
        for number, pair in enumerate(itertools.zip_longest(one[node], other[node]), 1):
            if None in pair or pair[0]['sha256'] != pair[1]['sha256']:
                return BagDifference(node, number, *pair), sorted(set(one) ^ set(other))
    return None, sorted(set(one) ^ set(other))


class Comparison(NamedTuple):
    """The result of :func:`compare`: the first events that differ; None: that log has no more, or all are equal."""

    first: Optional[Event]
    second: Optional[Event]
    counts: Tuple[int, int]  # the numbers of events

    @property
    def identical(self) -> bool:
        """Whether both logs hold the same events in the same order."""
        return self.first is None and self.second is None


def compare(first: EventLog, second: EventLog) -> Comparison:
    """Compare the events of two EventLogs, and read both to their ends.

    :raises EventLogError: if one is damaged.
    """
    different: Tuple[Optional[Event], Optional[Event]] = (None, None)
    for pair in itertools.zip_longest(first, second):
        if different == (None, None) and (None in pair or pair[0].compared != pair[1].compared):
            different = pair
    return Comparison(*different, (first.events, second.events))


@contextmanager
def opened(path: StrPath) -> Iterator[EventLog]:
    """Open the event log ``path``, for a with statement, and read it as far as it is iterated over.

    :raises EventLogError: if it cannot be opened, is no event log, or is damaged.
    """
    with open_text(path) as stream:
        yield EventLog(stream, os.fspath(path))


def of_bytes(content: bytes, name: str) -> EventLog:
    """Return the event log in these bytes; ``name``: for errors. :raises EventLogError: if it is none."""
    return EventLog(io.StringIO(content.decode('utf-8', 'surrogateescape'), newline='\n'), name)


def open_text(path: StrPath) -> ContextManager[IO[str]]:
    """Open a log file, for a with statement.

    :raises EventLogError: if it cannot be opened; the text says if there is a file of a run that has not ended.
    """
    def error(text: str) -> EventLogError:
        part = ''
        if not os.path.exists(path) and os.path.exists(f'{path}.part'):
            part = f'; {path}.part is there: that run has not ended properly, or not yet'
        return EventLogError(text + part)
    # Bytes that are not UTF-8 are a difference to be shown, not a reason to stop.
    return open_text_input(path, None, error, 'file', errors='surrogateescape', newline='\n')
