"""Scales of pictures: from values to places, with round numbers beside them."""

import math
from typing import NamedTuple

from .wording import fixed

_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)


class Axis(NamedTuple):
    """A stretch of values and what is written beside it."""

    low: float
    high: float
    ticks: tuple  # of (value, text)

    def share(self, value):
        """Return where a value lies, 0 at the low end, 1 at the high one."""
        return (value - self.low) / (self.high - self.low)


def axis(values, parts=5, pad=0.04, with_zero=False):
    """Return the Axis that shows all these values (finite, at least one)."""
    low, high = min(values), max(values)
    if with_zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low <= 1e-9 * max(abs(low), abs(high)):  # all the same: room on both sides
        room = abs(high) * 0.1 or 1.0
        low, high = low - room, high + room
    room = pad * (high - low)
    low, high = low - room, high + room
    step = _step((high - low) / parts)
    decimals = _decimals(step)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return Axis(low, high, tuple((each * step, fixed(each * step, decimals)) for each in range(first, last + 1)))


def _step(least):
    """Return the least round step that is no smaller."""
    size = 10.0 ** math.floor(math.log10(least))
    return next(each * size for each in _STEPS if each * size >= least * (1.0 - 1e-9))


def _decimals(step):
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return decimals if abs(round(step, decimals) - step) < 1e-6 * step else decimals + 1
