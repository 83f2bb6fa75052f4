"""A window of simulated time through which a participant goes alone: its input, and its end."""
from __future__ import annotations

from collections import deque
from typing import Any, Deque, List, Tuple

from . import wire

# More turns at one instant are the time master's: it knows a loop without delay.
_MOST_REPEATS = 100
# After these the time master is to be told first: what it makes of them is seen in the next turn.
_TOLD_FIRST = (wire.REST, wire.PARAMETER)


#: what a grant carries, its kind first
Item = Tuple[Any, ...]


class Window:
    """The latest grant's, if it gives one (it does where the time master has a lookahead)."""

    def __init__(self) -> None:
        self.is_open = False
        self._end_ns = 0
        self._repeats = 0
        self._told_at_ns = 0
        self._arrivals: Deque[Tuple[int, List[Item]]] = deque()
        self._walked: List[bytes] = []
        self.walks_to_ns: Any = None  # the instant of the turn that is next, None: the next grant's

    def take(self, items: List[Item], now_ns: int) -> List[Item]:
        """Return those of a grant's items that are for ``now_ns`` [ns], and keep what arrives later in its window."""
        self.is_open = bool(items) and items[0][0] == wire.WINDOW
        if not self.is_open:
            return items
        self._end_ns = items[0][1]
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
        """When what was kept first arrives [ns], or NEVER."""
        return self._arrivals[0][0] if self._arrivals else wire.NEVER

    def walk(self, wish_ns: int, now_ns: int, done: List[bytes]) -> bool:
        """Have the next turn be one of the window, if there is one; return whether there is.

        ``wish_ns``: when the program wants to go on; ``done``: the items (bytes) of the turn at ``now_ns``, which are
        moved from there.
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

    def take_walked(self, done: List[bytes]) -> List[bytes]:
        """Return the items of all turns since the grant; ``done``: those of the last one, moved from there."""
        items = self._walked + done
        self._walked = []
        done.clear()
        return items

    def next_turn(self) -> Tuple[int, List[Item]]:
        """Return (time [ns], items) of that turn, as of a grant."""
        now_ns, self.walks_to_ns = self.walks_to_ns, None
        return now_ns, self.arrived(now_ns)

    def arrived(self, now_ns: int) -> List[Item]:
        """Return what was kept for ``now_ns`` [ns], as a list of items."""
        return self._arrivals.popleft()[1] if self.first_arrival_ns <= now_ns else []
