"""How the processes of a run ended, and which of them crashed. Trials, lockstep_launch and verify use the same rule.

A node *crashed* if it ended while the run went on, although nobody had asked it to, with an exit code other than 0 or
by a signal. A node also crashed if an exception of a callback, a handler or a thread was not caught, even if the node
went on. A node that ends with exit code 0 is done. What a process does after the end of the run, also in its shutdown,
is reported but is not a crash.

Whether a participant left before the end of the run follows from the event log (departures). It does not follow from
the wall clock, because a process may take a while to end. For an onlooker, the program that started it says so.
"""
from __future__ import annotations

import re
import signal
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Pattern, Sequence, Tuple

from . import event_log
from .event_log import EventLogError
from .failures import ASKED, FIRST_USE, UNASKED, UNCAUGHT
from .trace import TraceEntry

TIME_MASTER = '/time_master'
KINDS = (UNCAUGHT, UNASKED, ASKED)  # the kinds of events by which runs are judged
LAST_LINES = 12  # the number of lines kept of what a process has printed
_MOST_UNCAUGHT = 20  # exceptions kept for each node
_LONGEST_LINE = 500
_OURS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)  # the signals with which a run's processes are ended
_BY_SHELL = 128  # if its program ended by a signal, a shell exits with this plus the signal's number
# Printed to the standard error by rospy, roscpp, actionlib and Python; used if the event log cannot say it.
_SHOWN = re.compile(r'bad callback: |^Exception in thread |Error processing request: '
                    r'|Exception in your execute callback: |Exception thrown while processing service call: ')
_SHUT_DOWN = re.compile(r'rospy\.exceptions\.ROSInterruptException')
# Printed by the C++ library; whether the program had only begun to listen is not known.
_OF_TF = re.compile(r"terminate called after throwing an instance of 'tf2::[A-Za-z]+Exception'")
_TRACEBACK = 'Traceback (most recent call last):'
_OF_SHUT_DOWN = (1, 130)  # the exit codes after that exception: Python's, and our launcher's
# Matches colours, times of the wall clock and addresses.
_NOISE = re.compile(r'\x1b\[[0-9;]*m|\[[0-9]+\.[0-9]+(, *[0-9.]+)?\]:? ?| at 0x[0-9a-f]+')


class Process(NamedTuple):
    """A process of a run, as seen by the program that started it.

    ``code``: its exit code; if a signal ended it, the signal's negative number; None: it is not known.
    """

    node: str
    takes_part: bool
    code: Optional[int]
    was_early: bool = False  # whether it was seen to end while the run went on
    was_told: bool = False  # whether it got a signal from us
    printed: Tuple[str, ...] = ()  # the last lines that it has printed
    shown: Tuple[str, ...] = ()  # the lines printed before the end that show uncaught exceptions
    names: Tuple[str, ...] = ()  # the participants that it may be; empty: only ``node``
    is_shell: bool = False  # whether it is a shell, whose exit code 0 says nothing of the programs it has started
    looks_on: bool = False  # whether it is a node that takes no part
    only_displays: bool = False  # whether it is a program like RViz, whose end is no crash


class Log:
    """The processes of a run in its event log: which left before the end, and which exceptions were not caught."""

    def __init__(self) -> None:
        self.departures: Dict[str, Tuple[int, bool]] = {}  # {node: (time_ns, whether it died)}
        self._uncaught: Dict[str, Dict[Optional[int], Tuple[int, str]]] = {}  # the first ones, by node and number
        self.hints: Dict[str, str] = {}  # {node: what is said of its first exceptions}
        self.is_whole = False  # whether the log has an end record

    def take(self, row: TraceEntry) -> None:
        """Take a row; only those of the KINDS count."""
        if row.kind not in KINDS:
            return
        values: Sequence[Any]
        told, values = self._uncaught.setdefault(row.robot, {}), row.values
        if row.kind == UNCAUGHT:
            number = -1 - len(told)  # the numbers of jobs count from 1
            if len(values) > 2:
                self.hints.setdefault(row.robot, str(values[2]))
            values = values[:2]
        else:
            number, *values = values
        if row.kind == ASKED:
            told.pop(number, None)
        elif len(told) < _MOST_UNCAUGHT:
            told[number] = row.time_ns, ' in '.join(map(str, values))

    @property
    def uncaught(self) -> Dict[str, List[Tuple[int, str]]]:
        """The uncaught exceptions: {node: [(time_ns, text)]}, for each node the first 20."""
        return {node: list(told.values()) for node, told in self._uncaught.items() if told}

    def end(self, record: Dict[str, Any]) -> None:
        """Take the end record."""
        self.is_whole = True
        for one in record.get('departures', []):
            self.departures[one['node']] = (one['time_ns'], one['died'])


def read_log(path: str) -> Log:
    """Return the Log of the event log ``path``. If the file is missing or damaged, the Log has what was read before."""
    log = Log()
    try:
        with event_log.opened(path) as events:
            for row in events.rows(KINDS):
                log.take(row)
    except (OSError, EventLogError):
        return log
    if events.end is not None:
        log.end(events.end)
    return log


