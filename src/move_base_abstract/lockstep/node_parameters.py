"""The private parameters of every node that takes part. Checks and pages use this table."""
from __future__ import annotations

from ..common.kinds import FLAG, integer, string
from ..common.parameter_table import Parameter
from .wire import MAX_RANK

RANK = Parameter('lockstep_rank', None, integer(-MAX_RANK - 1, MAX_RANK),
                 'Place of the node among messages of one instant, lowest first; robots have 0.')
#: these parameters are read when the node joins, and when its clock is made
TABLE = (
    RANK,
    Parameter('lockstep_charge', 'none',
              string("'none', 'fixed:SECONDS', 'measured', 'measured:FILE', 'measured_cpu', 'measured_cpu:FILE' or "
                     "'replay:FILE'"), 'Simulated time that the work of the node takes.'),
    Parameter('play_output', True, FLAG,
              'Whether the time master makes its periodic output; the events are the same, for comparing.'),
    Parameter('events_only', False, FLAG,
              'In lockstep, nothing is sent at a rate unless its own parameter says so; a namespace above counts, '
              'too.'),
    Parameter('tell_newcomers', True, FLAG,
              'In lockstep, who begins to listen to poses, tf, scans or feedback of robots is told the present ones; '
              'a namespace above counts, too.'),
    Parameter('log_motion', False, FLAG,
              'In lockstep, the event log has exactly how robots drive; a namespace above counts, too.'),
)
