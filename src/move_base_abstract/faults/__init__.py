"""What may go wrong with a robot, when it does, and its present condition."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'condition': 'Condition', 'failing': 'Failing Failure', 'failures': 'Failures read_failures'})
