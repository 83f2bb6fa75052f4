"""The engine of discrete events: the queue of events, the present time, and draws that follow from a seed."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .alarm import Alarm as Alarm
    from .chance import Chance as Chance, Purpose as Purpose
    from .event_queue import EventQueue as EventQueue
    from .factors import Constant as Constant, Gamma as Gamma, Lognormal as Lognormal, Quantiles as Quantiles
    from .series import Series as Series
    from .simulation import Simulation as Simulation
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
