"""Batteries: the state of charge as a formula, and the energy that a leg takes."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .battery import Battery as Battery, BatterySettings as BatterySettings, read_battery as read_battery
    from .consumption import LegEnergy as LegEnergy, Mechanics as Mechanics
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
