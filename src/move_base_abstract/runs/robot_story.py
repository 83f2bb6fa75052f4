"""What one robot did in a run: its states, from what has begun and not ended, and the sums of its deeds."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from .states import IDLE, STATES, Cause


class Span(NamedTuple):
    """A robot is in the state with the number ``state`` in STATES from ``begin_ns`` to ``end_ns``."""

    begin_ns: int
    end_ns: int
    state: int


@dataclass
class Robot:
    """One robot: the sums of its times and deeds, and its present."""

    name: str
    since_ns: int
    state: int = IDLE  # its number in STATES
    ns: List[int] = field(default_factory=lambda: [0] * len(STATES))  # in each state
    spans: List[Span] = field(default_factory=list)
    goals: int = 0  # that it has reached
    goals_missed: int = 0
    missed: List[int] = field(default_factory=list)  # when its goals and tasks failed [ns]
    orders: int = 0
    failures: int = 0
    charges: int = 0
    charge: Optional[float] = None  # the last state of charge in the rows, 0..1
    used: float = 0.0  # J
    charged: float = 0.0
    at: Optional[Tuple[float, float]] = None  # (x, y) [m] where it stands or stood last
    #: [(what, its name, number of the state, since [ns])]: what has begun and not ended
    open: List[Tuple[str, Any, int, int]] = field(default_factory=list)
    #: {(what, where): (since [ns], at, number)} of the Stays that have begun and not ended
    stays: Dict[Tuple[str, str], Tuple[int, Optional[Tuple[float, float]], int]] = field(default_factory=dict)

    def begun(self, what: str) -> Optional[int]:
        """Return since when [ns] something of this kind is open, or None."""
        return next((since_ns for one, _, _, since_ns in self.open if one == what), None)

    def begin(self, cause: Cause, state: int, name: Any, now_ns: int) -> None:
        """Begin what ``name`` names, or have it go on in another state; without a name it is one more."""
        since_ns = now_ns
        if not cause.named or name is not None:
            known = [one for one in self.open if one[:2] == (cause.what, name)]
            since_ns = known[0][3] if known else now_ns
            self.open = [one for one in self.open if one not in known]
        self.open.append((cause.what, name, state, since_ns))

    def end(self, cause: Cause, state: int, name: Any) -> None:
        """End what ``name`` names; if nothing of this name is open, the first without a name, or in this state."""
        for fits in (lambda one: one[1] == name, lambda one: one[1] is None, lambda one: one[2] == state):
            found = next((one for one in self.open if one[0] == cause.what and fits(one)), None)
            if found is not None:
                self.open.remove(found)
                return

    def settle(self, now_ns: int, keeps_spans: bool) -> None:
        """Go on to ``now_ns`` [ns], in the state that holds from there on."""
        state = min((one[2] for one in self.open), key=lambda number: STATES[number].precedence, default=IDLE)
        self.ns[self.state] += max(0, now_ns - self.since_ns)  # a clock that starts anew takes nothing back
        if keeps_spans and now_ns > self.since_ns:
            last = self.spans[-1] if self.spans else Span(0, self.since_ns - 1, IDLE)
            if last.state == self.state and last.end_ns == self.since_ns:
                self.spans[-1] = Span(last.begin_ns, now_ns, self.state)
            else:
                self.spans.append(Span(self.since_ns, now_ns, self.state))
        self.state, self.since_ns = state, now_ns
