"""Many robots in plain Python, without ROS."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .dispatch import Dispatch as Dispatch
    from .fleet import Fleet as Fleet, FleetWarning as FleetWarning, TraceEntry as TraceEntry
    from .member import Member as Member
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
