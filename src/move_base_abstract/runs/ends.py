"""How the processes of a run ended, and which crashed: the one rule for trials, lockstep_launch and verify.

A node *crashed* that came to an end nobody has asked for while the run went on: with an exit code other than 0, or by a
signal; so did one in which nobody caught an exception of a callback, a handler or a thread, even if it went on. A node
that ends with 0 is done. What a process does when the run is over, in its shutdown too, is told and is no crash.

Whether a participant went before the end is said by the event log (departures), not by the wall clock: a process may
take a while to end. Of a process that looks on it is said by who started it.
"""
from __future__ import annotations

import json
import re
import signal
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Pattern, Sequence, Tuple

from ..lockstep.failures import ASKED, UNASKED, UNCAUGHT
from . import event_log
from .event_log import Event, EventLog, EventLogError

TIME_MASTER = '/time_master'
KINDS = (UNCAUGHT, UNASKED, ASKED)  # of the events by which runs are judged
LAST_LINES = 12  # that are kept of what a process has printed
_MOST_UNCAUGHT = 20  # kept of a node
_LONGEST_LINE = 500
_OURS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)  # what a run's processes are ended with
_BY_SHELL = 128  # a shell ends with this and the signal's number where its program ended by a signal
# Of rospy, roscpp, actionlib and Python, on the standard error output, where the event log cannot say it.
_SHOWN = re.compile(r'bad callback: |^Exception in thread |Error processing request: '
                    r'|Exception in your execute callback: |Exception thrown while processing service call: ')
_SHUT_DOWN = re.compile(r'rospy\.exceptions\.ROSInterruptException')
_TRACEBACK = 'Traceback (most recent call last):'
_OF_SHUT_DOWN = (1, 130)  # what it makes of the exit code: Python's, and our launcher's
# Colours, times of the wall clock, addresses.
_NOISE = re.compile(r'\x1b\[[0-9;]*m|\[[0-9]+\.[0-9]+(, *[0-9.]+)?\]:? ?| at 0x[0-9a-f]+')


class Process(NamedTuple):
    """A process of a run, as its starter saw it.

    ``code``: of a signal its negative number; None: it is not known.
    """

    node: str
    takes_part: bool
    code: Optional[int]
    was_early: bool = False  # whether it was seen to end while the run went on
    was_told: bool = False  # whether it got a signal of ours
    printed: Tuple[str, ...] = ()  # its last lines
    shown: Tuple[str, ...] = ()  # those lines that show exceptions nobody caught, before the end
    was_started: bool = True
    names: Tuple[str, ...] = ()  # of the participants that it may be, where that is not ``node``
    is_shell: bool = False  # whose exit code 0 says nothing of what it has started


class Log:
    """What a run's event log says of its processes: who left before the end, and which exceptions were not caught."""

    def __init__(self) -> None:
        self.departures: Dict[str, Tuple[int, bool]] = {}  # {node: (time_ns, whether it died)}
        self._uncaught: Dict[str, Dict[Optional[int], Tuple[int, str]]] = {}  # by node and number, the first ones
        self.is_whole = False  # whether it has come to its end

    def take(self, event: Event) -> None:
        """Take an event of one of the KINDS."""
        told, values = self._uncaught.setdefault(event.robot, {}), json.loads(event.values)
        number = values.pop(0) if event.kind != UNCAUGHT else -1 - len(told)  # those of jobs count from 1
        if event.kind == ASKED:
            told.pop(number, None)
        elif len(told) < _MOST_UNCAUGHT:
            told[number] = event.time_ns, ' in '.join(map(str, values))

    @property
    def uncaught(self) -> Dict[str, List[Tuple[int, str]]]:
        """What nobody caught: {node: [(time_ns, text)]}, of each the first ones."""
        return {node: list(told.values()) for node, told in self._uncaught.items() if told}

    def end(self, record: Dict[str, Any]) -> None:
        """Take the end record."""
        self.is_whole = True
        for one in record.get('departures', []):
            self.departures[one['node']] = (one['time_ns'], one['died'])


def read_log(path: str) -> Log:
    """Return the Log of an event log; an empty one if it is not there or has no end."""
    log = Log()
    try:
        with event_log.open_text(path) as stream:
            events = EventLog(stream, path)
            for event in events:
                if event.kind in KINDS:
                    log.take(event)
    except (OSError, EventLogError):
        return log
    if events.end is not None:
        log.end(events.end)
    return log


