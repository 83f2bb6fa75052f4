"""Orders with several stops: how they arrive, which robot gets which one, and when robots charge."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'order': 'Order Stop', 'order_arrivals': 'read_orders', 'dispatcher': 'Dispatcher',
    'policies': 'FreeRobot OpenOrder Policy Question', 'settings': 'DispatchSettings read_dispatcher'})
