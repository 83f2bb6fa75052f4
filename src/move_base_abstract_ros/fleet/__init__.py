"""A fleet: many robots in one process, and their zones."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'fleet_server': 'FleetServer'})
