"""The radio between hosts as files describe it, and robots' motions as they are sent to the time master."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'motion_pieces': 'pieces_of', 'network': 'read_network resolve'})
