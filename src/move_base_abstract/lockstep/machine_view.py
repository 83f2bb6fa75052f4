"""What a program sees of the machine's clocks and of its chance: the run's, the same in each run.

As in the library for roscpp programs: dates begin on 2020-01-01 with as many seconds as the seed says, clocks that
count from the machine's start at an hour, and all go on with simulated time and with what was slept by the wall. No
ROS, no threads, no clock.
"""
from __future__ import annotations

import random
from typing import Any, Optional

from ..common.units import NS_PER_S

DATE, UPTIME, PROCESSOR = 'date', 'uptime', 'processor'
EPOCH_NS = 1577836800 * NS_PER_S  # 2020-01-01 UTC
UPTIME_NS = 3600 * NS_PER_S
SEEDS = 315360000  # about ten years
#: by which clocks go on [ns] for a loop of a thread without turns that only looks at them, and after how many looks
STEP_NS, LOOKS = 1000000, 1000
# Of clock_gettime(2) on Linux: CLOCK_REALTIME, _REALTIME_COARSE, _TAI; _PROCESS_CPUTIME_ID, _THREAD_CPUTIME_ID.
_DATES, _PROCESSORS = (0, 5, 11), (2, 3)


class SeenClocks:
    """The clocks. ``is_simulated``: all of them show simulated time itself, as where time.sleep takes it.

    ``slept_ns``: a sequence of one number, where it is kept how far they have gone on by themselves [ns].
    """

    def __init__(self, seed: int, is_simulated: bool, slept_ns: None = None) -> None:
        date_ns = EPOCH_NS + seed % SEEDS * NS_PER_S
        self._starts = {DATE: date_ns, UPTIME: UPTIME_NS, PROCESSOR: 0}
        if is_simulated:
            self._starts = dict.fromkeys(self._starts, 0)
        self._slept_ns = [0] if slept_ns is None else slept_ns
        self._looks = 0

    def read(self, kind: str, now_ns: int) -> int:
        """Return what a clock of this kind shows [ns] at the simulated time ``now_ns`` (0 before the run)."""
        return self._starts[kind] + now_ns + self._slept_ns[0]

    def start(self, kind: Any) -> Any:
        """Return what a clock of this kind shows [ns] before the run."""
        return self._starts[kind]

    def add_sleep(self, duration_ns: int) -> None:
        """So long [ns] was slept by the wall, while simulated time stood."""
        self._slept_ns[0] += duration_ns

    def look(self) -> None:
        """A thread that takes no turns looks at a clock: a loop that does nothing else sees it go on some day."""
        self._looks += 1
        if self._looks % LOOKS == 0:
            self._slept_ns[0] += STEP_NS


def kind_of(clock_id: int) -> str:
    """Return which kind of clock a number of clock_gettime(2) is."""
    if clock_id in _PROCESSORS or clock_id < 0:
        return PROCESSOR
    return DATE if clock_id in _DATES else UPTIME


class Entropy:
    """What the machine's chance would be: bytes that follow from a text (seed, node, purpose) and their place.

    Not secret: keys that a program makes of them can be guessed.
    """

    def __init__(self, text: str) -> None:
        self._generator = random.Random(text)

    def draw(self, size: int) -> Optional[bytes]:
        """Return ``size`` bytes.

        :raises ValueError: if it is negative.
        """
        if size < 0:
            raise ValueError('negative argument not allowed')
        return self._generator.getrandbits(8 * size).to_bytes(size, 'little') if size else b''
