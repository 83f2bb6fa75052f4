"""Many robots in plain Python, without ROS."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'dispatch': 'Dispatch', 'fleet': 'Fleet FleetWarning TraceEntry', 'member': 'Member'})
