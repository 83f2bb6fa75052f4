"""Batteries: the state of charge as a formula, and the energy that a leg takes."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'battery': 'Battery BatterySettings read_battery', 'consumption': 'LegEnergy Mechanics'})
