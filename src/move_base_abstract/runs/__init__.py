"""What a run has left: its event log, and where two of them go different ways."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'event_log': 'Event EventLog EventLogError compare', 'trace': 'TraceEntry'})
