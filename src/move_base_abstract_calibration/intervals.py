"""Intervals of the parameters of a fit, by bootstrap over recordings or legs; parameters that the prior holds."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, List, Sequence, Tuple, Union

import numpy as np
from scipy import stats

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.recorded_range import HELD

from .fit import PACKED_NAMES, Problem, ended, succeeded

if TYPE_CHECKING:
    from .law import Values
    from .legs import Pair, Pairs

SAMPLES = 100
_SEED = 20130213
_LEVELS = (0.05, 0.95)
_NORMAL = float(stats.norm.ppf(_LEVELS[1]))
_LEAST_CLUSTERS = 10  # fewer clusters say nothing about their differences
_MOST_OF_PRIOR = 0.5 ** 0.5  # above this share of the prior's spread, a value is known mostly from the prior
_STEP = 0.01  # the step of the packed values for derivatives
_ANGLES = (90, 135, 180)  # degrees; the report shows the chance of the tail at these turns
_TOLERANCES = ('xy_goal_tolerance', 'yaw_goal_tolerance')

#: (low, high) of 90 %, or HELD
Interval = Union[Tuple[float, float], str]


def clusters(pairs: Pairs) -> Tuple[List[List[Pair]], str]:
    """Return ([pairs that were recorded together], the kind of these groups in words)."""
    for words, key in (('recordings', lambda leg: leg.recording),
                       ('robots of recordings', lambda leg: (leg.recording, leg.robot))):
        groups: Dict[Any, List[Pair]] = {}
        for pair in pairs:
            groups.setdefault(key(pair[0]), []).append(pair)
        if len(groups) >= _LEAST_CLUSTERS:
            return list(groups.values()), words
    return [[pair] for pair in pairs], 'legs'


def spreads(problem: Problem, packed: np.ndarray) -> np.ndarray:
    """Return the spread of each packed value, from the information of the legs (Fisher's) and of the prior.

    The information of the legs is computed from the products of their scores, because the likelihood has kinks and its
    second derivatives say little. Correlations of values count, too: in a direction that changes no duration, only the
    prior decides.
    """
    steps = _STEP * np.eye(len(packed))
    scores = np.array([problem.surprises(packed + step) - problem.surprises(packed - step) for step in steps])
    scores /= 2.0 * _STEP
    return np.sqrt(np.diag(np.linalg.inv(scores @ scores.T + np.diag(problem.widths ** -2.0))))


def held_by_prior(problem: Problem, packed: np.ndarray, spread: np.ndarray) -> List[str]:
    """Return those PACKED_NAMES about which the prior says more than the legs do.

    For these, the spread is still more than 0.7 of the prior's, and the value has moved by less than the prior's
    spread.
    """
    moved = np.abs(packed - problem.first) / problem.widths
    return [name for name, share, way in zip(PACKED_NAMES, spread / problem.widths, moved)
            if share > _MOST_OF_PRIOR and way < 1.0]


def intervals(pairs: Pairs, samples: int = SAMPLES) -> Tuple[Dict[str, Interval], str]:
    """Return ({name: (low, high) of 90 %, or HELD}, how they were found, in words) for ``pairs``.

    Each interval is the wider one of two: by bootstrap, and by information. (A bootstrap sample stays at the prior if
    legs say little.) Names are those of parameters, except ``tail_chance_at_135_degrees``, others like it, and
    ``failures_per_km``.
    """
    problem = Problem(pairs)
    packed = problem.solve()
    spread = spreads(problem, packed)
    held = held_by_prior(problem, packed, spread)
    groups, words = clusters(pairs)
    found = _samples(groups, samples, packed)
    ends = [_told(problem.values(np.minimum(packed + way * _NORMAL * spread, problem.highest))) for way in (-1.0, 1.0)]
    result: Dict[str, Interval] = {}
    for name in ends[0]:
        values = [one[name] for one in found]
        both = [*(np.quantile(values, _LEVELS) if values else ()),
                *(() if name.startswith('tail_chance_at') else (one[name] for one in ends))]
        result.update({name: (float(min(both)), float(max(both)))} if both else {})
    result.update({name: HELD for name in held if name in result})
    if {'tail_chance_level', 'tail_chance_slope'} & set(held):
        result.update({name: HELD for name in result if name.startswith('tail_chance_at')})
    result['failures_per_km'] = _failures_per_km(pairs)
    return result, '90 %, the wider of {} samples of {} {}, drawn with replacement, and of ' \
                   "Fisher's information".format(len(found), len(groups), words)


def _samples(groups: Sequence[List[Pair]], count: int, packed: np.ndarray) -> List[Dict[str, float]]:
    """Return the values of the fits to ``count`` samples of ``groups``; each search starts from ``packed``."""
    generator = np.random.default_rng(_SEED)
    found = []
    for _ in range(count):
        chosen = generator.integers(len(groups), size=len(groups))
        try:
            sample = Problem([pair for number in chosen for pair in groups[number]])
        except ConfigurationError:  # too few legs that succeeded
            continue
        found.append(_told(sample.values(sample.solve(packed))))
    return found


def recorded_range(pairs: Pairs) -> Dict[str, Tuple[float, float]]:
    """Return {'length', 'start_turn', and 'clearance' if it is known: (lowest, highest)} for the fitted legs."""
    used = succeeded(pairs)
    parts = {'length': [way.length for _, way in used], 'start_turn': [abs(way.start_turn) for _, way in used],
             'clearance': [leg.clearance for leg, _ in used if leg.clearance is not None]}
    if 2 * len(parts['clearance']) < len(used):  # too many legs have no clearance
        del parts['clearance']
    return {name: (min(values), max(values)) for name, values in parts.items()}


def _told(values: Values) -> Dict[str, float]:
    """Return {name: number} for the values that the report shows with an interval."""
    turns, chances = np.transpose(values['tail_chance_by_turn'])
    return {**{name: values[name] for name in (*PACKED_NAMES[:-2], *_TOLERANCES)},
            **{'tail_chance_at_{}_degrees'.format(angle): float(np.interp(math.radians(angle), turns, chances))
               for angle in _ANGLES}}


def _failures_per_km(pairs: Pairs) -> Tuple[float, float]:
    """Return the exact 90 % interval (Garwood) of the rate of failures [1/km], as a Poisson process."""
    all_ended = ended(pairs)
    count = sum(leg.failed for leg, _ in all_ended)
    kilometres = max(1e-9, math.fsum(way.length for _, way in all_ended) / 1000.0)
    low = stats.chi2.ppf(_LEVELS[0], 2 * count) / 2.0 if count else 0.0
    return float(low / kilometres), float(stats.chi2.ppf(_LEVELS[1], 2 * count + 2) / 2.0 / kilometres)

