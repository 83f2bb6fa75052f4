"""How a node finds the time master: its parameters say its mode, its address and the run's secret."""
from __future__ import annotations

import math
import time
from typing import Any, Dict

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep import wire_format
from move_base_abstract.lockstep.secret import run_secret

from .connection import Connection


def connect(patience_s: float = math.inf) -> Connection:
    """Return a :class:`Connection` to the time master, at the address in its parameter. Wait for it if necessary.

    :param patience_s: for how long at most [s, wall].
    :raises TimeoutError: if there is none in that time.
    :raises ConfigurationError: if the time master is not in lockstep any more.
    :raises rospy.ROSInterruptException: if the node shuts down meanwhile.
    """
    give_up_at = time.monotonic() + patience_s
    warn_at = time.monotonic() + wire_format.CONNECT_REMINDER_MS * 1e-3
    while not rospy.is_shutdown():
        told = _told()
        if told.get('mode') != 'lockstep':
            raise ConfigurationError("{}: parameter /time_master/mode: got {!r}; allowed, for a node that takes part: "
                                     "'lockstep'".format(rospy.get_name(), told.get('mode', '')))
        address = str(told.get('lockstep_address', ''))
        host, _, port = address.rpartition(':')
        if host and port.isdigit():
            try:
                return Connection(host, int(port), 1.0)
            except OSError:
                pass  # a time master that has died has left the address; another one will come
        if time.monotonic() > give_up_at:
            raise TimeoutError('there is no time master')
        if time.monotonic() > warn_at:
            rospy.logwarn('lockstep: %s waits for the time master (/time_master/lockstep_address is %s)',
                          rospy.get_name(), address + ', where nobody listens' if address else 'not set')
            warn_at += wire_format.CONNECT_REMINDER_MS * 1e-3
        time.sleep(wire_format.CONNECT_RETRY_MS * 1e-3)
    raise rospy.ROSInterruptException('ROS shutdown request')


def secret() -> bytes:
    """Return the secret of the run (bytes), from the time master's parameters."""
    told = _told()
    return run_secret(told.get('lockstep_secret', ''), told.get('lockstep_secret_file', ''))


def _told() -> Dict[str, Any]:
    """Return the parameters of the time master, by one call of the ROS master."""
    found = rospy.get_param('/time_master', {})
    return found if isinstance(found, dict) else {}


def is_awaited(name: str) -> bool:
    """Return whether the time master waits for the node ``name``, a full name, before time starts: it is named."""
    named = rospy.get_param('/time_master/participants', [])
    return isinstance(named, list) and name.strip('/') in [str(one).strip('/') for one in named]


def is_lockstep() -> bool:
    """Return whether the time master is, or will be, in lockstep (parameter ``/time_master/mode``)."""
    return rospy.get_param('/time_master/mode', 'scaled') == 'lockstep'
