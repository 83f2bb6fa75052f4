"""What goes to the time master and comes from it: the connection, topics, services, what is told beforehand."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'access': 'is_lockstep', 'links': 'repetition sender'})
