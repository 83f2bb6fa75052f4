"""Fit the cost of encounters: the law of the section ``encounters``, by maximum likelihood with weak priors.

A leg takes as long as the calibration says for it alone. With the chance that one of its encounters costs time, it
takes longer: by a delay from a lognormal distribution, or for a block from a gamma distribution, and by the time to get
going again. A leg that was given up after an encounter was blocked. A leg that was cancelled would have taken longer.
The priors lie around values that were chosen by hand. So a value about which the recordings say nothing stays there,
and its row says so (``held``).
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, List, NamedTuple, Sequence, Tuple

import numpy as np
from scipy import optimize, special, stats

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.encounter_law import KINDS

from .law import Durations

if TYPE_CHECKING:
    from .law import Values
    from .meetings import Meeting, MetLeg

LEAST_MET = 20
_STEP, _LONGEST = 0.5, 300.0  # s; the step and the largest of the delays for the integration
_DELAYS = np.arange(0.5 * _STEP, _LONGEST, _STEP)
_STRANGE, _STRANGE_SECONDS = 1e-3, 20.0  # as in the fit of legs
_NEAR, _FAR = -0.2, -1.5  # the logits of the usual chances at 0 m and at the radius
#: (name, usual value of the fitted number, its spread, function from the fitted number to the value)
_FITTED = (*((kind + end, usual, 1.0, special.expit) for kind in KINDS
             for end, usual in (('_near', _NEAR), ('_far', _FAR))),
           ('delay_mean', math.log(5.0), 0.7, np.exp), ('delay_cv', 0.0, 0.5, np.exp),
           ('block_near', special.logit(0.2), 1.0, special.expit),
           ('block_far', special.logit(0.05), 1.0, special.expit),
           ('block_mean', math.log(90.0), 0.5, np.exp),
           ('block_cv', math.log(0.4), 0.5, np.exp),
           ('long_chance', special.logit(0.05), 1.0, special.expit), ('long_mean', math.log(400.0), 0.5, np.exp))
_NAMES = [name for name, *_ in _FITTED]
_PRIOR_HOLDS = 0.8  # if more than this share of a prior's spread is left, the prior holds the value
_SURE = 1.0 - 1e-12  # the largest chance whose complement has a logarithm
_PLACES = 7  # the number of rows in the tables of chances
_BOTH_PRIOR, _ABORT_PRIOR = (1.0, 4.0), (1.0, 4.0)  # the numbers of yes and no that the priors are worth


class Row(NamedTuple):
    """A fitted value with its 95 % interval; ``held``: whether the prior holds it, as the recordings say little."""

    name: str
    value: float
    low: float
    high: float
    held: bool

    def line(self) -> str:
        """Return the line of a result."""
        return '  {:18s} {:8.3g}   95 %: {:.3g} to {:.3g}{}'.format(
            *self[:4], '   held by the prior' if self.held else '')


class Fitted(NamedTuple):
    """The result of a fit: ``values`` of the section, ``rows`` ([Row]), ``counts`` {kind: number of encounters}."""

    values: dict
    rows: tuple
    counts: dict


def fit_encounters(legs: Sequence[MetLeg], calibration: Values, radius: float) -> Fitted:
    """Return the :class:`Fitted` for ``legs`` [MetLeg].

    ``calibration``: {parameter: value} for a robot alone; ``radius`` [m]: that of an encounter.

    :raises ConfigurationError: if too few legs met another robot.
    """
    met = [leg for leg in legs if any(one.may_yield for one in leg.meetings)]
    if len(met) < LEAST_MET:
        raise ConfigurationError('got {} legs that met a robot and count; allowed: at least {}'.format(
            len(met), LEAST_MET))
    data = _Data(met, calibration, radius)
    usual, widths = (np.array([row[place] for row in _FITTED]) for place in (1, 2))
    both = _BOTH_PRIOR[0] / sum(_BOTH_PRIOR)
    for _ in range(2):  # which robots stand, and how often both do, depend on each other
        def cost(packed: np.ndarray, both: float = both) -> float:
            return 0.5 * np.sum(((packed - usual) / widths) ** 2) - data.log_likelihood(packed, both).sum()
        found = optimize.minimize(cost, usual, method='L-BFGS-B',
                                  bounds=list(zip(usual - 3.0 * widths, usual + 3.0 * widths)))
        both = data.both_chance(legs, found.x, both)
    variance = np.diag(np.linalg.inv(_hessian(cost, found.x)))
    spread = np.sqrt(np.where(variance > 0.0, variance, widths ** 2))  # at a bound, only the prior is known
    rows = tuple(Row(name, *(float(back(found.x[k] + z * spread[k])) for z in (0.0, -1.96, 1.96)),  # type: ignore[arg-type, call-arg]
                     bool(spread[k] > _PRIOR_HOLDS * width)) for k, (name, _, width, back) in enumerate(_FITTED))
    values: Any = {row.name: row.value for row in rows[2 * len(KINDS):] if row.name not in ('block_near', 'block_far')}
    values.update(block_chance=_table(found.x, 'block', radius), radius=radius,
                  both_chance=both, abort_chance=data.abort_chance(found.x, both), narrow_below=0.0,
                  narrow_weight=1.0, **{'chance_' + kind: _table(found.x, kind, radius) for kind in KINDS})
    counts = {kind: sum(one.kind == kind for leg in legs for one in leg.meetings) for kind in KINDS}
    return Fitted(values, rows, counts)


def log_likelihoods(legs: Sequence[MetLeg], calibration: Values, fitted: Fitted,
                    radius: float) -> Tuple[float, float]:
    """Return (with encounters, without): the sums of the logarithms of the densities of ``legs`` that met a robot."""
    met = [leg for leg in legs if leg.succeeded and any(one.may_yield for one in leg.meetings)]
    if not met:
        return 0.0, 0.0
    data = _Data(met, calibration, radius)
    packed = np.array([_inverse(back)(row.value) for row, (*_, back) in zip(fitted.rows, _FITTED)])
    never = np.full(len(_FITTED), -30.0)
    never[2 * len(KINDS):] = packed[2 * len(KINDS):]
    both = fitted.values['both_chance']
    return float(data.log_likelihood(packed, both).sum()), float(data.log_likelihood(never, both).sum())


def mean_seconds(leg: MetLeg, values: Values, radius: float) -> float:
    """Return the mean delay [s] of a leg that succeeds by its encounters, with the ``values`` of a section.

    Blocks that end with giving up, and long blocks, belong to legs that do not succeed.
    """
    go_on = (1.0 - values['long_chance']) * (1.0 - values['abort_chance'])

    def mean(one: Meeting) -> float:
        chance, block = (np.interp(one.nearest, *np.transpose(values[name])) for name in (
            'chance_' + one.kind, 'block_chance'))
        chance *= _share(one, values['both_chance'])
        late = chance * ((1.0 - block) * values['delay_mean'] + block * go_on * values['block_mean'])
        return late / (1.0 - chance * block * (1.0 - go_on))
    return sum(mean(one) for one in leg.meetings if one.may_yield)


def _inverse(back: Callable[..., Any]) -> Callable[..., Any]:
    return special.logit if back is special.expit else np.log


def _share(meeting: Meeting, both: float) -> float:
    """Return the chance that this robot must stand if the encounter costs time at all."""
    return 0.5 * (1.0 + both) if meeting.kind in ('head_on', 'crossing') else 1.0


def _table(packed: np.ndarray, kind: str, radius: float) -> List[List[float]]:
    near, far = (packed[_NAMES.index(kind + end)] for end in ('_near', '_far'))
    return [[float(share * radius), float(special.expit(near + share * (far - near)))]
            for share in np.linspace(0.0, 1.0, _PLACES)]


class _Data:
    """The legs that met a robot, as arrays: the density of each without a delay, and after each delay."""

    def __init__(self, met: Sequence[MetLeg], calibration: Values, radius: float) -> None:
        self.met = met
        law = Durations(calibration, [leg.way for leg in met])
        times = np.array([leg.duration for leg in met])
        again = calibration['max_speed'] / (2.0 * calibration['acceleration'])  # s, to get going again
        self._strange = 1.0 / (math.pi * _STRANGE_SECONDS * (1.0 + ((times - law.least) / _STRANGE_SECONDS) ** 2))
        self._alone = law.density(times)
        with np.errstate(over='ignore', invalid='ignore'):
            self._late = np.nan_to_num(np.array([law.density(times - again - delay) for delay in _DELAYS]).T)
        flat = [(number, one) for number, leg in enumerate(met) for one in leg.meetings if one.may_yield]
        self._of = np.array([number for number, _ in flat])
        self._kinds = np.array([_NAMES.index(one.kind + '_near') for _, one in flat])
        self._far = np.array([min(1.0, one.nearest / radius) for _, one in flat])
        self._yields_both = np.array([_share(one, 0.0) < 1.0 for _, one in flat])
        self._succeeded, self._cut = (np.array([getattr(leg, name) for leg in met]) for name in ('succeeded', 'cut'))
        self._alone_later, self._over = 1.0 - law.share_below(times), np.maximum(0.0, times - again - law.least)
        first = np.array([min(one.after for one in leg.meetings if one.may_yield) for leg in met])
        self._until_end = np.maximum(_STEP, times - first)

    def _chances(self, packed: np.ndarray, both: float) -> Tuple[np.ndarray, np.ndarray]:
        """Return the chances of each leg that one of its encounters costs it time, and that one blocks it."""
        def at(places: np.ndarray) -> np.ndarray:
            return special.expit(packed[places] + self._far * (packed[places + 1] - packed[places]))
        costs = np.where(self._yields_both, 0.5 * (1.0 + both), 1.0) * at(self._kinds)
        blocks = costs * at(np.full(len(costs), _NAMES.index('block_near')))
        return tuple(1.0 - np.exp(np.bincount(self._of, np.log1p(-np.minimum(one, _SURE)), len(self.met)))
                     for one in (costs, blocks))

    def _parts(self, packed: np.ndarray, both: float) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the densities of each leg: not delayed, delayed, blocked, each times its chance.

        For legs that were cut, these are the chances that they would take longer.
        """
        value = {name: float(back(packed[k])) for k, (name, *_, back) in enumerate(_FITTED)}
        chances, blocked = self._chances(packed, both)
        variance = math.log1p(value['delay_cv'] ** 2)
        # Keywords of scipy's distributions: to freeze three of them takes as long as all of the densities.
        delays = {'s': math.sqrt(variance), 'scale': value['delay_mean'] * math.exp(-0.5 * variance)}
        shape = 1.0 / value['block_cv'] ** 2
        blocks, longer = {'a': shape, 'scale': value['block_mean'] / shape}, {'scale': value['long_mean']}
        share = value['long_chance']

        def mixed(block: np.ndarray, long: np.ndarray) -> np.ndarray:
            return (1.0 - share) * block + share * long
        density = mixed(stats.gamma.pdf(_DELAYS, **blocks), stats.expon.pdf(_DELAYS, **longer))
        ended = ((1.0 - chances) * self._alone,
                 (chances - blocked) * (self._late @ stats.lognorm.pdf(_DELAYS, **delays)) * _STEP,
                 blocked * (self._late @ density) * _STEP)
        cut = ((1.0 - chances) * self._alone_later, (chances - blocked) * stats.lognorm.sf(self._over, **delays),
               blocked * mixed(stats.gamma.sf(self._over, **blocks), stats.expon.sf(self._over, **longer)))
        given_up = (0.0, 0.0, blocked * (1.0 - share) * stats.gamma.pdf(self._until_end, **blocks))
        return tuple(np.where(self._succeeded, one, np.where(self._cut, other, third))
                     for one, other, third in zip(ended, cut, given_up))

    def log_likelihood(self, packed: np.ndarray, both: float) -> np.ndarray:
        """Return the logarithm of each leg's density. A small share of it is for legs that nothing explains."""
        return np.log((1.0 - _STRANGE) * np.nan_to_num(sum(self._parts(packed, both))) + _STRANGE * self._strange)

    def _affected(self, packed: np.ndarray, both: float) -> Tuple[np.ndarray, np.ndarray]:
        alone, delayed, blocked = self._parts(packed, both)
        whole = np.maximum(1e-300, alone + delayed + blocked)
        return (delayed + blocked) / whole, blocked / whole

    def both_chance(self, legs: Sequence[MetLeg], packed: np.ndarray, both: float) -> float:
        """Return the chance that an encounter that costs time costs it both robots, from legs that met each other."""
        affected, _ = self._affected(packed, both)
        of = {id(leg): share for leg, share in zip(self.met, affected)}
        yes, no = _BOTH_PRIOR
        for leg in self.met:
            for one in leg.meetings:
                other = None if one.other is None else legs[one.other]
                if id(other) in of and one.kind in ('head_on', 'crossing'):
                    together = of[id(leg)] * of[id(other)]
                    yes += 0.5 * together  # each pair occurs twice
                    no += 0.5 * (of[id(leg)] + of[id(other)] - 2.0 * together)
        return float(yes / (yes + no))

    def abort_chance(self, packed: np.ndarray, both: float) -> float:
        """Return the chance that a block ends with giving up."""
        _, blocked = self._affected(packed, both)
        ended = float(np.sum(~self._succeeded & ~self._cut))
        return (ended + _ABORT_PRIOR[0]) / (float(blocked.sum()) + sum(_ABORT_PRIOR))


def _hessian(function: Callable[..., Any], at: np.ndarray) -> np.ndarray:
    """Return the matrix of second derivatives of ``function``, by differences."""
    step, count = 1e-2, len(at)
    steps = np.eye(count) * step
    values = np.empty((count, count))
    for row in range(count):
        for column in range(row, count):
            one, other = at + steps[row], at - steps[row]
            values[row, column] = values[column, row] = 0.25 / step ** 2 * (
                function(one + steps[column]) - function(one - steps[column])
                - function(other + steps[column]) + function(other - steps[column]))
    return values
