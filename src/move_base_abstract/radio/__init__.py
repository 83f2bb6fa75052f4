"""The radio between hosts, from its description in a file, and robots' motions in the form for the time master."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'motion_pieces': 'pieces_of', 'network': 'read_network resolve'})
