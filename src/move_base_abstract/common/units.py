"""Conversions between seconds and the integer nanoseconds in which all time is kept."""
from __future__ import annotations

import math

NS_PER_S = 1_000_000_000
DAY_NS = 86_400 * NS_PER_S
#: the last instant of simulated time [ns], where the time master ends: the seconds of a ros::Duration are an int32
LAST_NS = (2 ** 31 - 1) * NS_PER_S
#: the farthest position on each axis [m]: beyond, a float no longer tells millimetres apart, and sums overflow
FARTHEST_M = 1e9
_MOST_SHOWN = NS_PER_S * 10 ** 300  # [ns]; seconds must be a float


def seconds_to_ns(seconds: float) -> int:
    """Return a finite number of ``seconds`` as the nearest whole number of nanoseconds.

    :raises ValueError: if ``seconds`` is NaN or infinite.
    """
    try:
        whole = math.floor(seconds)
    except (OverflowError, ValueError):
        raise ValueError('seconds must be finite, got {!r}'.format(seconds)) from None
    return whole * NS_PER_S + int(round((seconds - whole) * NS_PER_S))


def exact_seconds(time_ns: int) -> str:
    """Return a time [ns] that is not negative in seconds, with all nine digits: '41.200000000'."""
    return '{}.{:09d}'.format(*divmod(time_ns, NS_PER_S))


def far_ahead(what: str, due_ns: int, now_ns: int, longest_ns: int = DAY_NS, name: str = 'a day') -> str:
    """Return in words that ``what`` is at ``due_ns`` [ns], more than ``longest_ns`` [ns] ahead of now; '' if it is not.

    Whatever input has something wait for an instant asks this. ``name``: of the parameter with the bound.
    """
    ahead_ns = due_ns - now_ns
    if ahead_ns <= longest_ns:
        return ''
    at, ahead, longest = (ns / NS_PER_S for ns in (due_ns, ahead_ns, longest_ns))
    return f'{what} is at {at:.10g} s, {ahead:.10g} s ahead, more than {name} ({longest:.10g} s)'


def check_reachable(time_ns: int, what: str) -> None:
    """Check that simulated time can reach ``time_ns`` [ns].

    :raises ValueError: if simulated time ends before; the text begins with ``what``.
    """
    if time_ns > LAST_NS:
        at = '{:.10g} s'.format(time_ns / NS_PER_S) if time_ns < _MOST_SHOWN else 'more than 1e300 s'
        raise ValueError('{} at {}, simulated time ends at {} s'.format(what, at, LAST_NS // NS_PER_S))
