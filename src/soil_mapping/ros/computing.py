"""The clock while the mission computes.

Real time goes on. The scaled clock of the time master is held, so that computing takes the simulated time that it would
take on a robot. In lockstep time stands still, and the node's charge (~lockstep_charge) says how long computing takes.
"""

import contextlib

import rospy

from move_base_abstract_ros.time_master_client import TimeMasterClient

HOLD_TIMEOUT_S = 60.0  # wall; no computation takes that long


def computing(participant):
    """Return a function that makes a context manager for the time during which the mission computes.

    ``participant`` is the value that lockstep.join has returned.
    """
    mode = rospy.get_param('/time_master/mode', None)
    if participant is not None or mode is None or not rospy.get_param('~hold', True):
        return contextlib.nullcontext
    client = TimeMasterClient()
    return lambda: client.hold(rospy.get_name(), HOLD_TIMEOUT_S)
