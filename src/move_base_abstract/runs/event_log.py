"""The event logs of the event-driven clock: read them, and find the first difference of two.

A log is text, one record per line, as JSON lines or as CSV:

    {"event_log":1,"start_ns":1000000000}
    {"time_ns":1500000000,"robot":"robot_0","kind":"arrived","values":[1.5,0.0]}
    {"end":{"events":1,"repeatable":true,"not_repeatable_because":[],"degraded_because":[],"reason":"SIGTERM"}}

In CSV the first and the last record are the same JSON after '# ', the second line names the columns and the values of
an event are a JSON array in one field. A log that has no end record is that of a run which did not end properly; the
time master calls such a file NAME.part. Only events are compared, by value: a JSON log may be compared with a CSV log.
"""
from __future__ import annotations

import csv
import decimal
import itertools
import json
import os
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
    Union,
)

from ..common.errors import SimulatorError
from ..common.input_files import open_text_input

if TYPE_CHECKING:
    from ..common.type_names import StrPath

FORMAT = 1
CSV_COLUMNS = ['time_ns', 'robot', 'kind', 'values']


class EventLogError(SimulatorError):
    """A file that is not an event log, or a damaged one; the text names file and line."""


class Event(NamedTuple):
    """One event, and where it is written."""

    time_ns: int
    robot: str
    kind: str
    values: str  # JSON, in one spelling for equal values
    line: int
    text: str  # the line as it stands in the file

    @property
    def compared(self) -> Tuple[int, str, str, str]:
        """What makes two events equal."""
        return self[:4]


def labels_of(end: Dict[str, Any]) -> List[str]:
    """Return why the run of an end record (a dict) is not called repeatable, or is called degraded, as texts."""
    return [*end['not_repeatable_because'], *end['degraded_because'], *_cut(end)]


def _cut(end: Dict[str, Any]) -> List[str]:
    """Return [where the run was ended from outside], or [] of one that came to an end of its own."""
    if 'cut_ns' not in end:
        return []
    return ['the run was ended from outside at {:.9f} s: it is repeatable up to there, and another run may end '
            'elsewhere'.format(decimal.Decimal(end['cut_ns']).scaleb(-9))]


class EventLog:
    """An event log, read while it is iterated over; `end` is known when all events were read."""

    def __init__(self, lines: Iterable[str], name: str) -> None:
        """lines: an iterable of text lines with their ends; name: for error texts."""
        self.name = name
        self.events = 0  # read so far
        self.start_ns = 0  # when the clock began, if the head says so
        self.end: Optional[Dict[str, Any]] = None  # the end record, a dict; None: the run did not end properly
        self._lines = enumerate(lines, 1)
        self._csv = False
        self._read_head()

    def __iter__(self) -> Iterator[Event]:
        for number, line in self._lines:
            record = self._record(number, line)
            if self.end is not None:
                raise self._error(number, 'there is text after the end record', line)
            if record is None:
                continue
            if isinstance(record, dict):
                self._take_end(number, record, line)
            else:
                self.events += 1
                yield record

    @property
    def bags(self) -> Dict[str, List[Dict[str, Any]]]:
        """The bags of the run, of which the end record has digests: {node: [{'node', 'name', 'bytes', 'sha256'}]}."""
        found: Dict[str, List[Dict[str, Any]]] = {}
        for bag in (self.end or {}).get('bags', []):
            found.setdefault(bag['node'], []).append(bag)
        return found

    def remarks(self) -> List[str]:
        """Return what must be known about the run beside its events, as texts. Call it after all events were read."""
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

    def _record(self, number: int, line: str) -> Union[Dict[str, Any], Event, None]:
        """Return an Event, the end record, or None for a last line that was cut off."""
        if not line.endswith('\n'):
            return None
        if not self._csv:
            record = self._json(number, line)
            return record if isinstance(record, dict) and 'end' in record else self._event(number, line, record)
        if line.startswith('# '):
            end: Dict[str, Any] = self._json(number, line[2:])
            return end
        try:
            time_ns, robot, kind, values = next(csv.reader([line], strict=True))
            record = {'time_ns': int(time_ns), 'robot': robot, 'kind': kind,
                      'values': self._json(number, values)}
        except (ValueError, csv.Error) as error:
            raise self._error(number, f"must hold {','.join(CSV_COLUMNS)} ({error})", line) from error
        return self._event(number, line, record)

    def _event(self, number: int, line: str, record: Any) -> Event:
        kinds = {'time_ns': int, 'robot': str, 'kind': str, 'values': list}
        if not isinstance(record, dict) or set(record) != set(kinds) or not all(
                type(record[key]) is kind for key, kind in kinds.items()) or not _is_ns(record['time_ns']):
            raise self._error(number, 'must hold time_ns (a whole number of 64 bits), robot and kind (texts) and '
                                      'values (a list)', line)
        return Event(record['time_ns'], record['robot'], record['kind'],
                     json.dumps(record['values'], sort_keys=True), number, line.rstrip('\r\n'))

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
            raise self._error(number, f'the end record counts another number of events than were read, {self.events}',
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
    """Return the label of a run with a bag that nothing is known of, as a text."""
    return f"the bag of '{node}' is not covered: {why}"


class BagDifference(NamedTuple):
    """The first bags of a node that differ, as the end records have them; None where a run has no more of them."""

    node: str
    number: int  # among the node's bags, from 1 on
    first: Any
    second: Any


def compare_bags(first: EventLog, second: EventLog) -> Tuple[Optional[BagDifference], List[str]]:
    """Return the first difference between the bags of two EventLogs that were read, or None, and what only one has.

    What a node's bags are called is not compared. A log of a run without digests has none: its nodes are in the second
    value, a sorted list of names.
    """
    one, other = first.bags, second.bags
    for node in sorted(set(one) & set(other)):
        for number, pair in enumerate(itertools.zip_longest(one[node], other[node]), 1):
            if None in pair or pair[0]['sha256'] != pair[1]['sha256']:
                return BagDifference(node, number, *pair), sorted(set(one) ^ set(other))
    return None, sorted(set(one) ^ set(other))


class Comparison(NamedTuple):
    """What compare found. The first differing events are None where a log has no more of them, or all are equal."""

    first: Optional[Event]
    second: Optional[Event]
    counts: Tuple[int, int]  # events of each

    @property
    def identical(self) -> bool:
        """Whether both logs hold the same events in the same order."""
        return self.first is None and self.second is None


def compare(first: EventLog, second: EventLog) -> Comparison:
    """Compare the events of two EventLogs, and read both to their ends."""
    different: Tuple[Optional[Event], Optional[Event]] = (None, None)
    for pair in itertools.zip_longest(first, second):
        if different == (None, None) and (None in pair or pair[0].compared != pair[1].compared):
            different = pair
    return Comparison(*different, (first.events, second.events))


def open_text(path: StrPath) -> ContextManager[IO[str]]:
    """Open a log file, in a with statement. EventLogError says so where only the file of an unfinished run is there."""
    def error(text: str) -> EventLogError:
        part = ''
        if not os.path.exists(path) and os.path.exists(f'{path}.part'):
            part = f'; {path}.part is there: that run has not ended properly, or not yet'
        return EventLogError(text + part)
    # Bytes that are no text are a difference to be shown, not a reason to stop.
    return open_text_input(path, None, error, 'file', errors='surrogateescape', newline='\n')
