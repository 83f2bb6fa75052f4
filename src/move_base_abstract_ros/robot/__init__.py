"""One robot under move_base's interface: its actions, services, parameters and topics."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'host': 'Host', 'move_base_server': 'MoveBaseServer'})
