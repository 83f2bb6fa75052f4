"""Foreseen turns: messages of later instants in a report, for which the time master need not send grants.

Feedback, poses and heartbeats of robots follow from their travel. Until something else happens to the process, these
messages are known; they go into the report, instant by instant. With the next grant the time master says how many of
these turns have happened; the others are taken back.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, List, Sequence, Tuple, Union

from move_base_abstract.lockstep import wire

from . import rollback
from .links import sender

if TYPE_CHECKING:
    from ...clocks.lockstep_clock import LockstepClock

_MOST_TURNS = 64  # in one report; turns that are taken back were computed in vain
_FEWEST_TURNS = 4


class Foresight:
    """The foreseen turns of one participant. The calling thread must have the turn.

    ``source`` has ``foresee(before_ns, most)`` and ``skip(until_ns)``, as EventQueue has them, and
    ``tell(due_ns, series)``, which sends the messages of an instant.
    """

    def __init__(self, source: LockstepClock) -> None:
        self._source = source
        self._turns: List[Tuple[int, List[Callable[[], None]]]] = []  # (instant [ns], functions that take it back)
        self._most = _MOST_TURNS

    def tell(self, before_ns: int, items: List[Union[bytes, Callable[[], bytes]]]) -> int:
        """Append the turns before ``before_ns`` [ns] to the report's ``items``; return the instant after them [ns]."""
        instants, after_ns = self._source.foresee(before_ns, self._most)
        for due_ns, series in instants:
            mark = len(items)
            items.append(wire.at(due_ns))
            rollback.begin()
            try:
                with sender(None):
                    self._source.tell(due_ns, series)
            except rollback.NotForeseeable:
                _take_back(rollback.end())
                del items[mark:]
                return due_ns
            self._turns.append((due_ns, rollback.end()))
        return after_ns

    def came_to_pass(self, count: int) -> None:
        """Keep the first ``count`` turns, which have happened, and take back the others, which never will."""
        turns, self._turns = self._turns, []
        for _due_ns, undos in reversed(turns[count:]):
            _take_back(undos)
        if count:
            self._source.skip(turns[count - 1][0])
        self._most = min(2 * self._most, _MOST_TURNS) if count == len(turns) else max(count + 1, _FEWEST_TURNS)


def _take_back(undos: Sequence[Callable[[], None]]) -> None:
    for undo in reversed(undos):
        undo()
