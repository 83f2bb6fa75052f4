"""Traffic: which robots hold a place in zones and on lanes, and which robots wait for a place."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'control': 'Traffic', 'rules': 'DeadlockPolicy TrafficRules', 'traveller': 'Traveller',
    'outline': 'Outline', 'zones': 'Zone read_zones'})
