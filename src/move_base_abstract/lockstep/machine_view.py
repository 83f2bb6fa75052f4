"""The clocks and random bytes of the machine as a program in a run sees them: they are the same in each run.

As in the library for roscpp programs, dates begin at 2020-01-01 plus as many seconds as the seed says, and clocks that
count from the machine's start begin at one hour. All of them go on with simulated time, and with the wall time of
sleeps. This module needs no ROS, has no threads and reads no clock.
"""
from __future__ import annotations

import random
from typing import MutableSequence, Optional

from ..common.units import NS_PER_S

DATE, UPTIME, PROCESSOR = 'date', 'uptime', 'processor'
EPOCH_NS = 1577836800 * NS_PER_S  # 2020-01-01 UTC
UPTIME_NS = 3600 * NS_PER_S
SEEDS = 315360000  # the number of different dates: seconds of about ten years
#: if a thread that takes no turns only looks at clocks, they go on by so much [ns] after so many looks
STEP_NS, LOOKS = 1000000, 1000
# In clock_gettime(2) on Linux: CLOCK_REALTIME, _REALTIME_COARSE, _TAI; _PROCESS_CPUTIME_ID, _THREAD_CPUTIME_ID.
_DATES, _PROCESSORS = (0, 5, 11), (2, 3)


class SeenClocks:
    """The clocks that a program sees. ``is_simulated``: all of them show simulated time itself, as if sleeps take it.

    ``slept_ns``: a sequence of one number, which is how far the clocks have gone on besides simulated time [ns].
    """

    def __init__(self, seed: int, is_simulated: bool, slept_ns: Optional[MutableSequence[int]] = None) -> None:
        date_ns = EPOCH_NS + seed % SEEDS * NS_PER_S
        self._starts = {DATE: date_ns, UPTIME: UPTIME_NS, PROCESSOR: 0}
        if is_simulated:
            self._starts = dict.fromkeys(self._starts, 0)
        self._slept_ns: MutableSequence[int] = [0] if slept_ns is None else slept_ns
        self._looks = 0

    def read(self, kind: str, now_ns: int) -> int:
        """Return the reading [ns] of a clock of this kind at the simulated time ``now_ns`` [ns] (0 before the run)."""
        return self._starts[kind] + now_ns + self._slept_ns[0]

    def start(self, kind: str) -> int:
        """Return the reading [ns] of a clock of this kind before the run."""
        return self._starts[kind]

    def add_sleep(self, duration_ns: int) -> None:
        """Add a sleep of ``duration_ns`` [ns] of wall time, during which simulated time stood still."""
        self._slept_ns[0] += duration_ns

    def look(self) -> None:
        """Note that a thread that takes no turns looks at a clock, so that its loop sees it go on after many looks."""
        self._looks += 1
        if self._looks % LOOKS == 0:
            self._slept_ns[0] += STEP_NS


def kind_of(clock_id: int) -> str:
    """Return the kind of the clock with this number in clock_gettime(2): DATE, UPTIME or PROCESSOR."""
    if clock_id in _PROCESSORS or clock_id < 0:
        return PROCESSOR
    return DATE if clock_id in _DATES else UPTIME


class Entropy:
    """Replaces the machine's random bytes: these follow from a text (seed, node, purpose) and their place.

    They are not secret: keys that a program makes of them can be guessed.
    """

    def __init__(self, text: str) -> None:
        self._generator = random.Random(text)

    def draw(self, size: int) -> bytes:
        """Return the next ``size`` bytes.

        :raises ValueError: if ``size`` is negative.
        """
        if size < 0:
            raise ValueError('negative argument not allowed')
        return self._generator.getrandbits(8 * size).to_bytes(size, 'little') if size else b''
