"""What the seeds vary besides the order of equal events: delays of messages, and starts of nodes."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Tuple

from move_base_abstract.common.kinds import short

DELAY_S, STARTS_S = 0.05, 0.5  # simulated; of even seeds, unless the user gives one of them


class Bounds(NamedTuple):
    """The largest delay of a message, and the largest lateness of a node's start [s, simulated]; 0: none."""

    delay: float = 0.0
    starts: float = 0.0

    def said(self) -> str:
        """Return what is varied besides the order of equal events, in words; '' if nothing is."""
        return ' and '.join([*([f'delays up to {self.delay:g} s'] if self.delay else []),
                             *([f'starts up to {self.starts:g} s late'] if self.starts else [])])


@dataclass(frozen=True)
class Variation:
    """The bounds of each seed. ``delay``, ``starts``: as the user gives them for all seeds [s, simulated], or None.

    If both are None, seeds with an odd number vary the order alone, and those with an even number all. So a seed is the
    same run in each search. ``has_network``: whether messages take the time that a radio says.
    """

    delay: Optional[float] = None
    starts: Optional[float] = None
    has_network: bool = False

    def of(self, seed: int) -> Bounds:
        """Return the Bounds of a seed; of 0, the stated order, nothing."""
        if not seed:
            return Bounds()
        if self.delay is None and self.starts is None:
            return Bounds() if seed % 2 else Bounds(0.0 if self.has_network else DELAY_S, STARTS_S)
        return Bounds(self.delay or 0.0, self.starts or 0.0)

    def words(self) -> List[str]:
        """Return the words of a command line that mean the same."""
        return [word for name, value in (('--delay', self.delay), ('--starts', self.starts)) if value is not None
                for word in (name, short(value))]

    def said(self, seeds: Tuple[int, int]) -> str:
        """Return in words what the seeds from the first to the last one vary."""
        first, last = seeds
        odd, even = self.of(first | 1), self.of(first + first % 2)
        if odd == even or first == last:
            more = self.of(first).said()
            return 'the order of equal events' + (', ' + more if more else '')
        return f'the order of equal events; those with an even number also {even.said()}'
