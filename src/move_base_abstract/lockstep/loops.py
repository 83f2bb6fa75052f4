"""Loops that wait by looking, without sleeping: their looks and turns are counted, until they give the turn away."""
from __future__ import annotations

from typing import Any, Callable, List, Tuple

from .task import Repeated, Task, TurnLost

#: a thread that looks so many times in a row, without a wait, is taken for a loop that waits by looking
LOOKS = 1000
#: the number of further turns of such a loop that looks at variables, until the thread has done something else: in each
#: turn it sees the same
TURNS_AGAIN = 10
#: simulated time [ns] that passes at such a loop if nothing else happens: if it looks at the time, and otherwise
TIME_STEP_NS = 1000000
STEP_NS = 10000000


def holds(condition: Callable[[], object]) -> bool:
    """Return whether a thread's condition holds, or raises an error, so that the thread gets the error itself."""
    try:
        return bool(condition())
    except Exception:
        return True


class Looking:
    """A part of the scheduler: it counts the looks of its threads, and their turns of loops."""

    now_ns: int
    _happened: int
    _conditions: List[Tuple[Callable[[], object], Task]]
    current: Callable[[], Any]
    wait: Callable[..., Any]
    _wait: Callable[..., Any]

    def look(self, step_ns: int, weight: int = 1) -> bool:
        """Note that the calling thread looks at something that may change, without waiting for it.

        It counts as ``weight`` looks. After :data:`LOOKS` looks in a row, the thread is taken for a loop that waits by
        looking, and gives the turn away as in :meth:`look_away`. Return False if lockstep has ended meanwhile.
        """
        task = self.current()
        task.looks += weight
        try:
            if task.looks >= LOOKS:
                self.look_away(step_ns)
        except TurnLost:
            return False
        return True

    def turn(self) -> Task:
        """Count another turn of the calling thread in a loop that may wait by looking; return the thread's task."""
        task: Task = self.current()
        task.turns += 1
        task.idle_turns += 1
        return task

    def repeat(self, done: Repeated, most: int) -> None:
        """Count what the calling thread does again. From the ``most``-th time at one instant on, each takes 1 ms.

        :raises TurnLost: if the participant leaves lockstep meanwhile.
        """
        done.count = done.count + 1 if done.at_ns == self.now_ns else 1
        if done.count > most:
            self.wait(self.now_ns + TIME_STEP_NS)
        done.at_ns = self.now_ns

    def look_away(self, step_ns: int) -> None:
        """Give the turn away until something else has happened in this process, or ``step_ns`` [ns] have passed.

        The calling thread waits by looking. Looks of other such threads do not count as something that happens. The
        counts of looks and turns begin anew, that of idle turns near its end.

        :raises TurnLost: if the participant leaves lockstep meanwhile.
        """
        task = self.current()
        if not task.is_looking:
            self._happened += 1  # it did something before it began to look
        task.is_looking = True
        task.looks = task.turns = 0
        task.idle_turns = LOOKS - TURNS_AGAIN
        seen, wake_ns = self._happened, self.now_ns + step_ns
        entry = (lambda: self._happened != seen, task)
        self._conditions.append(entry)
        try:
            self._wait(task, wake_ns, 'what it looks at again and again', None)
        finally:
            self._conditions.remove(entry)
