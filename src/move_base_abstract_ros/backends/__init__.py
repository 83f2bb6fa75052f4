"""Backends: the simulators that show robots and place them. Each robot has an object of its own, chosen by name.

A backend is made with (names, settings). It has

- ``place(pose, velocity, stamp_ns)``: publish that the robot is there now;
- ``rests(pose, stamp_ns)``: publish that it still stands there; ``is_odometry_heard()``: the kind of nodes that hear
  that, NOBODY (0), ONLOOKERS or PARTICIPANTS;
- ``heartbeat(pose, stamp_ns)``: publish tf, so that look-ups of the present work;
- ``looks(pose, stamp_ns)``: publish tf at the instant of a laser scan;
- ``follow(present)``: tell a new listener ``present()``, (pose, velocity, stamp_ns); if it is None, what was told last;
- ``shift``: where odometry seems to begin, or None; only of backends that publish the robot's pose in tf;
- ``restart()``: allow earlier stamps, because time starts anew; ``close()``: the robot is removed;
- ``frames``: the frames that it publishes in tf.

Poses are Pose2D in the global frame, velocities (forward [m/s], turning [rad/s]) in base_link, stamps simulated ns.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Dict, Union

from move_base_abstract.common.errors import ConfigurationError

from .builtin import BuiltinBackend
from .gazebo import GazeboBackend
from .stage import StageBackend

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings

    from ..clocks.timing import Timing
    from ..robot.names import RobotNames

Backend = Union[BuiltinBackend, StageBackend]

BUILTIN = ('builtin', 'virtual_robots')
STAGE = ('stage_ros', 'stage')
BACKENDS: Dict[str, Callable[[RobotNames, RobotSettings], Backend]] = {
    **dict.fromkeys(BUILTIN, BuiltinBackend),
    **dict.fromkeys(STAGE, StageBackend),
    'gazebo': GazeboBackend,
}


def make(name: str, names: RobotNames, settings: RobotSettings, timing: Timing) -> Backend:
    """Return the backend ``name`` for one robot.

    :raises ConfigurationError: if there is no backend of that name, or ``timing`` (see timing.py) does not allow it.
    """
    if name not in BACKENDS:
        raise ConfigurationError("parameter {}/backend: got '{}'; allowed: {}".format(
            names.private, name, ', '.join(sorted(BACKENDS))))
    timing.check_backend(name, names.private)
    return BACKENDS[name](names, settings)
