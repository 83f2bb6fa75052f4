"""What a participant's source of events tells by itself, told beforehand: turns that the time master need not grant.

Feedback, poses and heartbeats of robots follow from where they travel. Until something else happens to the process,
what it will tell is known; it goes into the report, instant by instant. With the next grant the time master says how
many of these turns have come to pass; the others are taken back.
"""
from move_base_abstract.lockstep import wire

from . import rollback
from .links import sender

_MOST_TURNS = 64  # of a report; what is taken back was computed in vain
_FEWEST_TURNS = 4


class Foresight:
    """Of one participant. Whoever calls it has the participant's turn.

    ``source`` has ``foresee(before_ns, most)``, as of EventQueue, ``tell(due_ns, series)`` and ``skip(until_ns)``.
    """

    def __init__(self, source):
        self._source = source
        self._turns = []  # (instant [ns], what takes it back)
        self._most = _MOST_TURNS

    def tell(self, before_ns, items):
        """Append to the report's ``items`` what comes before ``before_ns`` [ns]; return what comes after that [ns]."""
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

    def came_to_pass(self, count):
        """The first ``count`` of the turns have happened, the others never will."""
        turns, self._turns = self._turns, []
        for _due_ns, undos in reversed(turns[count:]):
            _take_back(undos)
        if count:
            self._source.skip(turns[count - 1][0])
        self._most = min(2 * self._most, _MOST_TURNS) if count == len(turns) else max(count + 1, _FEWEST_TURNS)


def _take_back(undos):
    for undo in reversed(undos):
        undo()
