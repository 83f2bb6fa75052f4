"""The metrics of the radio between hosts, from the rows `radio`, `radio_lost` and `link` of an event log."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

from move_base_abstract.runs.metrics import RadioSums

#: src/lockstep/radio_traffic.h and docs/radio.md explain these rows
KINDS = ('radio', 'radio_lost', 'link')
_SENT, _AT = 5, 6  # the places of the instants [ns] in a row `radio`: sent, arrived


class Radio:
    """The sums of a run's messages and links. Without a radio there are none."""

    def __init__(self) -> None:
        self._arrived = self._lost = self._age_ns = 0
        self._links: Dict[Tuple[str, str], Tuple[bool, int]] = {}  # whether it is up, since when [ns]
        self._down_ns = 0

    def take(self, kind: str, values: List[Any], now_ns: int) -> None:
        """Count a row of one of KINDS. Any program may write such a row; rows of another form are ignored."""
        if kind == 'link' and len(values) == 3 and all(isinstance(one, str) for one in values):
            self._turn((values[0], values[1]), values[2] == 'up', now_ns)
        elif kind == 'radio' and len(values) == _AT + 1 and all(type(one) is int for one in values[_SENT:]):
            self._arrived += 1
            self._age_ns += values[_AT] - values[_SENT]
        elif kind == 'radio_lost' and len(values) == _AT + 1:
            self._lost += 1

    def _turn(self, link: Tuple[str, str], is_up: bool, now_ns: int) -> None:
        was_up, since_ns = self._links.get(link, (True, now_ns))
        self._down_ns += 0 if was_up else now_ns - since_ns
        self._links[link] = is_up, now_ns

    def sums(self, end_ns: int) -> Optional[RadioSums]:
        """Return the sums of the run, which ended at ``end_ns``; None if it had no radio."""
        for link, (is_up, _) in list(self._links.items()):
            self._turn(link, is_up, end_ns)
        sent = self._arrived + self._lost
        if not sent and not self._links:
            return None
        return RadioSums(sent, self._arrived, self._age_ns, len(self._links), self._down_ns)
