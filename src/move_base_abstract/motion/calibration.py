"""A calibrated robot: its limits, phases, spread, tail and failures, from a file that ``calibrate`` has written."""
from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Callable, Dict, Mapping, NamedTuple, Optional, Tuple, Union

from ..common.bounded_yaml import load_yaml_file
from ..common.kinds import ascending_pairs, error, number, string
from ..common.parameter_table import Parameter, kept_per_file, place_of, read_mapping
from ..common.units import NS_PER_S
from ..engine.chance import Purpose
from ..engine.factors import Gamma, along
from .approach import MotionPhases
from .durations import FAILURES, FAILURES_ALLOWED
from .encounter_law import EncounterLaw, make_encounter_law
from .leg import MotionLimits, Tolerances
from .recorded_range import Recorded, read_intervals, read_recorded
from .stuck_law import StuckLaw, make_stuck_law

if TYPE_CHECKING:
    from .phased_route import PhasedRoute

FORMAT = 1
ENCOUNTERS, STUCK = 'encounters', 'stuck'  # optional sections of a calibration
_NAME = re.compile(r'[A-Za-z0-9_]+')
_NORMAL = NormalDist()
_LEAST_FACTOR = 0.5  # a leg takes at least this share of the duration by its phases
LEAST_MOST = 0.5  # s: the tail of a turn may be this long on any way, however short


def _number(name: str, low: float, high: float, unit: str = '') -> Parameter:
    return Parameter(name, None, number(low, high, unit=unit))


TABLE = (
    Parameter('source', None, string('a text')),
    _number('max_speed', 0.001, 100.0, 'm/s'),
    _number('acceleration', 0.001, 1000.0, 'm/s^2'),
    _number('xy_goal_tolerance', 0.0, 10.0, 'm'),
    _number('yaw_goal_tolerance', 0.0, math.pi, 'rad'),
    _number('start_delay', 0.0, 3600.0, 's'),
    _number('start_turn_linear', 0.0, 1000.0, 's/rad'),
    _number('start_turn_square', 0.0, 1000.0, 's/rad^2'),
    _number('braking_gain', 0.001, 1000.0, '1/s'),
    _number('braking_offset', 0.001, 100.0, 'm'),
    _number('turning_speed', 0.001, 1000.0, 'rad/s'),
    _number('turning_gain', 0.001, 1000.0, '1/s'),
    _number('turning_offset', 0.001, 100.0, 'rad'),
    _number('bow_length', 0.0, 1000.0, 'm'),
    _number('spread', 0.0, 3600.0, 's'),
    _number('delay_share', 0.0, 10.0, 's per s of motion'),
    _number('tail_rate', 0.0, 10.0, '1/s of motion'),
    Parameter('tail_chance_by_turn', None, ascending_pairs(number(0.0, 3.15), number(0.0, 1.0)),
              allowed='a list of [start turn in 0..3.15 rad, chance in 0..1], the turns ascending'),
    _number('tail_mean', 0.001, 86400.0, 's'),
    _number('tail_cv', 0.01, 10.0),
    Parameter('failure_by_length', None, lambda value: () if value == [] else FAILURES(value),
              allowed=FAILURES_ALLOWED),
)


class TailMotion(NamedTuple):
    """The speeds of a robot in the tail: it drives backwards at ``reverse_speed`` [m/s], or spins [rad/s]."""

    reverse_speed: float
    spin_speed: float


def read_tail_motion(value: Mapping[str, float]) -> TailMotion:
    """Return the :class:`TailMotion` in a section of a calibration; this is the converter of a Parameter.

    :raises ValueError: if ``value`` is not a mapping with exactly these speeds in their ranges.
    """
    if not isinstance(value, dict) or set(value) != set(TailMotion._fields):
        raise ValueError
    return TailMotion(*(number(high=100.0, above=0.001)(value[name]) for name in TailMotion._fields))


