"""Fitting: which phases, spread and tail make the recorded durations most likely. Places play no part.

The likelihood of all legs is maximised (scipy's L-BFGS-B) over the logarithms of the parameters, each with a weak
prior around a usual value, so that what a recording says nothing of stays there.
"""
import math

import numpy as np
from scipy import optimize, special

from move_base_abstract.common.errors import ConfigurationError

from .law import Durations

LEAST_LEGS = 25
_ROUNDS = 150
_STRANGE = 1e-3  # share of legs that nothing explains, spread as Cauchy's distribution
_STRANGE_SECONDS = 5.0
_PHASES = 11  # of the fitted values, the first ones
_TURNS = np.linspace(0.0, math.pi, 17)  # rad, of the table of chances
#: (name, usual value, spread of its logarithm); the usual speed is that of the fastest legs
_FITTED = (('max_speed', None, 0.7), ('acceleration', 0.5, 0.7), ('braking_gain', 0.5, 0.7),
           ('braking_offset', 0.1, 0.7), ('turning_speed', 1.0, 0.7), ('turning_gain', 1.0, 0.7),
           ('turning_offset', 0.2, 0.7), ('start_turn_linear', 0.5, 1.5), ('start_turn_square', 0.1, 1.5),
           ('bow_length', 1.0, 1.0), ('start_delay', 0.5, 2.0), ('spread', 0.3, 1.0), ('delay_share', 0.025, 1.0),
           ('tail_rate', 0.0025, 1.5), ('tail_mean', 10.0, 1.0), ('tail_cv', 0.8, 0.5))
#: the chance of a tail by the start turn: the logistic function of a + b (turn - 3 pi / 4); (usual value, its spread)
_LOGISTIC = ((-1.0, 2.0), (2.0, 4.0))
_NAMES = [name for name, *_ in _FITTED]


def fit(pairs):
    """Return {parameter of a calibration: value} for ``pairs`` [(RecordedLeg, Way)].

    :raises ConfigurationError: if there are too few legs that count and have succeeded.
    """
    used = succeeded(pairs)
    if len(used) < LEAST_LEGS:
        raise ConfigurationError('got {} legs that succeeded and count; allowed: at least {}'.format(
            len(used), LEAST_LEGS))
    ways = np.array([way for _, way in used], float)
    durations = np.array([leg.duration for leg, _ in used])
    fixed = _tolerances(used)
    usual = np.array([float(np.quantile(ways[:, 0] / durations, 0.95)) if value is None else value
                      for _, value, _ in _FITTED])
    first = np.append(np.log(np.maximum(usual, 1e-3)), [value for value, _ in _LOGISTIC])
    widths = np.array([width for *_, width in (*_FITTED, *_LOGISTIC)])
    highest = first + 4.0 * widths
    highest[_NAMES.index('tail_cv')] = 0.0  # above 1 the density has no bound, and draws all legs to it

    packed = _begin(first, widths, lambda packed: Durations(_values(packed, fixed), ways), durations)

    def cost(packed):
        law = Durations(_values(packed, fixed), ways)
        strange = 1.0 / (math.pi * _STRANGE_SECONDS * (1.0 + ((durations - law.least) / _STRANGE_SECONDS) ** 2))
        density = (1.0 - _STRANGE) * law.density(durations) + _STRANGE * strange
        return 0.5 * np.sum(((packed - first) / widths) ** 2) - np.sum(np.log(density))
    found = optimize.minimize(cost, packed, method='L-BFGS-B', options={'maxiter': _ROUNDS, 'maxfun': 100 * _ROUNDS},
                              bounds=list(zip(first - 4.0 * widths, highest)))
    return {**_values(found.x, fixed), 'failure_by_length': _failures(pairs)}


def _begin(first, widths, law_of, durations):
    """Return where the search begins: with the phases that fit best where the largest misses count little."""
    def misses(phases):
        packed = np.append(phases, first[_PHASES:])
        return np.append(law_of(packed).least - durations, (phases - first[:_PHASES]) / widths[:_PHASES])
    found = optimize.least_squares(misses, first[:_PHASES], loss='soft_l1', f_scale=0.5, max_nfev=60,
                                   bounds=(first[:_PHASES] - 4.0 * widths[:_PHASES],
                                           first[:_PHASES] + 4.0 * widths[:_PHASES]))
    return np.append(found.x, first[_PHASES:])


def succeeded(pairs):
    """Return those of ``pairs`` whose duration counts."""
    return [(leg, way) for leg, way in pairs if leg.counts and leg.succeeded]


def _values(packed, fixed):
    level, slope = packed[len(_NAMES):]
    chances = special.expit(level + slope * (_TURNS - 0.75 * math.pi))
    return {**fixed, **{name: float(value) for name, value in zip(_NAMES, np.exp(packed))},
            'tail_chance_by_turn': [[float(turn), float(chance)] for turn, chance in zip(_TURNS, chances)]}


def _tolerances(used):
    """Return the tolerances at whose edges legs end: the medians of the errors there, of yaw behind a last turn."""
    ends = [(leg, way) for leg, way in used if leg.end is not None]
    xy = [leg.end.distance_to(leg.goal) for leg, _ in ends]
    yaw = [abs(math.remainder(leg.end.yaw - leg.goal.yaw, 2.0 * math.pi)) for leg, way in ends
           if abs(way.end_turn) > 0.5]
    return {name: float(np.median(errors)) if errors else 0.0 for name, errors in (
        ('xy_goal_tolerance', xy), ('yaw_goal_tolerance', yaw))}


def _failures(pairs):
    """Return the chance of failure by length, [[m, chance]], as if failures came at random along the ways."""
    ended = [(leg, way) for leg, way in pairs if leg.counts and (leg.succeeded or leg.failed)]
    rate = sum(leg.failed for leg, _ in ended) / max(1e-9, math.fsum(way.length for _, way in ended))
    return [[length, -math.expm1(-rate * length)] for length in (0.0, 25.0, 50.0, 100.0, 200.0)] if rate else []
