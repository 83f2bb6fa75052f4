"""Means of configurations, and differences between them within replications: the numbers behind the page.

Replication k has the same seed in every configuration (common random numbers), so that what is compared is the
difference within a replication, of which there is one per replication, whatever is averaged besides.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np

from . import intervals
from .intervals import Estimate

MAX_INTERACTION_LEVELS = 3  # of more, the first and the last are compared
ALL_PAIRS = 12  # configurations that are all compared where none differ in a single factor


class Difference(NamedTuple):
    """Second minus first, of one metric."""

    metric: object  # design.Metric
    factor: object  # place of the factor whose levels are compared; None: whole configurations
    first: object  # place of the level, or of the configuration
    second: object
    at: tuple  # what else is held fixed, (place of a factor, place of a level) pairs
    estimate: Estimate
    p: float
    p_holm: float  # among all of its kind
    reference: float  # the first one's mean in the same replications
    used: int  # pairs of configurations that are averaged over
    possible: int
    median: object  # Estimate of the median difference where the differences are skewed, None otherwise

    @property
    def is_shown(self):
        """Whether a difference is shown, all comparisons of its kind counted."""
        return self.p_holm < intervals.ALPHA

    @property
    def is_hint(self):
        """Whether its own interval leaves 0 out, but no difference is shown among so many."""
        return self.p < intervals.ALPHA and not self.is_shown


class Level(NamedTuple):
    """The mean of a metric at one level of a factor, over the other factors."""

    level: int
    estimate: Estimate


def summary(experiment, metric):
    """Return per configuration the Estimate of its mean, or share."""
    estimate = intervals.share_estimate if metric.is_share else intervals.mean_estimate
    return [estimate(row) for row in experiment.values(metric.name)]


def complete_blocks(rows):
    """Return which rows (configurations) are used, and in which columns (replications) all of them have a value.

    A row with less than half of the values of the fullest is left out: else it would take its gaps from all others.

    :param rows: shape (configurations, replications), NaN where there is no value.
    """
    there = ~np.isnan(rows)
    counts = there.sum(axis=1)
    used = (2 * counts >= counts.max(initial=0)) & (counts > 0)
    return used, there[used].all(axis=0) if used.any() else np.zeros(rows.shape[1], dtype=bool)


def main_effects(experiment):
    """Return the Differences between the levels of each factor, averaged over the other factors, of each metric."""
    found = []
    for metric in experiment.metrics:
        values = experiment.values(metric.name)
        for place, factor in enumerate(experiment.factors):
            for first, second in itertools.combinations(range(len(factor.levels)), 2):
                pairs = _pairs(experiment.configurations, place, first, second)
                if pairs:
                    found.append(_difference(metric, place, first, second, (), values, pairs))
    return _adjusted(found)


def single_differences(experiment):
    """Return the Differences between configurations that differ in one factor only, of each metric.

    Where no two do, all are compared, or all with the first if there are many.
    """
    configurations = experiment.configurations
    found = []
    for metric in experiment.metrics:
        values = experiment.values(metric.name)
        for place, factor in enumerate(experiment.factors):
            for first, second in itertools.combinations(range(len(factor.levels)), 2):
                for pair in _pairs(configurations, place, first, second):
                    at = tuple((number, level) for number, level in enumerate(configurations[pair[0]].levels)
                               if number != place and level is not None)
                    found.append(_difference(metric, place, first, second, at, values, [pair]))
    return _adjusted(found or _any_differences(experiment))


def _any_differences(experiment):
    count = len(experiment.configurations)
    pairs = itertools.combinations(range(count), 2) if count <= ALL_PAIRS else ((0, each) for each in range(1, count))
    pairs = list(pairs)
    return [_difference(metric, None, *pair, (), experiment.values(metric.name), [pair])
            for metric in experiment.metrics for pair in pairs]


def interactions(experiment):
    """Return how much the difference between two levels of a factor changes between two levels of another one."""
    found = []
    for metric in experiment.metrics:
        values = experiment.values(metric.name)
        for one, two in itertools.combinations(range(len(experiment.factors)), 2):
            for (a, b), (c, d) in itertools.product(_ends(experiment.factors[one]), _ends(experiment.factors[two])):
                groups = _quadruples(experiment.configurations, one, (a, b), two, (c, d))
                if groups:
                    change = np.array([(values[w] - values[x]) - (values[y] - values[z]) for w, x, y, z in groups])
                    base = np.array([values[y] - values[z] for w, x, y, z in groups])
                    found.append(_of_rows(metric, one, a, b, ((two, c), (two, d)), change, base))
    return _adjusted(found)


def _ends(factor):
    count = len(factor.levels)
    if count > MAX_INTERACTION_LEVELS:
        return [(0, count - 1)]
    return list(itertools.combinations(range(count), 2))


def _pairs(configurations, factor, first, second):
    """Return (with the first level, with the second) pairs of places of configurations that are the same otherwise."""
    others = {_without(each.levels, (factor,)): each.place for each in configurations if each.levels[factor] == second}
    return [(each.place, others[_without(each.levels, (factor,))]) for each in configurations
            if each.levels[factor] == first and _without(each.levels, (factor,)) in others]


def _quadruples(configurations, one, firsts, two, seconds):
    """Return the places (b at d, a at d, b at c, a at c) of configurations that are the same otherwise."""
    (a, b), (c, d) = firsts, seconds
    found = {}
    for each in configurations:
        found.setdefault(_without(each.levels, (one, two)), {})[each.levels[one], each.levels[two]] = each.place
    wanted = ((b, d), (a, d), (b, c), (a, c))
    return [tuple(group[key] for key in wanted) for group in found.values() if all(key in group for key in wanted)]


def _without(levels, factors):
    return tuple(level for place, level in enumerate(levels) if place not in factors)


def _difference(metric, factor, first, second, at, values, pairs):
    """Return the Difference of these pairs of configurations, not adjusted yet."""
    low, high = (values[[pair[side] for pair in pairs]] for side in (0, 1))
    if metric.is_share and len(pairs) == 1:
        comparison = intervals.paired_shares(low[0], high[0])
        both = ~np.isnan(low[0]) & ~np.isnan(high[0])
        reference = float(low[0][both].mean()) if both.any() else math.nan
        return Difference(metric, factor, first, second, at, *comparison, math.nan, reference,
                          int(both.any()), 1, None)
    return _of_rows(metric, factor, first, second, at, high - low, low)


def _of_rows(metric, factor, first, second, at, rows, reference):
    used, blocks = complete_blocks(rows)
    means = rows[used][:, blocks].mean(axis=0) if blocks.any() else np.array([])
    comparison = intervals.paired(means)
    median = intervals.median_estimate(means) if intervals.is_skewed(means) else None
    level = float(reference[used][:, blocks].mean()) if blocks.any() else math.nan
    return Difference(metric, factor, first, second, at, *comparison, math.nan, level, int(used.sum()), len(rows),
                      median)


def _adjusted(differences):
    """Return the Differences with Holm's probabilities: all of them are one family."""
    adjusted = intervals.holm([each.p for each in differences])
    return [each._replace(p_holm=p) for each, p in zip(differences, adjusted)]