class End(NamedTuple):
    """How one process ended. ``crash``: why it is a crash, in words; None: it is not a crash."""

    node: str
    code: Optional[int]
    time_ns: Optional[int]  # simulated: when it left or died, or of its first uncaught exception; None: at the end
    uncaught: Tuple[str, ...]
    crash: Optional[str]
    last_lines: Tuple[str, ...]
    looks_on: bool = False  # whether it is a node that takes no part

    @property
    def words(self) -> str:
        """The crash in one line of text."""
        when = '' if self.time_ns is None else ' at {:.9f} s'.format(self.time_ns * 1e-9)
        return '{} crashed{}: {}'.format(self.node, when, self.crash)

    @property
    def told(self) -> Dict[str, Any]:
        """The end as a dictionary of plain values, for trial.json; ``at`` is in s of simulated time."""
        number = -self.code if self.code is not None and self.code < 0 else None
        return {'node': self.node, 'crashed': self.crash is not None, 'exit_code': None if number else self.code,
                'signal': number and signal_name(number), 'uncaught': list(self.uncaught),
                'at': None if self.time_ns is None else self.time_ns * 1e-9, 'last_lines': list(self.last_lines)}


def judge(processes: Sequence[Process], log: Log) -> List[End]:
    """Return the End of each Process of a run that is over, in order, then those of processes only the log names."""
    ends = [_end_of(one, log) for one in processes]
    known = {name for one in processes for name in (one.names[:1] if len(one.names) == 1 else (one.node,))}
    for node in [node for node in {**log.departures, **log.uncaught} if node not in known]:
        ends.append(_end_of(Process(node, True, None), log))
    return ends


def crashes(ends: Iterable[End]) -> List[str]:
    """Return the texts of those ``ends`` that are crashes, in order."""
    return [end.words for end in ends if end.crash is not None]


def _end_of(process: Process, log: Log) -> End:
    names = process.names or (process.node,)
    time_ns, died = next((log.departures[name] for name in names if name in log.departures), (None, False))
    is_early = time_ns is not None if process.takes_part and log.is_whole else process.was_early
    caught = log.uncaught.get(names[0], []) if len(names) == 1 else []
    # For a participant only the log counts: at the end of a run its threads may print exceptions that mean nothing.
    uncaught = [text for _, text in caught] or [plain_line(line) for line in process.shown if not process.takes_part]
    found = _unexpected(process, died) if is_early else None
    if process.node == TIME_MASTER and log.is_whole and process.code == 1:
        found = None  # its exit code 1 says that the run did not end as wished
    whys = [found] if found else []
    if uncaught:
        whys.append(uncaught[0] + (' (and {} more)'.format(len(uncaught) - 1) if len(uncaught) > 1 else ''))
    if caught and (time_ns is None or caught[0][0] < time_ns):  # it went on for a while after the exception
        if found and time_ns is not None:
            whys = [whys[1], '{} at {:.9f} s'.format(found, time_ns * 1e-9)]
        time_ns = caught[0][0]
    code = process.code if is_early or not _is_ours(process.code) else None
    is_told = bool(whys) or bool(code)
    hints = [log.hints[name] for name in names if name in log.hints] or [
        FIRST_USE.format('may have begun', '/tf') for _ in filter(_OF_TF.match, process.printed)]
    return End(process.node, code, time_ns, tuple(uncaught), None if process.only_displays else '; '.join(whys) or None,
               (*hints, *plain_lines(process)) if is_told else (), process.looks_on)


def _unexpected(process: Process, died: bool) -> Optional[str]:
    """Return why the end of a process while the run went on is unexpected, as a text, or None if it is not."""
    code = process.code
    if code is None or code == 0 and process.is_shell:
        return 'its connection was lost' if died else None
    if code == 0 or process.was_told and not died and _is_ours(code):
        return None
    if code in _OF_SHUT_DOWN and _is_last_error(_SHUT_DOWN, process.printed):
        return None  # rospy ends the main thread by this exception when the node is shut down
    return described(code)


def _is_last_error(kind: Pattern[str], printed: Sequence[str]) -> bool:
    """Return whether the last exception in these lines is of this kind, so that handling it raised no other."""
    at = max((number for number, line in enumerate(printed) if kind.match(line)), default=None)
    return at is not None and not any(line.startswith(_TRACEBACK) for line in printed[at:])


def _is_ours(code: Optional[int]) -> bool:
    return code is not None and (-code in _OURS or code - _BY_SHELL in _OURS)


def described(code: int) -> str:
    """Return an exit code in words."""
    if code < 0:
        return 'ended by {}'.format(signal_name(-code))
    name = signal_name(code - _BY_SHELL) if code > _BY_SHELL else ''
    return 'exit code {}'.format(code) + (' (in a shell, this means {})'.format(name) if name.startswith('SIG') else '')


def signal_name(number: int) -> str:
    """Return the name of a signal, for example 'SIGTERM'; 'signal N' if it has no name."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return 'signal {}'.format(number)


def shows_uncaught(line: str) -> bool:
    """Return whether a line that a node has printed shows an uncaught exception."""
    return _SHOWN.search(_NOISE.sub('', line)) is not None


def plain_lines(process: Process) -> Tuple[str, ...]:
    """Return the last lines that a Process has printed, without colours, wall times and addresses."""
    return tuple(plain_line(line) for line in process.printed)


def plain_line(line: str) -> str:
    """Return a line without colours, wall times and addresses, which differ from run to run; at most 500 characters."""
    return _NOISE.sub('', line).rstrip()[:_LONGEST_LINE]
