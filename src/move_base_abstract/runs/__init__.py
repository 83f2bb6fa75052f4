"""The results of a run: its event log, and where two logs differ."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'event_log': 'Event EventLog EventLogError compare', 'trace': 'TraceEntry'})
