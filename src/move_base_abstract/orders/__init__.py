"""Orders of several stops: how they arrive, who gets which, and when robots charge. No robots are moved here."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'order': 'Order Stop', 'order_arrivals': 'read_orders', 'dispatcher': 'Dispatcher',
    'policies': 'FreeRobot OpenOrder Policy Question', 'settings': 'DispatchSettings read_dispatcher'})
