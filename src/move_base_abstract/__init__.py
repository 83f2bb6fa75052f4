"""The simulator's core: robots whose travel is computed in closed form. It needs no ROS."""
from pkgutil import extend_path

from .common.handed_on import handed_on

# In a devel space the generated messages are in another folder of the same name. Whichever folder is found first must
# lead to both.
__path__ = extend_path(__path__, __name__)

__getattr__ = handed_on(__name__, {
    'fleet.dispatch': 'Dispatch', 'fleet.fleet': 'Fleet', 'processes': 'Environment',
    'scenario': 'Scenario make_scenario read_scenario'})
