"""Fit the phases, spread and tail that make the recorded durations most likely. Positions have no influence.

The likelihood of all legs is maximised (scipy's L-BFGS-B) over the logarithms of the parameters. Each has a weak prior
around a usual value, so that a parameter about which a recording says nothing stays there.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, List, Optional

import numpy as np
from scipy import optimize, special

from move_base_abstract.common.errors import ConfigurationError

from .law import Durations

if TYPE_CHECKING:
    from .law import Values
    from .legs import Pair, Pairs

LEAST_LEGS = 25
_LEAST_TAILS = 5  # of legs that drive backwards, and of legs that spin, after a tail
_LATE = 3.0  # s; less may be chance
_LONG = 10.0  # m; on a shorter way, a robot may drive backwards all the way
_ROUNDS = 150
_NEAR_ENOUGH = 1e-6  # a search from nearby stops when a round lowers the cost by a smaller share
_STRANGE = 1e-3  # the share of legs that nothing explains, in a Cauchy distribution
_STRANGE_SECONDS = 5.0
_PHASES = 11  # the first so many of the fitted values are those of the phases
_TURNS = np.linspace(0.0, math.pi, 17)  # rad; the turns in the table of chances
#: (name, usual value, spread of its logarithm); the usual speed is that of the fastest legs
_FITTED = (('max_speed', None, 0.7), ('acceleration', 0.5, 0.7), ('braking_gain', 0.5, 0.7),
           ('braking_offset', 0.1, 0.7), ('turning_speed', 1.0, 0.7), ('turning_gain', 1.0, 0.7),
           ('turning_offset', 0.2, 0.7), ('start_turn_linear', 0.5, 1.5), ('start_turn_square', 0.1, 1.5),
           ('bow_length', 1.0, 1.0), ('start_delay', 0.5, 2.0), ('spread', 0.3, 1.0), ('delay_share', 0.025, 1.0),
           ('tail_rate', 0.0025, 1.5), ('tail_mean', 10.0, 1.0), ('tail_cv', 0.8, 0.5),
           ('tail_most', 5.0, 0.5))
#: the chance of a tail by the start turn: the logistic function of a + b (turn - 3 pi / 4); (usual value, its spread)
_LOGISTIC = ((-1.0, 2.0), (2.0, 4.0))
_NAMES = [name for name, *_ in _FITTED]
#: the names of the fitted values, in the order of the packed values
PACKED_NAMES = (*_NAMES, 'tail_chance_level', 'tail_chance_slope')


def fit(pairs: Pairs) -> Dict[str, Any]:
    """Fit a calibration to ``pairs`` [(RecordedLeg, Way)]; return {parameter: value}.

    :raises ConfigurationError: if too few legs count and have succeeded.
    """
    problem = Problem(pairs)
    return problem.values(problem.solve())


class Problem:
    """The minimisation for ``pairs`` [(RecordedLeg, Way)] over packed values (PACKED_NAMES), most of them logarithms.

    :raises ConfigurationError: if too few legs count and have succeeded.
    """

    def __init__(self, pairs: Pairs) -> None:
        used = succeeded(pairs)
        if len(used) < LEAST_LEGS:
            raise ConfigurationError('got {} legs that succeeded and count; allowed: at least {}'.format(
                len(used), LEAST_LEGS))
        self._ways = np.array([way for _, way in used], float)
        self._durations = np.array([leg.duration for leg, _ in used])
        self._fixed: Dict[str, Any] = {**_tolerances(used), 'failure_by_length': _failures(pairs)}
        usual = np.array([float(np.quantile(self._ways[:, 0] / self._durations, 0.95)) if value is None else value
                          for _, value, _ in _FITTED])
        self.first = np.append(np.log(np.maximum(usual, 1e-3)), [value for value, _ in _LOGISTIC])
        #: the spread of each value's prior
        self.widths = np.array([width for *_, width in (*_FITTED, *_LOGISTIC)])
        self.highest = self.first + 4.0 * self.widths
        self.highest[_NAMES.index('tail_cv')] = 0.0  # above 1 the density is unbounded and attracts all legs

    def solve(self, begin: Optional[np.ndarray] = None) -> np.ndarray:
        """Return the packed values with the least cost.

        ``begin``: packed values near the result, from which a shorter and less exact search starts; None: from scratch.
        """
        def cost(packed: np.ndarray) -> float:
            return 0.5 * np.sum(((packed - self.first) / self.widths) ** 2) + np.sum(self.surprises(packed))
        lowest = self.first - 4.0 * self.widths
        options: Dict[str, float] = {'maxiter': _ROUNDS, 'maxfun': 100 * _ROUNDS}
        if begin is None:
            begin = self._begin()
        else:
            begin, options['ftol'] = np.clip(begin, lowest, self.highest), _NEAR_ENOUGH
        return optimize.minimize(cost, begin, method='L-BFGS-B', bounds=list(zip(lowest, self.highest)),
                                 options=options).x

    def surprises(self, packed: np.ndarray) -> np.ndarray:
        """Return minus the logarithm of the likelihood of each duration, without the prior."""
        law = Durations(self.values(packed), self._ways)
        excess = (self._durations - law.least) / _STRANGE_SECONDS
        strange = 1.0 / (math.pi * _STRANGE_SECONDS * (1.0 + excess ** 2))
        return -np.log((1.0 - _STRANGE) * law.density(self._durations) + _STRANGE * strange)

    def values(self, packed: np.ndarray) -> Dict[str, Any]:
        """Return {parameter of a calibration: value} of packed values."""
        level, slope = packed[len(_NAMES):]
        chances = special.expit(level + slope * (_TURNS - 0.75 * math.pi))
        return {**self._fixed, **{name: float(value) for name, value in zip(_NAMES, np.exp(packed))},
                'tail_chance_by_turn': [[float(turn), float(chance)] for turn, chance in zip(_TURNS, chances)]}

    def _begin(self) -> np.ndarray:
        """Return where the search begins: with the phases that fit best if large misses count little."""
        first, widths = self.first[:_PHASES], self.widths[:_PHASES]

        def misses(phases: np.ndarray) -> np.ndarray:
            law = Durations(self.values(np.append(phases, self.first[_PHASES:])), self._ways)
            return np.append(law.least - self._durations, (phases - first) / widths)
        found = optimize.least_squares(misses, first, loss='soft_l1', f_scale=0.5, max_nfev=60,
                                       bounds=(first - 4.0 * widths, first + 4.0 * widths))
        return np.append(found.x, self.first[_PHASES:])


def succeeded(pairs: Pairs) -> List[Pair]:
    """Return the ``pairs`` whose duration counts: those that succeeded and count."""
    return [(leg, way) for leg, way in pairs if leg.counts and leg.succeeded]


def ended(pairs: Pairs) -> List[Pair]:
    """Return the ``pairs`` that count for the rate of success: those that count and succeeded or failed."""
    return [(leg, way) for leg, way in pairs if leg.counts and (leg.succeeded or leg.failed)]


def _tolerances(used: Pairs) -> Dict[str, float]:
    """Return the tolerances of goals: the medians of the errors at the end; of yaw only after a last turn."""
    ends: Any = [(leg, way) for leg, way in used if leg.end is not None]
    xy = [leg.end.distance_to(leg.goal) for leg, _ in ends]
    yaw = [abs(math.remainder(leg.end.yaw - leg.goal.yaw, 2.0 * math.pi)) for leg, way in ends
           if abs(way.end_turn) > 0.5]
    return {name: float(np.median(errors)) if errors else 0.0 for name, errors in (
        ('xy_goal_tolerance', xy), ('yaw_goal_tolerance', yaw))}


def _failures(pairs: Pairs) -> List[List[float]]:
    """Return the chance of failure by length, [[m, chance]], if failures come at random along the ways."""
    all_ended = ended(pairs)
    rate = sum(leg.failed for leg, _ in all_ended) / max(1e-9, math.fsum(way.length for _, way in all_ended))
    return [[length, -math.expm1(-rate * length)] for length in (0.0, 25.0, 50.0, 100.0, 200.0)] if rate else []


def tail_motion(values: Values, pairs: Pairs) -> Optional[Dict[str, float]]:
    """Return {'reverse_speed': m/s, 'spin_speed': rad/s} of ``pairs`` [(leg, way)], or None if they do not say it.

    ``values``: those of the fitted calibration. A robot that drives backwards for a time t is late by t (1 - reverse
    speed / top speed); the median over legs counts. A robot that spins has turned by so much more than its way asks
    for; the sums over legs count.
    """
    used = succeeded(pairs)
    late = np.array([leg.duration for leg, _ in used]) - Durations(values, [way for _, way in used]).least
    back = [(extra, leg.reverse) for extra, (leg, way) in zip(late, used)
            if leg.reverse is not None and leg.reverse > _LATE and extra > 0.0 and way.length > _LONG]
    spun = [(extra, leg.turned) for extra, (leg, _) in zip(late, used)
            if leg.turned is not None and leg.reverse is not None and leg.reverse < 1.0 and extra > _LATE]
    if min(len(back), len(spun)) < _LEAST_TAILS:
        return None
    share = float(np.median([extra / reverse for extra, reverse in back]))
    extra, turned = np.sum(spun, axis=0)
    found = {'reverse_speed': values['max_speed'] * (1.0 - share), 'spin_speed': float(turned / extra)}
    return found if min(found.values()) > 0.01 else None
