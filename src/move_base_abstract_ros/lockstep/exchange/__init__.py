"""Exchange with the time master: the connection, topics, services, and foreseen turns."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'access': 'is_lockstep', 'links': 'repetition sender'})
