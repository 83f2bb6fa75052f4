"""Conversions between seconds and the integer nanoseconds in which all time is kept."""
import math

NS_PER_S = 1_000_000_000


def seconds_to_ns(seconds):
    """Return a finite number of ``seconds`` as the nearest whole number of nanoseconds.

    :raises ValueError: if ``seconds`` is NaN or infinite.
    """
    if not math.isfinite(seconds):
        raise ValueError('seconds must be finite, got {!r}'.format(seconds))
    whole = math.floor(seconds)
    return int(whole) * NS_PER_S + int(round((seconds - whole) * NS_PER_S))


def ns_to_seconds(time_ns):
    """Return ``time_ns`` [ns] in seconds, as a float (for people and logs, never for sums)."""
    return time_ns / NS_PER_S
