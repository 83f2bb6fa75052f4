"""Conversion of messages to the core's values and to bytes, publishers of such bytes, and final answers in order."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'outbox': 'Outbox', 'outlets': 'Outlet LatchedOutlets'})
