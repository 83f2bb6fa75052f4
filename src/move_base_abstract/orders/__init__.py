"""Orders with several stops: how they arrive, which robot gets which one, and when robots charge."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .dispatcher import Dispatcher as Dispatcher
    from .order import Order as Order, Stop as Stop
    from .order_arrivals import read_orders as read_orders
    from .policies import FreeRobot as FreeRobot, OpenOrder as OpenOrder, Policy as Policy, Question as Question
    from .settings import DispatchSettings as DispatchSettings, read_dispatcher as read_dispatcher
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
