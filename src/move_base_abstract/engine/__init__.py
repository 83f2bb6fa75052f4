"""The engine of discrete events: the queue of events, the present time, and draws that follow from a seed."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'alarm': 'Alarm', 'chance': 'Chance Purpose', 'event_queue': 'EventQueue Series',
    'factors': 'Constant Gamma Lognormal Quantiles', 'simulation': 'Simulation'})
