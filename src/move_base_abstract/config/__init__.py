"""The parameters of robots and nodes, their checks, and the parameter names of existing move_base set-ups."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .rates import Rates as Rates
    from .settings import RobotSettings as RobotSettings, read_settings as read_settings
    from .upstream import LocalPlanner as LocalPlanner
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