def levels_of(experiment, metric, factor, fixed=()):
    """Return the Levels of a factor that were run: means over the other factors, and whether they are like for like.

    Where possible the means are over those combinations of the other factors that every level was run with.

    :param fixed: (place of a factor, place of a level) pairs to which all is restricted.
    """
    values = experiment.values(metric.name)
    groups = {}
    for each in experiment.configurations:
        if all(each.levels[other] == level for other, level in fixed) and each.levels[factor] is not None:
            groups.setdefault(each.levels[factor], {})[_without(each.levels, (factor,))] = each.place
    common = [key for key in next(iter(groups.values()), {}) if all(key in group for group in groups.values())]
    found = []
    for level, group in sorted(groups.items()):
        rows = values[[group[key] for key in (common or group)]]
        found.append(Level(level, _mean_of_rows(metric, rows)))
    return found, bool(common) and all(len(group) == len(common) for group in groups.values())


def _mean_of_rows(metric, rows):
    if metric.is_share and len(rows) == 1:
        return intervals.share_estimate(rows[0])
    used, blocks = complete_blocks(rows)
    mean = intervals.mean_estimate(rows[used][:, blocks].mean(axis=0) if blocks.any() else [])
    if metric.is_share and mean.has_interval:  # a mean of shares: Student's bounds may lie beyond what there can be
        return mean._replace(low=max(0.0, mean.low), high=min(1.0, mean.high))
    return mean
