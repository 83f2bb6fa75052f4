"""The present of a process, on the scaled clock and in lockstep, and whatever differs between the two."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'lockstep_clock': 'LockstepClock', 'ros_clock': 'RosClock', 'throttle': 'WallThrottle', 'timing': 'make_timing'})
