"""The parameters of a robot that is driven by velocities, with the names of stage_ros and diff_drive_controller."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Mapping, NamedTuple, Optional, Tuple

from ..common.kinds import ANY, FLAG, check_keys, error, number, numbers, one_of
from ..common.parameter_table import Parameter, place_of, read_mapping
from ..common.units import seconds_to_ns

GOALS, VELOCITIES = 'goals', 'velocities'
_BY_VELOCITIES = ('driven_by', VELOCITIES)
_TIMEOUT_S = 0.5  # as diff_drive_controller's cmd_vel_timeout
_SECONDS = number(0.0, 1e6, unit='s, simulated', note='0 = never')
_AXES = {'linear': ('x', 'y'), 'angular': ('z',)}

TABLE = (
    Parameter('driven_by', GOALS, one_of(GOALS, VELOCITIES),
              'Whether the robot travels to goals, or is driven by velocities.'),
    Parameter('holonomic', False, FLAG, 'Whether the robot can drive sideways, too.', needs=_BY_VELOCITIES),
    Parameter('cmd_vel_timeout', None, _SECONDS,
              'Time after a command at which the watchdog stops the robot, 0.5 s if neither this nor '
              '`base_watchdog_timeout` is set; the name of diff_drive_controller.', needs=_BY_VELOCITIES),
    Parameter('base_watchdog_timeout', None, _SECONDS,
              'The same under the name of stage_ros, whose default is 0.2 s; both set is an error.',
              needs=_BY_VELOCITIES),
    Parameter('control_period', 0.02, number(0.001, 10.0, unit='s, simulated'),
              'Time between two changes of the velocity while an acceleration is limited.', needs=_BY_VELOCITIES),
    Parameter('linear', None, ANY, 'Limits of the speed, `x` ahead and `y` sideways, as in diff_drive_controller.',
              'a mapping of x, y to limits', needs=_BY_VELOCITIES),
    Parameter('angular', None, ANY, 'Limits of the turn rate `z`, as in diff_drive_controller.',
              'a mapping of z to limits', needs=_BY_VELOCITIES),
    Parameter('odom_error', None, numbers(4, 'a list [x, y, z, a] of shares in 0..1', number(0.0, 1.0)),
              'Ranges of the constant shares by which the odometry is wrong ahead, sideways and in turning; z counts '
              'for nothing. Each share is drawn by the seed between minus and plus half of its range, as Stage says of '
              'its `odom_error`.', needs=_BY_VELOCITIES),
)
_MOST, _LEAST = number(0.0, 1e6), number(-1e6, 0.0)
_AXIS = (
    Parameter('has_velocity_limits', False, FLAG), Parameter('max_velocity', None, _MOST),
    Parameter('min_velocity', None, _LEAST),
    Parameter('has_acceleration_limits', False, FLAG), Parameter('max_acceleration', None, number(high=1e9, above=0.0)),
    Parameter('min_acceleration', None, number(-1e9, -1e-9)),
    Parameter('has_jerk_limits', False, FLAG), Parameter('max_jerk', None, ANY), Parameter('min_jerk', None, ANY),
)


class Limits(NamedTuple):
    """Limits of one component of a twist: ``low`` <= 0 <= ``high``, and by how much it may change in a second."""

    low: float = -math.inf
    high: float = math.inf
    least_change: float = -math.inf
    most_change: float = math.inf


@dataclass(frozen=True)
class DriveSettings:
    """How a robot is driven: ``timeout_ns`` [ns] after a command the watchdog stops it, 0: never.

    ``limits``: the Limits of the speeds ahead and sideways [m/s] and of the turn rate [rad/s]. ``period_ns`` [ns]: the
    time between two changes of the twist while a change is limited. ``odom_error``: see :func:`.drawn_shares`.
    """

    holonomic: bool = False
    timeout_ns: int = seconds_to_ns(_TIMEOUT_S)
    period_ns: int = 20_000_000
    limits: Tuple[Limits, Limits, Limits] = (Limits(), Limits(), Limits())
    odom_error: Tuple[float, float, float] = (0.0, 0.0, 0.0)


def read_drive(values: Mapping[str, Any], where: str) -> Optional[DriveSettings]:
    """Return the :class:`DriveSettings` in ``values`` (of :data:`TABLE`), None for a robot that travels to goals.

    :raises ConfigurationError: if a limit is not allowed.
    """
    if values['driven_by'] == GOALS:
        return None
    timeout = _TIMEOUT_S if values['cmd_vel_timeout'] is None else values['cmd_vel_timeout']
    ahead, aside, _, turned = values['odom_error'] or (0.0,) * 4
    forward, lateral, turning = (_limits(values, group, axis, where) for group, axes in _AXES.items() for axis in axes)
    return DriveSettings(values['holonomic'], seconds_to_ns(timeout), seconds_to_ns(values['control_period']),
                         (forward, lateral, turning), (ahead, aside, turned))


def _limits(values: Mapping[str, Any], group: str, axis: str, where: str) -> Limits:
    axes = {} if values[group] is None else values[group]
    place = f'{where}/{group}'
    if not isinstance(axes, dict):
        raise error(place_of(where, group), axes, 'a mapping with ' + ', '.join(_AXES[group]))
    check_keys(axes, _AXES[group], place_of(where, group), '')
    place = f'{place}/{axis}'
    raw = read_mapping(axes.get(axis, {}), _AXIS, place)
    if raw['has_jerk_limits']:
        raise error(place_of(place, 'has_jerk_limits'), True, 'false: the jerk is not limited here')
    found = []
    for what in ('velocity', 'acceleration'):
        least, most, has_limits = (raw[name.format(what)] for name in ('min_{}', 'max_{}', 'has_{}_limits'))
        if not has_limits:
            least, most = -math.inf, math.inf
        elif most is None:
            raise error(place_of(place, f'max_{what}'), None, 'a number', f' with has_{what}_limits: true')
        found += [-most if least is None else least, most]
    return Limits(*found)
