"""Faults of a robot: failures and deliberate faults, when they come, and the robot's present condition."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'condition': 'Condition', 'failing': 'Failing Failure', 'failures': 'Failures read_failures'})
