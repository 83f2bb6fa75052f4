"""Where robots are shown and placed: one object per simulator, chosen by name.

A backend is made with (names, settings) and has ``place(pose, velocity, stamp_ns)``: the robot is there now,
``rests(pose, stamp_ns)``: it still stands there (``is_odometry_heard()``: who hears that), ``heartbeat(pose,
stamp_ns)``: keep look-ups of the present working, ``looks(pose, stamp_ns)``: its laser looks around there,
``shift``: if set, where odometry seems to begin (see telling), of those that tell by tf where the robot is;
``restart()``: stamps begin anew, ``close()``: the robot is gone, and ``frames``: those whose place it tells in tf.
Poses are Pose2D in the global frame, velocities (forward [m/s], turning [rad/s]) in base_link, stamps simulated ns.
"""
from move_base_abstract.common.errors import ConfigurationError

from .builtin import BuiltinBackend
from .gazebo import GazeboBackend
from .stage import StageBackend


def _gazebo(names, settings):
    return GazeboBackend(names, settings, BuiltinBackend)


BUILTIN = ('builtin', 'virtual_robots')
STAGE = ('stage_ros', 'stage')
BACKENDS = {
    **dict.fromkeys(BUILTIN, BuiltinBackend),
    **dict.fromkeys(STAGE, StageBackend),
    'gazebo': _gazebo,
}


def make(name, names, settings, timing):
    """Return the backend ``name`` for one robot.

    :raises ConfigurationError: if there is none of that name, or ``timing`` (see timing.py) does not go with it.
    """
    if name not in BACKENDS:
        raise ConfigurationError("parameter {}/backend: got '{}'; allowed: {}".format(
            names.private, name, ', '.join(sorted(BACKENDS))))
    timing.check_backend(name, names.private)
    return BACKENDS[name](names, settings)