#: optional sections of a calibration
SECTIONS = (
    Parameter('tail_most', math.inf, number(0.001, 1000.0, unit='s per m')),
    Parameter('recorded', None, read_recorded,
              allowed='a mapping of length [m] and start_turn [rad], and perhaps clearance '
              '[m], to [low, high]'),
    Parameter('tail_motion', None, read_tail_motion,
              allowed='a mapping of reverse_speed [m/s] and spin_speed [rad/s], both '
              '> 0.001'),
    Parameter('intervals', None, read_intervals,
              allowed="a mapping of names to [low, high], or to 'held by the prior'"),
)


@dataclass(frozen=True)
class CalibratedDurations:
    """The part of a goal's duration that the phases do not explain.

    First the robot stands for ``delay`` [s]. Then there are two cases. Usually the duration of the motion differs by a
    normal ``spread`` [s] and by small delays, which are exponential with the mean ``delay_share`` times the duration of
    the motion. Otherwise the goal is in the tail: it takes longer by a time drawn from ``tail`` (Gamma) [s], for which
    the robot stands at the start, too, unless there is a ``tail_motion``. The chance of the tail is ``tail_rate`` [1/s]
    over the duration of the motion, and rises with the start turn by ``tail_chances`` ((rad, chance), ...).

    ``failures``: as in :class:`.durations.Durations`. ``recorded``: the ranges of the legs to which this was fitted,
    None: unknown. ``tail_motion``: what a robot in the tail does during the extra time, None: it stands. ``tail_most``
    [s per m]: the longest tail of a turn for each metre of the way; x seconds of ``tail`` become x m / (x + m), where m
    is that limit.
    """

    delay: float
    spread: float
    delay_share: float
    tail_rate: float
    tail_chances: Tuple[Tuple[float, float], ...]
    tail: Any
    failures: Tuple[Tuple[float, float], ...] = ()
    recorded: Optional[Recorded] = None
    tail_motion: Optional[TailMotion] = None
    tail_most: float = math.inf

    def draw(self, leg: PhasedRoute, uniform: Callable[..., float]) -> Tuple[float, float]:
        """Return (overhead [s], factor) of a goal whose first leg is ``leg`` (PhasedRoute).

        ``uniform(purpose, place)`` gives the draws in (0, 1).
        """
        motion = leg.duration_ns / NS_PER_S
        if uniform(Purpose.TAIL, 0) < self.tail_chance(motion, leg.start_turn):
            late = self.tail.draw(lambda place: uniform(Purpose.TAIL_SECONDS, place))
            if math.isfinite(self.tail_most) and self._is_for_turn(leg, uniform):
                late /= 1.0 + late / max(LEAST_MOST, self.tail_most * leg.distance)
            return self.delay + late, 1.0
        if not motion > 0.0:
            return self.delay, 1.0
        late = self.spread * _NORMAL.inv_cdf(uniform(Purpose.SPREAD, 0)) / motion
        late -= self.delay_share * math.log(uniform(Purpose.SMALL_DELAYS, 0))
        return self.delay, max(_LEAST_FACTOR, 1.0 + late)

    def shaped(self, leg: PhasedRoute, overhead: float, uniform: Callable[..., float]) -> PhasedRoute:
        """Return the leg that replaces ``leg`` of a goal for which :meth:`draw` returned ``overhead`` [s].

        The robot spends the overhead beyond the delay as ``tail_motion`` says. If it is in the tail because of its turn
        at the start, it drives backwards. Otherwise it turns to and fro at its goal. The new leg takes longer by that.
        """
        extra, motion = overhead - self.delay, self.tail_motion
        if motion is None or not extra > 0.0:
            return leg
        if self._is_for_turn(leg, uniform):
            return leg.going_backwards(extra, motion.reverse_speed)
        return leg.spinning(extra, motion.spin_speed)

    def _is_for_turn(self, leg: PhasedRoute, uniform: Callable[..., float]) -> bool:
        """Return whether a goal in the tail is there because of its turn at the start."""
        return uniform(Purpose.TAIL, 0) < along(self.tail_chances, abs(leg.start_turn))

    def tail_chance(self, motion: float, start_turn: float) -> float:
        """Return the chance of the tail for a motion that lasts ``motion`` [s] after a turn by ``start_turn`` [rad]."""
        return 1.0 - math.exp(-self.tail_rate * motion) * (1.0 - along(self.tail_chances, abs(start_turn)))


