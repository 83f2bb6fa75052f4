"""Whether clocks and other simulators follow, and are still there."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'clock_source': 'ClockSource', 'follow_check': 'FollowCheck', 'rate_cap': 'RateCap',
    'silence_watch': 'SilenceWatch', 'stamp_check': 'StampCheck'})
