"""Parameters of robots, their checks, and the names that upstream's setups carry."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'rates': 'Rates', 'settings': 'RobotSettings read_settings', 'upstream': 'LocalPlanner'})
