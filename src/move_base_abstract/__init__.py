"""The simulator's core: robots whose travel is computed in closed form. It needs no ROS."""
from pkgutil import extend_path
from typing import TYPE_CHECKING

# In a devel space the generated messages are in another folder of the same name. Whichever folder is found first must
# lead to both.
__path__ = extend_path(__path__, __name__)

if TYPE_CHECKING:
    from .fleet.dispatch import Dispatch as Dispatch
    from .fleet.fleet import Fleet as Fleet
    from .processes import Environment as Environment
    from .scenario import Scenario as Scenario, make_scenario as make_scenario, read_scenario as read_scenario
else:
    from .common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
