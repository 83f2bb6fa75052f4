"""Places where robots work: their poses, their capacities, and the time and energy of work there.

    places:
      - {name: dock, x: 12.0, y: 3.0, yaw: 1.57, capacity: 2, duration: 40.0, power: 120.0}

Key by key: docs/tasks.md.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional

from ..common.errors import ConfigurationError
from ..common.kinds import COORDINATE, FLAG, INT32, error, integer, number, one_of
from ..common.parameter_table import Parameter, read_mapping
from ..common.ros_names import ROBOT_NAME_RULE, robot_name
from ..engine.factors import Constant, Gamma, Lognormal
from ..motion.geometry import Pose2D

MIN_SECONDS, MAX_SECONDS = 1e-9, 2.0 ** 31 - 1.0  # the limits of a ROS duration that is not 0
MAX_PLACES = 100_000
_FACTORS = {'lognormal': Lognormal, 'gamma': Gamma}


NAME = Parameter('name', None, robot_name, allowed=ROBOT_NAME_RULE)
#: the priority of a task or an order; where there is no room, a higher one comes first
PRIORITY = Parameter('priority', 0, INT32, allowed='a whole number of 32 bits')
#: the time and energy of work, as keys of a place and of arrivals
WORK_TABLE = (
    Parameter('duration', None, number(MIN_SECONDS, MAX_SECONDS, unit='s, simulated')),
    Parameter('duration_distribution', 'constant', one_of('constant', *_FACTORS)),
    Parameter('duration_cv', 0.0, number(0.0, 10.0)),
    Parameter('power', 0.0, number(low=0.0, unit='W')),
    Parameter('energy', 0.0, number(low=0.0, unit='J')),
)
POSE_TABLE = (
    Parameter('x', 0.0, COORDINATE),
    Parameter('y', 0.0, COORDINATE),
    Parameter('yaw', 0.0, number(unit='rad, global frame')),
)
PLACE_TABLE = (
    NAME,
    *POSE_TABLE,
    Parameter('capacity', None, integer(1)),
    Parameter('queue', None, integer(0)),
    Parameter('preemption', False, FLAG),
    Parameter('parking', False, FLAG),
    Parameter('reach', 0.5, number(above=0.0, unit='m')),
    *WORK_TABLE,
)


@dataclass(frozen=True)
class Work:
    """The time and energy of work.

    ``seconds``: the distribution of its duration [s], one of :mod:`.factors`, None: not given; ``power`` [W];
    ``energy`` [J]: in total, in addition to the power.
    """

    seconds: Any = None
    power: float = 0.0
    energy: float = 0.0


@dataclass(frozen=True)
class Place:
    """A place where robots work.

    ``pose`` (Pose2D, global frame); ``capacity``: the number of robots that may work there at once (None: any number);
    ``reach`` [m]: a robot that is no farther away is at the place; ``queue``: the number of robots that may wait (None:
    any number); ``preemption``: whether a task with a higher priority interrupts another one; ``parking``: whether
    robots that have nothing to do park there (at most ``capacity``).
    """

    name: str
    pose: Pose2D
    capacity: Optional[int] = None
    reach: float = 0.5
    work: Work = Work()
    queue: Optional[int] = None
    preemption: bool = False
    parking: bool = False

    def holds(self, pose: Pose2D) -> bool:
        """Return whether a robot at ``pose`` (Pose2D) is at this place."""
        return math.hypot(pose.x - self.pose.x, pose.y - self.pose.y) <= self.reach


def read_places(raw: Mapping[str, Any], where: str) -> Dict[str, Place]:
    """Return {name: :class:`Place`} of the list ``raw``.

    :raises ConfigurationError: if an entry is not allowed; the text names ``where``, the entry and what is allowed.
    """
    if not isinstance(raw, list) or len(raw) > MAX_PLACES:
        raise error(f'{where}: places', raw, f'a list of at most {MAX_PLACES} places')
    places = {}
    for index, entry in enumerate(raw):
        here = '{}: places[{}]'.format(where, index)
        values = read_mapping(entry, PLACE_TABLE, here, ('name',))
        name = values['name']
        if name in places:
            raise ConfigurationError("{}: name: '{}' is given to more than one place".format(here, name))
        if values['capacity'] is None and (values['queue'] is not None or values['preemption']):
            raise ConfigurationError('{}: capacity is not given, but {} is, which needs it'.format(
                here, 'preemption' if values['queue'] is None else 'queue'))
        places[name] = Place(name, Pose2D(values['x'], values['y'], values['yaw']), values['capacity'],
                             values['reach'], read_work(values, here), values['queue'], values['preemption'],
                             values['parking'])
    return places


def read_work(values: Mapping[str, Any], where: str, default: Work = Work()) -> Work:
    """Return the :class:`Work` in ``values`` (of :data:`WORK_TABLE`); what is not given there is as in ``default``.

    :raises ConfigurationError: if the distribution does not fit the duration and its coefficient of variation.
    """
    kind, mean, cv = values['duration_distribution'], values['duration'], values['duration_cv']
    if (kind in _FACTORS) != (cv > 0.0) or (kind in _FACTORS and not mean):
        raise error(f'{where}: duration_cv', cv,
                    f'> 0 with {" and ".join(_FACTORS)}, and then a duration > 0; otherwise 0',
                    f' with duration: {mean} and duration_distribution: {kind}')
    if mean is None:
        return Work(default.seconds, values['power'] or default.power, values['energy'] or default.energy)
    seconds = _FACTORS[kind](mean, cv) if kind in _FACTORS else Constant(mean)
    return Work(seconds, values['power'] or default.power, values['energy'] or default.energy)
