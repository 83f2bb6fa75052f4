"""Means of configurations, and differences between them within replications: the numbers behind the page.

Replication k has the same seed in every configuration (common random numbers), so that what is compared is the
difference within a replication. Over several combinations of the other factors each counts alike, however many values
it has: trials that failed, or fewer replications, shift no weight from one to another.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np

from . import endings, intervals, orders
from .intervals import NOTHING, Estimate
from .outcome import COMPLETE, FAILED

MAX_INTERACTION_LEVELS = 3  # of more, the first and the last are compared
ALL_PAIRS = 12  # configurations that are all compared where none differ in a single factor


class Side(NamedTuple):
    """What became of the trials on one side of a comparison. ``run``: all but those that have not run."""

    run: int
    failed: int
    without: int  # complete, and without a value
    cut: int  # ended by the limit of time, so that the value is a bound at best

    @property
    def lacking(self):
        """The share of trials that have no value."""
        return (self.failed + self.without) / self.run if self.run else 0.0


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
    reference: float  # the first one's mean in the same trials
    groups: tuple  # of places of configurations: what is compared, per combination of the other factors
    counts: tuple  # per group: in how many replications it has values on all sides; 0 where they are bounds only
    cut: tuple  # per group: whether the limit of time ended trials, so that values are bounds only
    median: object  # Estimate of the median difference where the differences are skewed, None otherwise
    sides: tuple = ()  # of Side, first and second
    against: tuple = ()  # (group, Estimate) of those in which the difference has the other sign
    order: object = None  # orders.Order where there is no mean and values are lower bounds; then p is that of its test

    @property
    def needed(self):
        """How many values a group must have to count; with one there is no interval."""
        return 2 if max(self.counts, default=0) >= 2 else 1

    @property
    def used(self):
        """The groups that are averaged over."""
        return tuple(group for group, count in zip(self.groups, self.counts) if count >= self.needed)

    @property
    def fewest(self):
        """The number of values of the used group that has the fewest."""
        return min((count for count in self.counts if count >= self.needed), default=0)

    @property
    def is_cut(self):
        """Whether nothing can be said since the limit of time ended trials."""
        return not self.used and any(self.cut)

    @property
    def is_ordered(self):
        """Whether which side is larger is shown, though not by how much."""
        return self.is_cut and self.order is not None and not self.order.against and self.p_holm < intervals.ALPHA

    @property
    def leaves_out_0(self):
        """Whether the interval does."""
        return self.estimate.low > 0.0 or self.estimate.high < 0.0

    @property
    def is_shown(self):
        """Whether a difference is shown, all comparisons of its kind counted."""
        return self.p_holm < intervals.ALPHA and self.leaves_out_0

    @property
    def is_hint(self):
        """Whether its own interval leaves 0 out, but no difference is shown among so many."""
        return self.leaves_out_0 and not self.is_shown


class Level(NamedTuple):
    """The mean of a metric at one level of a factor, over the other factors."""

    level: int
    estimate: Estimate


def summary(experiment, metric):
    """Return per configuration the Estimate of its mean, or share; none where values are bounds only."""
    estimate = intervals.share_estimate if metric.is_share else intervals.mean_estimate
    return [NOTHING._replace(n=len(intervals.known(row)), method='cut') if cut.any() else estimate(row)
            for row, cut in zip(experiment.values(metric), experiment.cut(metric))]


def main_effects(experiment, metrics=None):
    """Return the Differences between the levels of each factor, averaged over the other factors, of each metric."""
    found = []
    for metric in experiment.metrics if metrics is None else metrics:
        for place, factor in enumerate(experiment.factors):
            for first, second in itertools.combinations(range(len(factor.levels)), 2):
                pairs = _pairs(experiment.configurations, place, first, second)
                if pairs:
                    found.append(_difference(experiment, metric, place, (first, second), (), pairs))
    return _adjusted(found)


def single_differences(experiment, metrics=None):
    """Return the Differences between configurations that differ in one factor only, of each metric.

    Where no two do, all are compared, or all with the first if there are many.
    """
    configurations = experiment.configurations
    metrics = experiment.metrics if metrics is None else metrics
    found = []
    for metric in metrics:
        for place, factor in enumerate(experiment.factors):
            for first, second in itertools.combinations(range(len(factor.levels)), 2):
                for pair in _pairs(configurations, place, first, second):
                    at = tuple((number, level) for number, level in enumerate(configurations[pair[0]].levels)
                               if number != place and level is not None)
                    found.append(_difference(experiment, metric, place, (first, second), at, [pair]))
    return _adjusted(found or _any_differences(experiment, metrics))


def _any_differences(experiment, metrics):
    count = len(experiment.configurations)
    pairs = itertools.combinations(range(count), 2) if count <= ALL_PAIRS else ((0, each) for each in range(1, count))
    pairs = list(pairs)
    return [_difference(experiment, metric, None, pair, (), [pair]) for metric in metrics for pair in pairs]


def outcome_differences(experiment):
    """Return the Differences of how trials ended, between levels and between configurations; each outcome a family."""
    return tuple([each for metric in experiment.outcomes for each in found(experiment, [metric])]
                 for found in (main_effects, single_differences))


def interactions(experiment):
    """Return how much the difference between two levels of a factor changes between two levels of another one."""
    found = []
    for metric in experiment.metrics:
        for one, two in itertools.combinations(range(len(experiment.factors)), 2):
            for (a, b), (c, d) in itertools.product(_ends(experiment.factors[one]), _ends(experiment.factors[two])):
                groups = _quadruples(experiment.configurations, one, (a, b), two, (c, d))
                if groups:
                    found.append(_of_groups(experiment, metric, (one, a, b, ((two, c), (two, d))), groups,
                                            (1, -1, -1, 1)))
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


def _difference(experiment, metric, factor, levels, at, pairs):
    """Return the Difference of these pairs of configurations, not adjusted yet."""
    return _of_groups(experiment, metric, (factor, *levels, at), pairs, (-1, 1))


def _of_groups(experiment, metric, what, groups, signs):
    """Return the Difference of groups of configurations, which enter with these signs; ``what``: factor, first, ..."""
    values = experiment.values(metric)
    tables = [values[[group[side] for group in groups]] for side in range(len(signs))]
    rows, left = intervals.contrast(signs, tables)
    cut = experiment.cut(metric).any(axis=1)
    is_cut = tuple(any(cut[place] for place in group) for group in groups)
    rows[list(is_cut)] = math.nan  # no mean can be had of values that the limit of time cut off
    counts = tuple(int(count) for count in (~np.isnan(rows)).sum(axis=1))
    found = Difference(metric, *what, NOTHING, math.nan, math.nan, math.nan, tuple(groups), counts, is_cut, None,
                       _sides(experiment, metric, groups))
    used = np.array([count >= found.needed for count in counts])
    if not used.any():
        return _ordered(experiment, found)
    tables, rows, left = [table[used] for table in tables], rows[used], left[used]
    comparison = _compared(metric, tables, rows, left)
    base = np.where(np.isnan(rows), math.nan, tables[0])
    blocks = rows[:, ~np.isnan(rows).any(axis=0)].mean(axis=0)
    return found._replace(estimate=comparison.estimate, p=comparison.p,
                          reference=float(np.mean([np.mean(intervals.known(row)) for row in base])),
                          median=intervals.median_estimate(blocks) if intervals.is_skewed(blocks) else None,
                          against=_against(metric, found.used, tables, rows, left, comparison.estimate.value))


def _ordered(experiment, difference):
    """Return a Difference of which no mean is known with what is known of the order of its values."""
    if not difference.is_cut or len(difference.sides) != len(difference.groups[0]) \
            or difference.metric.at_limit not in endings.BOUNDS:
        return difference
    tables, cuts = ([table[[group[side] for group in difference.groups]] for side in (0, 1)]
                    for table in (experiment.values(difference.metric), experiment.cut(difference.metric)))
    order = orders.order_of(tables, cuts, difference.groups)
    return difference if order is None else difference._replace(order=order, p=order.p)


def _against(metric, groups, tables, rows, left, value):
    """Return (group, Estimate) of those in which a difference is there, and has another sign than that of all."""
    if len(groups) < 2 or len(tables) != 2:
        return ()
    found = []
    for place, group in enumerate(groups):
        own = slice(place, place + 1)
        estimate = _compared(metric, [table[own] for table in tables], rows[own], left[own]).estimate
        if (estimate.low > 0.0 or estimate.high < 0.0) and (value == 0.0 or (estimate.value < 0.0) != (value < 0.0)):
            found.append((group, estimate))
    return tuple(found)


def _compared(metric, tables, rows, left):
    """Return the Comparison of rows: of shares, and where most pairs do not differ, by counts.

    A t test is too sure of the few that do: of four of thirty on one side, of which chance makes one in eight.
    """
    if metric.is_share and len(tables) == 2:
        return intervals.share_differences(*tables)
    found = intervals.clustered(rows, left)
    seen = intervals.known(rows.ravel())
    if found.estimate.method != 't' or 2 * np.count_nonzero(seen) > len(seen):
        return found
    return found._replace(p=max(found.p, intervals.flip_test(np.sign(np.nansum(rows, axis=0)))))


def _sides(experiment, metric, groups):
    """Return the Sides of groups: what is subtracted first; of a change, what is at the first level of the other."""
    half = len(groups[0]) // 2
    parts = (slice(0, half), slice(half, None)) if half == 1 else (slice(half, None), slice(0, half))
    return tuple(_side(experiment, metric, {place for group in groups for place in group[part]}) for part in parts)


def _side(experiment, metric, places):
    """Return the Side of some configurations."""
    own = sorted(places)
    failed, complete = (int(experiment.count(status)[own].sum()) for status in (FAILED, COMPLETE))
    if metric.outcome:
        return Side(failed + complete, 0, 0, 0)
    without = complete - int((~np.isnan(experiment.values(metric)[own])).sum())
    return Side(failed + complete, failed, without, int(experiment.cut(metric)[own].sum()))


def _adjusted(differences):
    """Return the Differences with Holm's probabilities.

    All of them are one family, but those of a metric that the experiment names as the primary one, which are another.
    """
    found = list(differences)
    for is_primary in (True, False):
        places = [place for place, each in enumerate(differences) if each.metric.is_primary == is_primary]
        for place, p in zip(places, intervals.holm([differences[place].p for place in places])):
            found[place] = found[place]._replace(p_holm=p)
    return found


def levels_of(experiment, metric, factor, fixed=()):
    """Return the Levels of a factor that were run: means over the other factors, and whether they are like for like.

    Where possible the means are over those combinations of the other factors in which every level has values.

    :param fixed: (place of a factor, place of a level) pairs to which all is restricted.
    """
    values = experiment.values(metric)
    there = (~np.isnan(values)).any(axis=1)
    groups = {}
    for each in experiment.configurations:
        if all(each.levels[other] == level for other, level in fixed) and each.levels[factor] is not None:
            groups.setdefault(each.levels[factor], {})[_without(each.levels, (factor,))] = each.place
    common = [key for key in next(iter(groups.values()), {}) if all(key in group for group in groups.values())]
    common = [key for key in common if all(there[group[key]] for group in groups.values())]
    found = []
    for level, group in sorted(groups.items()):
        places = [group[key] for key in (common or group) if there[group[key]]]
        found.append(Level(level, _mean_of_rows(metric, values[places])))
    return found, bool(common) and all(len(group) == len(common) for group in groups.values())


def _mean_of_rows(metric, rows):
    if not len(rows):
        return NOTHING
    if metric.is_share and len(rows) == 1:
        return intervals.share_estimate(rows[0])
    mean = intervals.clustered(rows).estimate
    if metric.is_share and mean.has_interval:  # a mean of shares: Student's bounds may lie beyond what there can be
        return mean._replace(low=max(0.0, mean.low), high=min(1.0, mean.high))
    return mean
