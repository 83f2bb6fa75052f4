"""The parameters of robots and nodes, their checks, and the parameter names of existing move_base set-ups."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'rates': 'Rates', 'settings': 'RobotSettings read_settings', 'upstream': 'LocalPlanner'})
