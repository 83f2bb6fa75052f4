"""One robot as a node: its settings from parameters, the clock, the start and the end."""
from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Callable, Dict, Mapping, Optional, Sequence, Tuple, Type

import rospy

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.config.settings import read_settings

from ..clocks.timing import make_timing
from ..maps.robot_map import wait_for_maps
from ..process.node_process import run_node
from ..process.own_parameters import INHERITED, LOCKSTEP_PARAMETERS, own_parameters
from ..transforms.tf_lookup import listen_to_static_frames
from .host import Host
from .move_base_server import MoveBaseServer
from .velocity_server import VelocityServer

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings

    from ..clocks.timing import Clock, Timing
    from .names import RobotNames
    from .robot_server import RobotServer

_LAST_WORDS_SECONDS = 0.1


def run(node_name: str, describe: Callable[[], Tuple[RobotNames, Mapping[str, Any], Optional[str]]]) -> None:
    """Run the node ``node_name`` with one robot until ROS shuts down.

    ``describe()`` is called once the node is initialised. It returns the arguments of :func:`_build`.
    """
    run_node(node_name, lambda: _build(*describe()), _say_goodbye)


def _build(names: RobotNames, overrides: Mapping[str, Any],
           default_tf_prefix: Optional[str]) -> Optional[RobotServer]:
    """Return the robot's server, or None if ROS shuts down first.

    ``overrides``: {name: value} of parameters that take precedence over those of the parameter server.
    """
    timing = make_timing()
    clock = timing.make_clock()
    settings = read_robot_settings(overrides, default_tf_prefix, timing.base_settings)
    if not start(clock, timing, [(names, settings)]):
        return None
    server = server_class(settings)(names, settings, Host(clock, timing))
    clock.serve()
    return server


def server_class(settings: RobotSettings) -> Type[RobotServer]:
    """Return the class of the server of a robot with these ``settings``."""
    return MoveBaseServer if settings.drive is None else VelocityServer


def start(clock: Clock, timing: Timing,
          robots: Sequence[Tuple[RobotNames, RobotSettings]]) -> bool:
    """Start ``clock`` for ``robots``, (RobotNames, RobotSettings) pairs. Return False if ROS shuts down meanwhile."""
    return clock.start() and timing.await_surroundings(
        clock, listen_to_static_frames, lambda participant: wait_for_maps(robots, participant))


def read_robot_settings(overrides: Mapping[str, Any], default_tf_prefix: Optional[str],
                        base: Mapping[str, Any]) -> RobotSettings:
    """Return the settings in the node's private namespace, and log where the important ones come from.

    ``overrides`` take precedence over the private parameters, and these over ``base``. All are {name: value}.
    :raises ConfigurationError: if a parameter cannot be used.
    """
    where = rospy.get_name()
    raw = own_parameters()
    if isinstance(raw, dict):
        own = {key: value for key, value in raw.items() if key not in LOCKSTEP_PARAMETERS}
        raw = {**_inherited(raw), **base, **own, **overrides}
    settings: Any = read_settings(raw, where)
    if settings.tf_prefix is None:
        inherited = rospy.search_param('tf_prefix')
        settings = replace(settings, tf_prefix=(
            str(rospy.get_param(inherited)).strip('/') if inherited else default_tf_prefix))
    _report(settings, where)
    return settings


def _inherited(raw: Mapping[str, Any]) -> Dict[str, str]:
    """Return {name: value} of the parameters that a namespace further up may hold: a footprint or radius, a profile."""
    found = {name: rospy.search_param(name) for name in INHERITED if name not in raw}
    return {name: rospy.get_param(path) for name, path in found.items() if path}


def _report(settings: RobotSettings, where: str) -> None:
    start = '({0.x:g}, {0.y:g}, {0.yaw:g}) in {1}'.format(settings.start, settings.values['global_frame'])
    limits, drive = settings.limits, settings.drive
    if drive is not None:
        rospy.loginfo('%s: abstract robot, driven by velocities on cmd_vel, %s; start %s', where,
                      'stopped {:g} s after the last one'.format(drive.timeout_ns / NS_PER_S) if drive.timeout_ns
                      else 'without a watchdog', start)
    else:
        rospy.loginfo('%s: abstract robot; speed %g m/s (%s), acceleration %s (%s), start %s, backend %s',
                      where, limits.max_speed, settings.speed_source,
                      'unlimited' if limits.acceleration == float('inf') else '{:g} m/s^2'.format(limits.acceleration),
                      settings.acceleration_source, start, settings.values['backend'])
    if settings.ignored:
        rospy.loginfo('%s: %d parameters of costmaps, planners and recovery have no meaning here and are ignored',
                      where, len(settings.ignored))
    for warning in settings.warnings:
        rospy.logwarn(warning)


def _say_goodbye(server: RobotServer) -> None:
    server.shut_down()
    time.sleep(_LAST_WORDS_SECONDS)  # rospy closes connections at once, even if messages are still queued on them
