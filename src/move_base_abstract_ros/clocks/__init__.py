"""The clock of a process, on the scaled clock and in lockstep, and everything that differs between the two."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'lockstep_clock': 'LockstepClock', 'ros_clock': 'RosClock', 'throttle': 'WallThrottle', 'timing': 'make_timing'})
