"""Checks whether clocks and other simulators follow the run, and whether they still run."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'clock_source': 'ClockSource', 'follow_check': 'FollowCheck', 'rate_cap': 'RateCap',
    'silence_watch': 'SilenceWatch', 'stamp_check': 'StampCheck'})
