"""The results of a run: its event log, the first difference of two logs, and what the log says of robots and orders."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'event_log': 'Event EventLog EventLogError compare', 'trace': 'TraceEntry'})
