"""Loops that wait by looking, without sleeping: what is counted, and when they give the turn away."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, List, Tuple

if TYPE_CHECKING:
    from .task import Task

#: so many looks in a row, without a wait, are a loop that waits for something by looking
LOOKS = 1000
#: simulated time that passes at such a loop if nothing else happens [ns]: where it looks at the time, and elsewhere
TIME_STEP_NS = 1000000
STEP_NS = 10000000


def holds(condition: Callable[[], object]) -> bool:
    """Whether a thread's condition holds, or fails: then that thread is to look at it, so that the error is its own."""
    try:
        return bool(condition())
    except Exception:
        return True


class Looking:
    """A part of the scheduler: its threads' looks and turns of loops."""

    now_ns: int
    _happened: int
    _conditions: List[Tuple[Callable[[], object], Task]]
    current: Callable[[], Any]
    _wait: Callable[..., Any]

    def look(self, step_ns: int, weight: int = 1) -> None:
        """The calling thread looks at something that may change, without waiting for it.

        After :data:`LOOKS` looks in a row, of this ``weight``, it is taken for a loop that waits by looking.

        :raises TurnLost: as :meth:`wait`.
        """
        task = self.current()
        task.looks += weight
        if task.looks >= LOOKS:
            self.look_away(step_ns)

    def turn(self) -> Task:
        """The calling thread goes once more round a loop that may wait by looking; return its task, which counts."""
        task: Task = self.current()
        task.turns += 1
        task.idle_turns += 1
        return task

    def look_away(self, step_ns: int) -> None:
        """Give the turn away until something else has happened in this process, or until ``step_ns`` [ns] later.

        The calling thread waits by looking: what merely looks, too, is nothing that happens. Looks and turns are
        counted anew: the next one after what it has waited for is the first.
        """
        task = self.current()
        if not task.is_looking:
            self._happened += 1  # what it did before it began to look
        task.is_looking = True
        task.looks = task.turns = task.idle_turns = 0
        seen, wake_ns = self._happened, self.now_ns + step_ns
        entry = (lambda: self._happened != seen, task)
        self._conditions.append(entry)
        try:
            self._wait(task, wake_ns, 'what it looks at again and again', None)
        finally:
            self._conditions.remove(entry)
