"""Where a debugged run stops, in plain values, and why it sometimes does not."""
from __future__ import annotations

from typing import NamedTuple

from move_base_abstract.common.errors import SimulatorError

#: after what a run stops, as StopWhen.srv has it
ROUND, ROW = 0, 1
#: so many rows has no log: a run with this stop goes on until something else stops it
NEVER = 2 ** 62
#: phases in which nothing happens until somebody asks for it, and those in which the run cannot go on by itself
STOPPED, STANDS = ('stopped', 'paused'), ('idle', 'deadlock', 'zero_delay_loop', 'ended')


class Refused(SimulatorError):
    """A command cannot be done now. The text says why, and what to do instead."""


class Stop(NamedTuple):
    """Where a run stops: after a round, or after that in which a row comes; the fields are those of StopWhen.srv."""

    what: int = ROUND
    kind: str = ''
    robot: str = ''
    topic: str = ''
    times: int = 1
    row: int = 0
    until_ns: int = 0

    @staticmethod
    def at_row(row: int) -> Stop:
        """Return the stop after the round in which the log gets this number of rows."""
        return Stop(ROW, times=0, row=row)

    @staticmethod
    def at(instant_ns: int) -> Stop:
        """Return the stop at an instant [ns]."""
        return Stop.at_row(NEVER)._replace(until_ns=instant_ns)
