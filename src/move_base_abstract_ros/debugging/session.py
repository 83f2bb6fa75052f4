"""A debugging session: one run after another of the same command. To go back is a new run, held to what is known."""
from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING, Callable, Iterator, List, Optional, Sequence

from move_base_abstract.runs.built_in import ALL, Broken

from .stops import STANDS, Refused, Stop

if TYPE_CHECKING:
    from .debugged_run import DebuggedRun
    from .log_so_far import LogSoFar
    from .node_sessions import News, Place

_FIRST_SLICE_NS = 10 ** 9  # simulated


class Session:
    """Runs of one command, one at a time.

    ``begin(folder, log, places)``: starts one, with these paths of a new folder and of its event log, and these
    breakpoints. ``folder``: of this session, with one folder for each run; ``log``: the event log of the first run, '':
    it lies there. ``known``: a log whose rows all runs must have, as far as both go. ``meet``, which may be set: see
    DebuggedRun.
    """

    def __init__(self, begin: Callable[[str, str, Sequence[Place]], DebuggedRun], folder: str, log: str = '',
                 known: Optional[LogSoFar] = None) -> None:
        self._begin, self._folder, self._log = begin, folder, log
        self._ending = os.path.splitext(known.path if known else log)[1] or '.jsonl'
        self._numbers = itertools.count(1)
        self._given = known
        self._known: Sequence[bytes] = known.lines if known else []
        self._equal = 0  # the number of rows of this run that are known to be equal
        self.said: List[str] = []  # lines for the user that no command has shown yet
        self.is_repeatable = True
        self.meet: Callable[[List[News]], object] = lambda _news: None
        self.run = self._begun([])

    def _begun(self, places: Sequence[Place]) -> DebuggedRun:
        number = next(self._numbers)
        folder = os.path.join(self._folder, 'run_{}'.format(number))
        self._equal = 0
        run = self._begin(folder, self._log if self._log and number == 1 else os.path.join(
            folder, 'events' + self._ending), places)
        run.meet = self._meet
        return run

    def _meet(self, news: List[News]) -> None:
        self.meet(news)

    # --- going on ----------------------------------------------------------------------------------------------------

    def go(self, stop: Stop) -> None:
        """Run until ``stop``, or until the run cannot go on. :raises Refused: if it cannot go."""
        try:
            self.run.go(stop)
        except KeyboardInterrupt:
            self.run.interrupt()
        self._hold()

    def go_until(self, instant_ns: int) -> None:
        """Run to an instant [ns] that is still to come."""
        self.go(Stop.at(instant_ns))

    def until_broken(self, properties: Sequence[str] = (ALL,)) -> Optional[Broken]:
        """Run until a row of the log breaks a property that no row before has broken; return it, or None."""
        self.run.check_stopped()
        low, slice_ns = len(self.run.log.lines), _FIRST_SLICE_NS
        known = self.run.log.broken(low, properties)
        while True:
            self.go_until(self.run.now_ns + slice_ns)
            found = self.run.log.first_break(low, known, properties)
            if found is not None:
                self._stand_at(found[0])
                return found[1]
            if self.run.is_over or self.run.state.phase in STANDS or self.run.state.phase == 'stopped':
                return None
            low, slice_ns = len(self.run.log.lines), 2 * slice_ns

    def _stand_at(self, row: int) -> None:
        """Have the run stand after the round in which the log got ``row`` rows; one more than it has: at its end."""
        log = self.run.log
        if row < len(log.lines) or row == len(log.lines) and (
                self.run.is_over or log.entries(row - 1, row)[0].time_ns < self.run.now_ns):
            self.to_row(row)

    # --- going back --------------------------------------------------------------------------------------------------

    def back_rows(self, count: int) -> None:
        """Go to before the last ``count`` rows: to a round, since a round is the smallest step."""
        before = len(self.run.log.lines)
        wanted, log = before - count, self.run.log
        self.to_row(wanted)
        if wanted > 0 and len(self.run.log.lines) >= before:
            earlier = log.before(log.entries(wanted - 1, wanted)[0].time_ns)
            self.said.append('rows {} to {} are of one round: this is the instant before'.format(wanted, before))
            self.to_row(earlier)

    def to_row(self, row: int) -> None:
        """Go to the round after which the log has ``row`` rows, in a new run; 0 or less: to the start."""
        self.again(Stop.at_row(row) if row > 0 else None)

    def to_instant(self, instant_ns: int) -> None:
        """Go to an instant [ns], in a new run if it has gone by."""
        if not self.run.is_over and instant_ns > self.run.now_ns:
            self.go_until(instant_ns)
        else:
            self.again(Stop.at(instant_ns))

    def again(self, stop: Optional[Stop]) -> None:
        """Start the run again, in the place of the present one, and go to ``stop``; None: it stands at its start."""
        if self.run.touched:
            self.said.append('the run before is thrown away: {}'.format(self.run.touched))
        self.run.end()
        self.run = self._begun(self.run.nodes.places)
        if not self.run.await_start():
            raise Refused('the run did not start again (exit code {})'.format(self.run.await_end()))
        if stop is not None and not 0 < stop.until_ns <= self.run.now_ns:
            self.go(stop)

    # --- the same run? -----------------------------------------------------------------------------------------------

    def _hold(self) -> None:
        """Hold the rows of this run to those that are known, and say so if one differs."""
        run = self.run
        run.log.read()
        if run.touched:
            if self._known is run.log.lines:
                self._known = run.log.lines[:self._equal]
            return
        number = run.log.difference_from(self._known, self._equal)
        if number is not None:
            self.is_repeatable = False
            self.said += self._difference(number)
            self._known = run.log.lines
        elif len(run.log.lines) >= len(self._known):
            self._known = run.log.lines
        self._equal = len(run.log.lines)

    def _difference(self, number: int) -> Iterator[str]:
        yield ('row {} is not as in {}: something has changed since, or this system is not repeatable'.format(
            number, self._given.path) if self._given is not None and self._known is self._given.lines else
            'row {} is not as it was in the run before: this system is not repeatable, so back leads to another '
            'run'.format(number))
        for name, lines in (('before', self._known), ('now', self.run.log.lines)):
            yield '  {}: {}'.format(name, lines[number - 1].decode('utf-8', 'replace').rstrip())
        yield 'what makes it so: why; next: rosrun move_base_abstract verify with the same words'
