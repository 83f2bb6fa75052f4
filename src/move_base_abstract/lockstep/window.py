"""A window of simulated time through which a participant goes by itself: its mail, and its end."""
from __future__ import annotations

from collections import deque
from typing import Any, Deque, List, Tuple

from . import wire

# After so many turns at one instant the time master decides, because it can detect a loop without delay.
_MOST_REPEATS = 100
# A turn with one of these items is reported first, because what the time master makes of it matters in the next turn.
_TOLD_FIRST = (wire.REST, wire.PARAMETER)


#: an item of a grant, its kind first
Item = Tuple[Any, ...]


class Window:
    """The window of the latest grant, if it has one; it has if the time master has a lookahead."""

    def __init__(self) -> None:
        self.is_open = False
        self.lookahead_ns = 0  # the time that each message takes [ns]
        self._end_ns = 0
        self._repeats = 0
        self._told_at_ns = 0
        self._arrivals: Deque[Tuple[int, List[Item]]] = deque()
        self._walked: List[bytes] = []
        self.walks_to_ns: Any = None  # when the next turn in the window is [ns]; None: a grant begins it

    def take(self, items: List[Item], now_ns: int) -> List[Item]:
        """Return the items of a grant that are for ``now_ns`` [ns], and keep those that arrive later in its window."""
        self.is_open = bool(items) and items[0][0] == wire.WINDOW
        if not self.is_open:
            return items
        self._end_ns, self.lookahead_ns = items[0][1:3]
        self._repeats, self._told_at_ns = 0, now_ns
        now = self.arrived(now_ns)
        into = now
        for item in items[1:]:
            if item[0] == wire.ARRIVES:
                into = []
                self._arrivals.append((item[1], into))
            else:
                into.append(item)
        return now

    @property
    def first_arrival_ns(self) -> int:
        """When the first of the kept items arrives [ns], or NEVER."""
        return self._arrivals[0][0] if self._arrivals else wire.NEVER

    def walk(self, wish_ns: int, now_ns: int, done: List[Any]) -> bool:
        """Go to the next turn in the window, if there is one; return whether there is.

        ``wish_ns`` [ns]: when the program wants to go on. ``done``: the items (bytes) of the turn at ``now_ns`` [ns];
        they are kept here, and the list is emptied.
        """
        if any(item[0] in _TOLD_FIRST for item in done):
            return False
        due_ns = max(now_ns, min(wish_ns, self.first_arrival_ns))
        self._repeats = self._repeats + 1 if due_ns == now_ns else 0
        if due_ns >= self._end_ns or self._repeats > _MOST_REPEATS:
            return False
        self.walks_to_ns = due_ns
        self._walked += done
        done.clear()
        if due_ns != self._told_at_ns:
            self._told_at_ns = due_ns
            self._walked.append(wire.at(due_ns))
        return True

    def take_walked(self, done: List[Any]) -> List[bytes]:
        """Return the items of all turns since the grant; ``done``: those of the last turn; the list is emptied."""
        items = self._walked + done
        self._walked = []
        done.clear()
        return items

    def next_turn(self) -> Tuple[int, List[Item]]:
        """Return (time [ns], items) of the next turn in the window, as if a grant had brought them."""
        now_ns, self.walks_to_ns = self.walks_to_ns, None
        return now_ns, self.arrived(now_ns)

    def arrived(self, now_ns: int) -> List[Item]:
        """Return the list of items that were kept for ``now_ns`` [ns]."""
        return self._arrivals.popleft()[1] if self.first_arrival_ns <= now_ns else []
