"""The way to the time master: what the parameters say of it."""
import time

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep import wire_format
from move_base_abstract.lockstep.secret import run_secret

from .connection import Connection


def connect():
    """Return a :class:`Connection` to the time master that the parameter names; wait for it as long as ROS is there.

    :raises ConfigurationError: if the time master is not in lockstep any more.
    """
    warn_at = time.monotonic() + wire_format.CONNECT_REMINDER_MS * 1e-3
    while not rospy.is_shutdown():
        if not is_lockstep():
            raise ConfigurationError("{}: parameter /time_master/mode: got {!r}; allowed, for a node that takes part: "
                                     "'lockstep'".format(rospy.get_name(), rospy.get_param('/time_master/mode', '')))
        address = str(rospy.get_param('/time_master/lockstep_address', ''))
        host, _, port = address.rpartition(':')
        if host and port.isdigit():
            try:
                return Connection(host, int(port), 1.0)
            except OSError:
                pass  # left there by one that died; another will come
        if time.monotonic() > warn_at:
            rospy.logwarn('lockstep: %s waits for the time master (/time_master/lockstep_address is %s)',
                          rospy.get_name(), address + ', where nobody listens' if address else 'not set')
            warn_at += wire_format.CONNECT_REMINDER_MS * 1e-3
        time.sleep(wire_format.CONNECT_RETRY_MS * 1e-3)
    raise rospy.ROSInterruptException('ROS shutdown request')


def secret():
    """Return the secret of the run (bytes), which the parameters tell."""
    return run_secret(rospy.get_param('/time_master/lockstep_secret', ''),
                      rospy.get_param('/time_master/lockstep_secret_file', ''))


def is_lockstep():
    """Return whether the time master works, or will work, in lockstep (parameter ``/time_master/mode``)."""
    return rospy.get_param('/time_master/mode', 'scaled') == 'lockstep'
