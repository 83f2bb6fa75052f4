"""Fit how robots get stuck: the law of the section ``stuck``, with intervals, judged on missions that were not fitted.

The chance to get stuck is a logistic function of a distance: of the nearest distance of an encounter, or of the
clearance of a way. A weak prior says that the distance does not matter. Chances with fewer than LEAST_CASES cases are
not fitted: their interval is wider than a factor of four.
"""
from __future__ import annotations

import math
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy import optimize, special, stats

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.calibration import STUCK, calibration_file, read_calibration

from .encounter_fit import Row
from .encounter_report import RADIUS
from .stuck_cases import CLEARANCE, Cases, Trial, find_cases

LEAST_CASES = 10
_USUAL, _WIDTHS = np.array([-3.0, 0.0]), np.array([2.0, 2.0])  # of the prior: the logit at 0 m; its rise to the reach
_PRIOR_HOLDS = 0.8  # as in the fit of encounters
_PLACES = 7  # the number of rows in the tables of chances
_LEVELS = np.array([0.025, 0.975])


class Curve(NamedTuple):
    """A fitted chance: the logits at 0 m and their rise to ``reach`` [m], and the covariance of both."""

    packed: np.ndarray
    covariance: np.ndarray
    reach: float

    def chance(self, at: Any) -> Any:
        """Return the chance at the distances ``at`` [m]; those beyond the reach count as the reach."""
        return special.expit(self.packed[0] + self.packed[1] * np.minimum(1.0, np.asarray(at) / self.reach))

    def table(self) -> List[List[float]]:
        """Return pairs of a distance [m] and the chance there."""
        return [[float(at), float(self.chance(at))] for at in np.linspace(0.0, self.reach, _PLACES)]

    def rows(self, name: str) -> Iterator[Row]:
        """Yield the chances at 0 m and at the reach, as :class:`.Row` objects."""
        for end, share in (('_near', 0.0), ('_far', 1.0)):
            weights = np.array([1.0, share])
            middle, spread = weights @ self.packed, math.sqrt(weights @ self.covariance @ weights)
            value, low, high = (float(special.expit(middle + z * spread)) for z in (0.0, -1.96, 1.96))
            yield Row(name + end, value, low, high,
                      bool(share and math.sqrt(self.covariance[1, 1]) > _PRIOR_HOLDS * _WIDTHS[1]))


def fit_chance(trials: Sequence[Trial], reach: float) -> Optional[Curve]:
    """Return the :class:`Curve` for ``trials`` up to ``reach`` [m]; None: there are too few cases."""
    stuck = np.array([one.stuck for one in trials], bool)
    if stuck.sum() < LEAST_CASES:
        return None
    places = np.column_stack([np.ones(len(trials)), np.minimum(1.0, np.array([one.at for one in trials]) / reach)])

    def cost(packed: np.ndarray) -> float:
        logits = places @ packed
        return float(0.5 * np.sum(((packed - _USUAL) / _WIDTHS) ** 2) + np.logaddexp(0.0, logits).sum()
                     - logits[stuck].sum())
    packed = optimize.minimize(cost, _USUAL, method='BFGS').x
    chances = special.expit(places @ packed)
    information = (places * (chances * (1.0 - chances))[:, None]).T @ places + np.diag(_WIDTHS ** -2.0)
    return Curve(packed, np.linalg.inv(information), reach)


class Fitted(NamedTuple):
    """The result: ``values`` of the section, ``rows`` [Row], and ``notes``: texts about what was not fitted."""

    values: Dict[str, Any]
    rows: List[Row]
    notes: List[str]


def fit_stuck(cases: Cases, radius: float) -> Fitted:
    """Return the :class:`Fitted` for ``cases``; ``radius`` [m]: of an encounter.

    :raises ConfigurationError: if there are too few cases to fit anything.
    """
    values: Dict[str, Any] = {}
    rows: List[Row] = []
    notes: List[str] = []
    if cases.patience:
        values['patience'] = float(np.median(cases.patience))
    else:
        notes.append('patience: not fitted: no robot gave up a goal where it stood')
    for name, trials, reach, words in (('by_nearest', cases.meetings, radius, 'encounters'),
                                       ('by_clearance', cases.ways, CLEARANCE, 'legs, at walls')):
        curve = fit_chance(trials, reach)
        count = sum(one.stuck for one in trials)
        if curve is None:
            low, high = _proportion(count, len(trials))
            notes.append('{}: not fitted: robots got stuck in {} of {} {} (95 %: {:.2g} to {:.2g}); at least {} cases '
                         'are needed'.format(name, count, len(trials), words, low, high, LEAST_CASES))
        else:
            values[name] = curve.table()
            rows.extend(curve.rows(name))
    if not rows or not cases.patience:
        raise ConfigurationError('stuck: {}'.format('; '.join(notes)))
    if 'by_nearest' in values and cases.gave_up:
        kept = len(cases.gave_up) - sum(cases.gave_up)
        values['keep_chance'] = kept / len(cases.gave_up)
        rows.append(Row('keep_chance', values['keep_chance'], *_proportion(kept, len(cases.gave_up)), False))
    _fit_end(cases, values, rows, notes)
    return Fitted(values, rows, notes)


