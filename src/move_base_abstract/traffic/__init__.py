"""Traffic: which robots hold a place in zones and on lanes, and which robots wait for a place."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .control import Traffic as Traffic
    from .outline import Outline as Outline
    from .rules import DeadlockPolicy as DeadlockPolicy, TrafficRules as TrafficRules
    from .traveller import Traveller as Traveller
    from .zones import Zone as Zone, read_zones as read_zones
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
