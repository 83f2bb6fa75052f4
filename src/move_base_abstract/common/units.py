"""Conversions between seconds and the integer nanoseconds in which all time is kept."""
from __future__ import annotations

import math

NS_PER_S = 1_000_000_000
#: the last instant of simulated time [ns], where the time master ends: the seconds of a ros::Duration are an int32
LAST_NS = (2 ** 31 - 1) * NS_PER_S
#: the farthest position on each axis [m]: beyond, a float no longer tells millimetres apart, and sums overflow
FARTHEST_M = 1e9


def seconds_to_ns(seconds: float) -> int:
    """Return a finite number of ``seconds`` as the nearest whole number of nanoseconds.

    :raises ValueError: if ``seconds`` is NaN or infinite.
    """
    try:
        whole = math.floor(seconds)
    except (OverflowError, ValueError):
        raise ValueError('seconds must be finite, got {!r}'.format(seconds)) from None
    return whole * NS_PER_S + int(round((seconds - whole) * NS_PER_S))


def check_reachable(time_ns: int, what: str) -> None:
    """Check that simulated time can reach ``time_ns`` [ns].

    :raises ValueError: if simulated time ends before; the text begins with ``what``.
    """
    if time_ns > LAST_NS:
        raise ValueError('{} at {:.10g} s, simulated time ends at {} s'.format(
            what, time_ns / NS_PER_S, LAST_NS // NS_PER_S))
