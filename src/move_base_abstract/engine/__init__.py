"""The engine of discrete events: what is due when, the present, and chance that follows from a seed."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'alarm': 'Alarm', 'chance': 'Chance Purpose', 'event_queue': 'EventQueue Series',
    'factors': 'Constant Gamma Lognormal Quantiles', 'simulation': 'Simulation'})
