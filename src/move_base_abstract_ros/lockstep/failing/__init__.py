"""What nobody catches and for which nobody asks, as events of the run."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'uncaught': 'tell'})