class End(NamedTuple):
    """How one process ended. ``crash``: what makes it a crash, in words; None: it is none."""

    node: str
    code: Optional[int]
    time_ns: Optional[int]  # simulated, when it left or died, or when it first caught nothing; None: not before the end
    uncaught: Tuple[str, ...]
    crash: Optional[str]
    last_lines: Tuple[str, ...]

    @property
    def words(self) -> str:
        """The crash in a line."""
        when = '' if self.time_ns is None else ' at {:.9f} s'.format(self.time_ns * 1e-9)
        return '{} crashed{}: {}'.format(self.node, when, self.crash)

    @property
    def told(self) -> Dict[str, Any]:
        """All of it as plain values, for trial.json."""
        number = -self.code if self.code is not None and self.code < 0 else None
        return {'node': self.node, 'crashed': self.crash is not None, 'exit_code': None if number else self.code,
                'signal': number and signal_name(number), 'uncaught': list(self.uncaught),
                'at': None if self.time_ns is None else self.time_ns * 1e-9, 'last_lines': list(self.last_lines)}


def judge(processes: Sequence[Process], log: Log) -> List[End]:
    """Return an End of each Process of a run that is over, in their order, then of those that only the log knows."""
    ends = [_end_of(one, log) for one in processes]
    known = {name for one in processes for name in (one.names[:1] if len(one.names) == 1 else (one.node,))}
    for node in [node for node in {**log.departures, **log.uncaught} if node not in known]:
        ends.append(_end_of(Process(node, True, None), log))
    return ends


def crashes(ends: Iterable[End]) -> List[str]:
    """Return the crashes among these in words, in order."""
    return [end.words for end in ends if end.crash is not None]


def _end_of(process: Process, log: Log) -> End:
    names = process.names or (process.node,)
    time_ns, died = next((log.departures[name] for name in names if name in log.departures), (None, False))
    is_early = time_ns is not None if process.takes_part and log.is_whole else process.was_early
    caught = log.uncaught.get(names[0], []) if len(names) == 1 else []
    # Of a participant the log says it: at the end of the run its threads show exceptions that mean nothing.
    uncaught = [text for _, text in caught] or [_plain(line) for line in process.shown if not process.takes_part]
    found = _unexpected(process, died) if is_early else None
    if process.node == TIME_MASTER and log.is_whole and process.code == 1:
        found = None  # its word on the run: it did not end as wished
    found = found if process.was_started else 'it could not be started'
    whys = [found] if found else []
    if uncaught:
        whys.append(uncaught[0] + (' (and {} more)'.format(len(uncaught) - 1) if len(uncaught) > 1 else ''))
    if caught and (time_ns is None or caught[0][0] < time_ns):  # it went on for a while
        if found and time_ns is not None:
            whys = [whys[1], '{} at {:.9f} s'.format(found, time_ns * 1e-9)]
        time_ns = caught[0][0]
    code = process.code if is_early or not _is_ours(process.code) else None
    is_told = bool(whys) or bool(code)
    return End(process.node, code, time_ns, tuple(uncaught), '; '.join(whys) or None,
               plain_lines(process) if is_told else ())


def _unexpected(process: Process, died: bool) -> Optional[str]:
    """Return what is unexpected of an end while the run went on, or None."""
    code = process.code
    if code is None or code == 0 and process.is_shell:
        return 'its connection was lost' if died else None
    if code == 0 or process.was_told and not died and _is_ours(code):
        return None
    if code in _OF_SHUT_DOWN and _is_last_error(_SHUT_DOWN, process.printed):
        return None  # rospy has told its main thread that the node is shut down
    return described(code)


def _is_last_error(kind: Pattern[str], printed: Sequence[str]) -> bool:
    """Return whether the last exception that is shown in these lines is of a kind: none came of handling it."""
    at = max((number for number, line in enumerate(printed) if kind.match(line)), default=None)
    return at is not None and not any(line.startswith(_TRACEBACK) for line in printed[at:])


def _is_ours(code: Optional[int]) -> bool:
    return code is not None and (-code in _OURS or code - _BY_SHELL in _OURS)


def described(code: int) -> str:
    """Return an exit code in words."""
    if code < 0:
        return 'ended by {}'.format(signal_name(-code))
    name = signal_name(code - _BY_SHELL) if code > _BY_SHELL else ''
    return 'exit code {}'.format(code) + (' (a shell says so of {})'.format(name) if name.startswith('SIG') else '')


def signal_name(number: int) -> str:
    """Return the name of a signal, its number where it has none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return 'signal {}'.format(number)


def shows_uncaught(line: str) -> bool:
    """Return whether a line that a node has printed shows an exception that nobody caught."""
    return _SHOWN.search(_NOISE.sub('', line)) is not None


def plain_lines(process: Process) -> Tuple[str, ...]:
    """Return the last lines that a Process has printed, without what differs from run to run."""
    return tuple(_plain(line) for line in process.printed)


def _plain(line: str) -> str:
    """Return a line without what differs from run to run, not too long."""
    return _NOISE.sub('', line).rstrip()[:_LONGEST_LINE]
