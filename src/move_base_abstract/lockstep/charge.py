"""The simulated time that a participant's computations take: none, a fixed, a measured, or a recorded time.

A computation is a round in which the participant sends something. Its messages leave at its end, and the mail that
comes in the meantime waits.
"""
from __future__ import annotations

import json
import os
from typing import IO, Any, Callable, List, Optional, Tuple, Union

from ..common.errors import ConfigurationError
from ..common.input_files import open_text_input
from ..common.kinds import as_number
from ..common.own_files import PART, OutputError, check_file, create_file
from ..common.shown import shown, shown_text
from ..common.units import seconds_to_ns

_ALLOWED = ("'none', 'fixed:SECONDS', 'measured' or 'measured:FILE' (wall clock), 'measured_cpu' or "
            "'measured_cpu:FILE' (this process's CPU), 'replay:FILE'")


class NoCharge:
    """Computations take no simulated time. Runs are repeatable."""

    is_repeatable = True

    def begin(self) -> None:
        """Note that a round begins."""

    def cost_ns(self, _now_ns: int) -> int:
        """Return the simulated time [ns] that the computation that ends now takes."""
        return 0

    def close(self) -> None:
        """Finish the record, if there is one."""


class FixedCharge(NoCharge):
    """Each computation takes the same time. Runs are repeatable."""

    def __init__(self, cost_ns: int) -> None:
        self._cost_ns = cost_ns

    def cost_ns(self, _now_ns: int) -> int:
        """Return the fixed time [ns]."""
        return self._cost_ns


class MeasuredCharge(NoCharge):
    """Each computation takes the time that a clock of the machine measures.

    Such a run is not repeatable by itself. If ``path`` is not '', the times are recorded there for ReplayCharge.
    """

    is_repeatable = False

    def __init__(self, path: str, clock_ns: Any) -> None:
        self._clock_ns = clock_ns
        self._begin_ns = clock_ns()
        self._path = path
        self._record = _create(path) if path else None

    def begin(self) -> None:
        """Note when a round begins."""
        self._begin_ns = self._clock_ns()

    def cost_ns(self, now_ns: int) -> int:
        """Return the time that this round has taken [ns], and record it."""
        cost_ns: int = self._clock_ns() - self._begin_ns
        if self._record is not None:
            self._record.write(json.dumps({'time_ns': now_ns, 'cost_ns': cost_ns}) + '\n')
            self._record.flush()
        return cost_ns

    def close(self) -> None:
        """Give the record its final name."""
        if self._record is not None:
            self._record.close()
            self._record = None
            check_file(self._path, _is_record)
            os.replace(self._path + PART, self._path)


class ReplayCharge(NoCharge):
    """Each computation takes the time that an earlier run recorded. Runs are repeatable."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._costs = iter(_read(path))

    def cost_ns(self, now_ns: int) -> int:
        """Return the recorded time [ns].

        :raises ConfigurationError: if the record has no more times, or the next one is of another instant, so that this
            is not the run that was recorded.
        """
        number, time_ns, cost_ns = next(self._costs, (0, None, 0))
        if time_ns != now_ns:
            where = 'it is at its end' if time_ns is None else 'line {} is of {} ns'.format(number, time_ns)
            raise ConfigurationError('charge replay:{}: the computation at {} ns is not in the record ({}): this is '
                                     'not the run that was recorded'.format(self._path, now_ns, where))
        return cost_ns


def make_charge(text: Optional[Union[float, str]], wall_ns: Callable[..., Any], cpu_ns: Callable[..., Any]) -> Any:
    """Return the charge that ``text`` describes; ``wall_ns()`` and ``cpu_ns()`` are the machine's clocks [ns].

    :raises ConfigurationError: if ``text`` is not allowed, or its file cannot be read or written.
    """
    kind, detail = check_charge(text)
    if kind == 'none':
        return NoCharge()
    if kind == 'fixed':
        return FixedCharge(seconds_to_ns(as_number(detail)))
    if kind == 'replay':
        return ReplayCharge(detail)
    return MeasuredCharge(detail, wall_ns if kind == 'measured' else cpu_ns)


def check_charge(text: Optional[Union[float, str]]) -> Tuple[str, str]:
    """Return the kind of the charge that ``text`` describes, and the part after the colon; no file is opened.

    :raises ConfigurationError: if ``text`` is not allowed.
    """
    kind, _, detail = str(text or 'none').partition(':')
    allowed = {'none': not detail, 'fixed': _is_time(detail), 'measured': True, 'measured_cpu': True,
               'replay': bool(detail)}
    if not allowed.get(kind, False):
        raise ConfigurationError("charge: got '{}'; allowed: {}".format(shown_text(str(text)), _ALLOWED))
    return kind, detail


def _is_time(text: str) -> bool:
    try:
        return 0.0 <= as_number(text) < 1e9
    except ValueError:
        return False


def _create(path: str) -> Optional[IO[str]]:
    """Open the record under its name while it grows, PATH.part; neither may be a file that is not a record."""
    try:
        check_file(path, _is_record)
        return create_file(path + PART, _is_record)
    except OutputError as error:
        raise ConfigurationError('charge measured: {}'.format(error)) from None


def _is_record(line: bytes) -> bool:
    """Return whether the first line of a file (bytes) is that of a record."""
    try:
        entry = json.loads(line)
    except (ValueError, RecursionError):
        return False
    return isinstance(entry, dict) and sorted(entry) == ['cost_ns', 'time_ns']


def _error(text: str) -> ConfigurationError:
    return ConfigurationError('charge replay: ' + text)


def _whole(value: Any) -> int:
    """Return a time [ns] as an int of 64 bits, as in the protocol."""
    whole = int(value)
    if not -2 ** 63 <= whole < 2 ** 63:
        raise ValueError('got {}; allowed: a whole number of 64 bits'.format(shown(whole)))
    return whole


def _read(path: str) -> List[Tuple[int, ...]]:
    costs = []
    try:
        with open_text_input(path, None, _error) as lines:
            for number, line in enumerate(lines, 1):
                entry = json.loads(line)
                costs.append((number, *(_whole(entry[key]) for key in ('time_ns', 'cost_ns'))))
    except ConfigurationError:
        raise
    except (ValueError, KeyError, TypeError, RecursionError, OverflowError) as error:
        raise ConfigurationError('charge replay: {}, line {}: not a record of a charge ({})'.format(
            path, len(costs) + 1, error)) from None
    return costs