@dataclass(frozen=True)
class Calibration:
    """The limits, tolerances and phases of a robot, and how the durations of its goals differ from them.

    ``source``: a line of text that says where this comes from; ``encounters``: what it costs the robot to meet another
    robot; ``stuck``: how it gets stuck. None: the calibration does not say.
    """

    source: str
    limits: MotionLimits
    tolerances: Tolerances
    phases: MotionPhases
    durations: CalibratedDurations
    encounters: Optional[EncounterLaw] = None
    stuck: Optional[StuckLaw] = None


def calibration_file(name: str, where: str) -> str:
    """Return the path of the calibration ``name``: an absolute path, or the name of a calibration of this package.

    :raises ConfigurationError: if it is neither; ``where`` is the namespace of the parameter, for the message.
    """
    path = name if os.path.isabs(name) else _shipped().get(name)
    if path is None:
        raise error(place_of(where, 'calibration'), name,
                    'an absolute path; in a scenario file a path from its folder that ends with .yaml; or one of the '
                    'calibrations of this package: ' + (', '.join(sorted(_shipped())) or 'none'))
    return str(path)


def read_calibration(name: str, where: str) -> Calibration:
    """Return the :class:`Calibration` ``name``, which is found as by :func:`calibration_file`.

    :raises ConfigurationError: if there is none, or it cannot be used; ``where`` is the namespace of the parameter.
    """
    return _calibration_in(calibration_file(name, where), where)


@kept_per_file('calibration')
def _calibration_in(path: str) -> Calibration:
    return make_calibration(load_yaml_file(path), path)


def make_calibration(raw: Mapping[str, Union[float, str]], where: str) -> Calibration:
    """Return the :class:`Calibration` in the dictionary ``raw``.

    :raises ConfigurationError: if ``raw`` is no calibration, or a value is missing, unknown or not allowed; the text
        begins with ``where``.
    """
    if not isinstance(raw, dict) or raw.get('format') != FORMAT:
        raise error(where, raw, f'a calibration with format: {FORMAT}')
    values = read_mapping({key: value for key, value in raw.items() if key not in ('format', ENCOUNTERS, STUCK)},
                          TABLE + SECTIONS, where, [parameter.name for parameter in TABLE])
    recorded = values['recorded'] and values['recorded']._replace(tolerance=values['xy_goal_tolerance'])
    return Calibration(
        values['source'], MotionLimits(values['max_speed'], values['acceleration']),
        Tolerances(values['xy_goal_tolerance'], values['yaw_goal_tolerance']),
        MotionPhases((values['start_turn_linear'], values['start_turn_square']), values['braking_gain'],
                     values['braking_offset'], values['turning_speed'], values['turning_gain'],
                     values['turning_offset'], values['bow_length']),
        CalibratedDurations(values['start_delay'], values['spread'], values['delay_share'], values['tail_rate'],
                            values['tail_chance_by_turn'], Gamma(values['tail_mean'], values['tail_cv']),
                            values['failure_by_length'], recorded, values['tail_motion'], values['tail_most']),
        make_encounter_law(raw[ENCOUNTERS], where) if ENCOUNTERS in raw else None,
        make_stuck_law(raw[STUCK], where) if STUCK in raw else None)


@lru_cache(maxsize=1)
def _shipped() -> Dict[str, str]:
    """Return {name: path} of the calibrations of this package: beside the sources, or where they are installed."""
    here = Path(__file__).resolve()
    for parent in here.parents:
        for share in (parent, parent / 'share' / 'move_base_abstract'):
            folder = share / 'config' / 'calibrated'
            if folder.is_dir():
                return {path.stem: str(path) for path in sorted(folder.glob('*.yaml')) if _NAME.fullmatch(path.stem)}
    return {}