def _fit_end(cases: Cases, values: Dict[str, Any], rows: List[Row], notes: List[str]) -> None:
    """Add the mean time after which robots come free by themselves, as a Poisson process, if some did."""
    freed = sum(one.freed for one in cases.contacts)
    seconds = math.fsum(one.end - one.begin for one in cases.contacts)
    if freed:
        low, high = (stats.chi2.ppf(level, 2 * count) / 2.0 for level, count in zip(_LEVELS, (freed, freed + 1)))
        values['free_mean'] = seconds / freed
        rows.append(Row('free_mean', seconds / freed, seconds / high, seconds / low, False))
    elif seconds:
        notes.append('free_mean: none of {} pairs came free in {:.0f} s; the mean time is at least {:.0f} s (95 %)'
                     .format(len(cases.contacts), seconds, -seconds / math.log(0.05)))


def _proportion(count: int, of: int) -> Tuple[float, float]:
    """Return the exact 95 % interval (Clopper, Pearson) of a proportion."""
    low = stats.beta.ppf(_LEVELS[0], count, of - count + 1) if count else 0.0
    high = stats.beta.ppf(_LEVELS[1], count + 1, of - count) if count < of else 1.0
    return float(low), float(high)


class Score(NamedTuple):
    """How well missions that were not fitted are predicted.

    ``missions``: their number; ``stuck``, ``expected``: cases, and the sum of their chances; ``hit``,
    ``expected_hit``: missions with at least one; ``gain``: by how much the logarithm of the likelihood is above that
    of one chance for all distances.
    """

    missions: int
    stuck: int
    expected: float
    hit: int
    expected_hit: float
    gain: float


def score(trials: Sequence[Trial], reach: float) -> Optional[Score]:
    """Return the :class:`Score` of ``trials``, each mission by a fit to all others; None: there are too few cases."""
    by_mission: Dict[str, List[Trial]] = {}
    for one in trials:
        by_mission.setdefault(one.mission, []).append(one)
    expected = expected_hit = gain = 0.0
    for mission, own in by_mission.items():
        others = [one for one in trials if one.mission != mission]
        curve = fit_chance(others, reach)
        if curve is None:
            return None
        chances, same = curve.chance([one.at for one in own]), sum(one.stuck for one in others) / len(others)
        expected += chances.sum()
        expected_hit += 1.0 - np.prod(1.0 - chances)
        gain += sum(math.log((chance / same) if one.stuck else (1.0 - chance) / (1.0 - same))
                    for one, chance in zip(own, chances))
    return Score(len(by_mission), sum(one.stuck for one in trials), float(expected),
                 sum(any(one.stuck for one in own) for own in by_mission.values()), float(expected_hit), gain)


def calibrate_stuck(folders: Sequence[str], name: str, robot_radius: float,
                    touch: float) -> Tuple[Dict[str, Any], Fitted, Cases, float]:
    """Return (values of the calibration ``name`` with the section, the Fitted, the Cases, radius of encounters [m]).

    ``folders``: those of the recordings; ``robot_radius``, ``touch`` [m]: see :func:`.find_cases`.

    :raises ConfigurationError: if a file cannot be read, or there are too few cases.
    """
    calibration = read_calibration(name, 'calibrate')
    radius = RADIUS if calibration.encounters is None else calibration.encounters.radius
    cases = find_cases(folders, calibration, radius, robot_radius, touch)
    fitted = fit_stuck(cases, radius)
    raw = load_yaml_file(calibration_file(name, 'calibrate'))
    del raw['format']
    source = '{} of {} encounters, {} of {} legs, {} missions'.format(
        *(number for trials in (cases.meetings, cases.ways) for number in (
            sum(one.stuck for one in trials), len(trials))), len({one.mission for one in cases.ways}))
    return {**raw, STUCK: {'source': source, **fitted.values}}, fitted, cases, radius


def lines(fitted: Fitted, cases: Cases, radius: float) -> Iterator[str]:
    """Yield the lines of the result: the values with their intervals, and how well missions are predicted by others."""
    yield from (row.line() for row in fitted.rows)
    yield '  {:18s} {:8.3g}   s, the median of {}'.format('patience', fitted.values['patience'], len(cases.patience))
    for note in fitted.notes:
        yield '  ' + note
    if cases.brief:
        yield '  {} other times two robots touched, for at most {:.0f} s'.format(len(cases.brief), max(cases.brief))
    if cases.unmet:
        yield '  {} pairs got stuck without an encounter before'.format(len(cases.unmet))
    for name, trials, reach in (('encounters', cases.meetings, radius), ('legs', cases.ways, CLEARANCE)):
        found = score(trials, reach)
        if found is not None:
            yield ('{}, {} missions, each by all others: {} got stuck, predicted {:.1f}; missions with at least one: '
                   '{}, predicted {:.1f}; logarithm of the likelihood {:+.2f} above one chance for all distances'
                   .format(name, *found))
