"""Where robots are shown and placed: one object per simulator, chosen by name.

A backend is made with (names, settings) and has ``place(pose, velocity, stamp_ns)``: the robot is there now, and
``heartbeat(pose, stamp_ns)``: keep look-ups of the present working, ``restart()``: stamps begin anew, ``close()``: the
robot is gone, and ``frames``: those whose place it tells in tf. Poses are Pose2D in the global frame, velocities
(forward [m/s], turning [rad/s]) in base_link, stamps simulated ns.
"""
from move_base_abstract.errors import ConfigurationError

from .builtin import BuiltinBackend
from .gazebo import GazeboBackend
from .stage import StageBackend


def _gazebo(names, settings):
    return GazeboBackend(names, settings, BuiltinBackend)


#: those that go by the time master's clock alone
EVENT_DRIVEN = ('builtin', 'virtual_robots')
STAGE = ('stage_ros', 'stage')
BACKENDS = {
    'builtin': BuiltinBackend,
    'virtual_robots': BuiltinBackend,
    **dict.fromkeys(STAGE, StageBackend),
    'gazebo': _gazebo,
}


def make(name, names, settings, is_lockstep=False):
    """Return the backend ``name`` for one robot.

    :raises ConfigurationError: if there is none of that name, or it has a clock of its own and time is event-driven.
    """
    if name not in BACKENDS:
        raise ConfigurationError("parameter {}/backend: got '{}'; allowed: {}".format(
            names.private, name, ', '.join(sorted(BACKENDS))))
    if is_lockstep and name not in EVENT_DRIVEN:
        raise ConfigurationError(
            "parameter {}/backend: got '{}', a simulator with a clock of its own; allowed in lockstep (parameter "
            '/time_master/mode): {}'.format(names.private, name, ', '.join(EVENT_DRIVEN)))
    return BACKENDS[name](names, settings)
