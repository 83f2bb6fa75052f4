"""Means of configurations, and differences between them within replications: the numbers behind the page.

Replication k has the same seed in every configuration (common random numbers), so differences are taken within a
replication. In a mean over several combinations of the other factors, each combination has the same weight, however
many values it has. So trials that failed, or fewer replications, shift no weight from one combination to another.
"""
from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, AbstractSet, Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import endings, intervals, orders
from .intervals import NOTHING, Estimate
from .outcome import COMPLETE, FAILED

if TYPE_CHECKING:
    from .design import Configuration, Factor, Levels, Metric
    from .intervals import Comparison
    from .outcome import Experiment

MAX_INTERACTION_LEVELS = 3  # if a factor has more levels, only its first and its last are compared
ALL_PAIRS = 12  # up to so many configurations are all compared with one another if no two differ in one factor only

#: configurations that are compared: their places
Group = Tuple[int, ...]
#: levels that are held fixed: (place of a factor, place of a level)
At = Tuple[Tuple[int, int], ...]


class Side(NamedTuple):
    """The numbers of trials on one side of a comparison, by their outcome."""

    run: int  # all but those that have not run
    failed: int
    without: int  # complete, but without a value
    cut: int  # ended by the limit of time, so that the value is at best a bound

    @property
    def lacking(self) -> float:
        """The share of trials that have no value."""
        return (self.failed + self.without) / self.run if self.run else 0.0


class Difference(NamedTuple):
    """The difference of one metric between two levels or configurations, second minus first."""

    metric: Metric
    factor: Optional[int]  # the place of the factor whose levels are compared; None: whole configurations are compared
    first: int  # the place of the level, or of the configuration
    second: int
    at: At
    estimate: Estimate
    p: float
    p_holm: float  # Holm's, among all comparisons of its family, see _adjusted
    reference: float  # the mean of the first one in the same trials
    groups: Tuple[Group, ...]  # one for each combination of the other factors
    counts: Tuple[int, ...]  # per group: the number of replications with values on all sides; 0 if values are cut off
    cut: Tuple[bool, ...]  # per group: whether the limit of time cut values off, so that they are at best bounds
    median: Optional[Estimate]  # of the median difference if the differences are skewed, otherwise None
    sides: Tuple[Side, ...] = ()  # first and second
    against: Tuple[Tuple[Group, Estimate], ...] = ()  # of the groups in which the difference has the opposite sign
    order: Optional[orders.Order] = None  # if there is no mean and values are lower bounds; p is then of its test
    is_everywhere: bool = False  # whether each pair, also of groups that are not used, has the sign of the mean

    @property
    def needed(self) -> int:
        """The number of values that a group must have to count: 2 for an interval; 1 if no group has two."""
        return 2 if max(self.counts, default=0) >= 2 else 1

    @property
    def used(self) -> Tuple[Tuple[int, ...], ...]:
        """The groups that are averaged over."""
        return tuple(group for group, count in zip(self.groups, self.counts) if count >= self.needed)

    @property
    def fewest(self) -> int:
        """The number of values of the used group that has the fewest."""
        return min((count for count in self.counts if count >= self.needed), default=0)

    @property
    def is_cut(self) -> bool:
        """Whether no mean can be given because the limit of time ended trials."""
        return not self.used and any(self.cut)

    @property
    def is_ordered(self) -> bool:
        """Whether it is shown which side is larger, although not by how much."""
        return self.is_cut and self.order is not None and not self.order.against and self.p_holm < intervals.ALPHA

    @property
    def leaves_out_0(self) -> bool:
        """Whether the interval does not contain 0."""
        return self.estimate.low > 0.0 or self.estimate.high < 0.0

    @property
    def is_shown(self) -> bool:
        """Whether a difference is shown, with all comparisons of its family counted."""
        return self.p_holm < intervals.ALPHA and self.leaves_out_0

    @property
    def is_hint(self) -> bool:
        """Whether the interval does not contain 0, but no difference is shown if all comparisons are counted."""
        return self.leaves_out_0 and not self.is_shown


class Level(NamedTuple):
    """The mean of a metric at one level of a factor, over the other factors."""

    level: int
    estimate: Estimate


def summary(experiment: Experiment, metric: Metric) -> List[Estimate]:
    """Return the Estimate of the mean or share of each configuration; method 'cut' if values are cut off."""
    estimate = intervals.share_estimate if metric.is_share else intervals.mean_estimate
    return [NOTHING._replace(n=len(intervals.known(row)), method='cut') if cut.any() else estimate(row)
            for row, cut in zip(experiment.values(metric), experiment.cut(metric))]


def main_effects(experiment: Experiment, metrics: Optional[Sequence[Metric]] = None) -> List[Difference]:
    """Return, for each metric, the Differences between the levels of each factor, averaged over the other factors.

    :param metrics: those of the experiment if None.
    """
    return _adjusted([_difference(experiment, metric, place, levels, (), pairs)
                      for metric, place, levels, pairs in _comparisons(experiment, metrics)])


def _comparisons(experiment: Experiment, metrics: Optional[Sequence[Metric]]) -> Iterator[Tuple[
        Metric, int, Tuple[int, int], List[Tuple[int, int]]]]:
    """Yield (metric, place of a factor, two of its levels, pairs of configurations that differ in these only)."""
    for metric in experiment.metrics if metrics is None else metrics:
        for place, factor in enumerate(experiment.factors):
            for levels in itertools.combinations(range(len(factor.levels)), 2):
                pairs = _pairs(experiment.configurations, place, *levels)
                if pairs:
                    yield metric, place, levels, pairs


def single_differences(experiment: Experiment, metrics: Optional[Sequence[Metric]] = None) -> List[Difference]:
    """Return, for each metric, the Differences between configurations that differ in one factor only.

    If there are no two such configurations, all are compared with one another; if there are many, with the first one.

    :param metrics: those of the experiment if None.
    """
    found = [_difference(experiment, metric, place, levels, tuple(
        (number, level) for number, level in enumerate(experiment.configurations[pair[0]].levels)
        if number != place and level is not None), [pair])
        for metric, place, levels, pairs in _comparisons(experiment, metrics) for pair in pairs]
    return _adjusted(found or _any_differences(experiment, experiment.metrics if metrics is None else metrics))


def _any_differences(experiment: Experiment, metrics: Sequence[Metric]) -> List[Difference]:
    count = len(experiment.configurations)
    pairs = list(itertools.combinations(range(count), 2)) if count <= ALL_PAIRS else [
        (0, each) for each in range(1, count)]
    return [_difference(experiment, metric, None, pair, (), [pair]) for metric in metrics for pair in pairs]


def outcome_differences(experiment: Experiment) -> Tuple[List[Difference], List[Difference]]:
    """Return the Differences of how trials ended: a list of those between levels, a list between configurations.

    Each way of ending is a family of its own for Holm's correction.
    """
    outcomes = experiment.outcomes
    return ([each for metric in outcomes for each in main_effects(experiment, [metric])],
            [each for metric in outcomes for each in single_differences(experiment, [metric])])


def of_metric(metric: Metric, mains: Sequence[Difference], singles: Sequence[Difference]) -> List[Difference]:
    """Return the Differences of a metric between levels, or if there are none those between configurations."""
    return [each for each in mains if each.metric is metric] or [each for each in singles if each.metric is metric]


def interactions(experiment: Experiment) -> List[Difference]:
    """Return, as Differences, how the difference between two levels of a factor changes between two of another one."""
    found = []
    for metric in experiment.metrics:
        for one, two in itertools.combinations(range(len(experiment.factors)), 2):
            for (a, b), (c, d) in itertools.product(_ends(experiment.factors[one]), _ends(experiment.factors[two])):
                groups = _quadruples(experiment.configurations, one, (a, b), two, (c, d))
                if groups:
                    found.append(_of_groups(experiment, metric, (one, a, b, ((two, c), (two, d))), groups,
                                            (1, -1, -1, 1)))
    return _adjusted(found)


def _ends(factor: Factor) -> List[Tuple[int, int]]:
    count = len(factor.levels)
    if count > MAX_INTERACTION_LEVELS:
        return [(0, count - 1)]
    return list(itertools.combinations(range(count), 2))


def _pairs(configurations: Sequence[Configuration], factor: int, first: int, second: int) -> List[Tuple[int, int]]:
    """Return pairs of places of configurations that differ in this factor only: (first level, second level)."""
    others = {_without(each.levels, (factor,)): each.place for each in configurations if each.levels[factor] == second}
    return [(each.place, others[_without(each.levels, (factor,))]) for each in configurations
            if each.levels[factor] == first and _without(each.levels, (factor,)) in others]


def _quadruples(configurations: Sequence[Configuration], one: int, firsts: Tuple[int, int], two: int,
                seconds: Tuple[int, int]) -> List[Group]:
    """Return the places (b at d, a at d, b at c, a at c) of configurations that differ in these two factors only."""
    (a, b), (c, d) = firsts, seconds
    found: Dict[Levels, Dict[Any, int]] = {}
    for each in configurations:
        found.setdefault(_without(each.levels, (one, two)), {})[each.levels[one], each.levels[two]] = each.place
    wanted = ((b, d), (a, d), (b, c), (a, c))
    return [tuple(group[key] for key in wanted) for group in found.values() if all(key in group for key in wanted)]


def _without(levels: Levels, factors: Sequence[int]) -> Levels:
    return tuple(level for place, level in enumerate(levels) if place not in factors)


def _difference(experiment: Experiment, metric: Metric, factor: Optional[int], levels: Tuple[int, int],
                at: At, pairs: Sequence[Tuple[int, int]]) -> Difference:
    """Return the Difference of these pairs of configurations; its p_holm is still NaN."""
    return _of_groups(experiment, metric, (factor, *levels, at), pairs, (-1, 1))


def _of_groups(experiment: Experiment, metric: Metric, what: Tuple[Optional[int], int, int, At],
               groups: Sequence[Group], signs: Sequence[int]) -> Difference:
    """Return the Difference of groups of configurations; its p_holm is still NaN.

    :param what: factor, first, second and at of the Difference. :param groups: tuples of places of configurations.
    :param signs: the sign of each configuration of a group in the difference, 1 or -1.
    """
    values = experiment.values(metric)
    tables = [values[[group[side] for group in groups]] for side in range(len(signs))]
    rows, left = intervals.contrast(signs, tables)
    cut = experiment.cut(metric).any(axis=1)
    is_cut = tuple(any(cut[place] for place in group) for group in groups)
    rows[list(is_cut)] = math.nan  # values that the limit of time cut off have no mean
    counts = tuple(int(count) for count in (~np.isnan(rows)).sum(axis=1))
    found = Difference(metric, *what, NOTHING, math.nan, math.nan, math.nan, tuple(groups), counts, is_cut, None,
                       _sides(experiment, metric, groups))
    seen, used = intervals.known(rows.ravel()), np.array([count >= found.needed for count in counts])
    if not used.any():
        return _ordered(experiment, found)
    tables, rows, left = [table[used] for table in tables], rows[used], left[used]
    comparison = _compared(metric, tables, rows, left)
    base = np.where(np.isnan(rows), math.nan, tables[0])
    blocks = rows[:, ~np.isnan(rows).any(axis=0)].mean(axis=0)
    return found._replace(estimate=comparison.estimate, p=comparison.p,
                          is_everywhere=bool((np.sign(seen) == np.sign(comparison.estimate.value)).all()),
                          reference=float(np.mean([np.mean(intervals.known(row)) for row in base])),
                          median=intervals.median_estimate(blocks) if intervals.is_skewed(blocks) else None,
                          against=_against(metric, found.used, tables, rows, left, comparison.estimate.value))


def _ordered(experiment: Experiment, difference: Difference) -> Difference:
    """Return a Difference without a mean, together with the order of its values if that is known."""
    if not difference.is_cut or len(difference.sides) != len(difference.groups[0]) \
            or difference.metric.at_limit not in endings.BOUNDS:
        return difference
    tables, cuts = ([table[[group[side] for group in difference.groups]] for side in (0, 1)]
                    for table in (experiment.values(difference.metric), experiment.cut(difference.metric)))
    order = orders.order_of(tables, cuts, difference.groups)
    return difference if order is None else difference._replace(order=order, p=order.p)


def _against(metric: Metric, groups: Sequence[Group], tables: Sequence[np.ndarray], rows: np.ndarray,
             left: np.ndarray, value: float) -> Tuple[Tuple[Group, Estimate], ...]:
    """Return (group, Estimate) of the groups whose interval excludes 0 and whose sign is not that of all together."""
    if len(groups) < 2 or len(tables) != 2:
        return ()
    found = []
    for place, group in enumerate(groups):
        own = slice(place, place + 1)
        estimate = _compared(metric, [table[own] for table in tables], rows[own], left[own]).estimate
        if (estimate.low > 0.0 or estimate.high < 0.0) and (value == 0.0 or (estimate.value < 0.0) != (value < 0.0)):
            found.append((group, estimate))
    return tuple(found)


def _compared(metric: Metric, tables: Sequence[np.ndarray], rows: np.ndarray, left: np.ndarray) -> Comparison:
    """Return the Comparison of rows: by exact tests for shares, otherwise by Student's t.

    If at most half of the pairs differ, p is at least that of the test of signs. The t test alone would be too sure of
    the few pairs that differ: if four of thirty do, chance puts all of them on one side in one of eight cases.
    """
    if metric.is_share and len(tables) == 2:
        return intervals.share_differences(*tables)
    found = intervals.clustered(rows, left)
    seen = intervals.known(rows.ravel())
    if found.estimate.method != 't' or 2 * np.count_nonzero(seen) > len(seen):
        return found
    return found._replace(p=max(found.p, intervals.flip_test(np.sign(np.nansum(rows, axis=0)))))


def _sides(experiment: Experiment, metric: Metric, groups: Sequence[Group]) -> Tuple[Side, ...]:
    """Return the Sides (first, second) of groups; for an interaction those at the two levels of the other factor."""
    half = len(groups[0]) // 2
    parts = (slice(0, half), slice(half, None)) if half == 1 else (slice(half, None), slice(0, half))
    return tuple(_side(experiment, metric, {place for group in groups for place in group[part]}) for part in parts)


def _side(experiment: Experiment, metric: Metric, places: AbstractSet[int]) -> Side:
    """Return the Side of some configurations."""
    own = sorted(places)
    failed, complete = (int(experiment.count(status)[own].sum()) for status in (FAILED, COMPLETE))
    if metric.outcome:
        return Side(failed + complete, 0, 0, 0)
    without = complete - int((~np.isnan(experiment.values(metric)[own])).sum())
    return Side(failed + complete, failed, without, int(experiment.cut(metric)[own].sum()))


def _adjusted(differences: Sequence[Difference]) -> List[Difference]:
    """Return the Differences with Holm's probabilities.

    Those of the primary metric, if the experiment names one, are a family of their own; all others are one family.
    """
    found = list(differences)
    for is_primary in (True, False):
        places = [place for place, each in enumerate(differences) if each.metric.is_primary == is_primary]
        for place, p in zip(places, intervals.holm([differences[place].p for place in places])):
            found[place] = found[place]._replace(p_holm=p)
    return found


def levels_of(experiment: Experiment, metric: Metric, factor: int,
              fixed: Sequence[Tuple[int, int]] = ()) -> Tuple[List[Level], bool]:
    """Return the Levels of a factor that were run, and whether all are means over the same other levels.

    If possible, the means are over those combinations of the other factors in which every level has values.

    :param fixed: pairs (place of a factor, place of a level): only configurations with these levels count.
    """
    values = experiment.values(metric)
    there = (~np.isnan(values)).any(axis=1)
    groups: Dict[int, Dict[Levels, int]] = {}
    for each in experiment.configurations:
        own = each.levels[factor]
        if all(each.levels[other] == level for other, level in fixed) and own is not None:
            groups.setdefault(own, {})[_without(each.levels, (factor,))] = each.place
    common = [key for key in next(iter(groups.values()), {}) if all(key in group for group in groups.values())]
    common = [key for key in common if all(there[group[key]] for group in groups.values())]
    found = []
    for level, group in sorted(groups.items()):
        places = [group[key] for key in (common or group) if there[group[key]]]
        found.append(Level(level, _mean_of_rows(metric, values[places])))
    return found, bool(common) and all(len(group) == len(common) for group in groups.values())


def _mean_of_rows(metric: Metric, rows: np.ndarray) -> Estimate:
    if not len(rows):
        return NOTHING
    if metric.is_share and len(rows) == 1:
        return intervals.share_estimate(rows[0])
    mean = intervals.clustered(rows).estimate
    if metric.is_share and mean.has_interval:  # a mean of shares: Student's bounds may lie below 0 or above 1
        return mean._replace(low=max(0.0, mean.low), high=min(1.0, mean.high))
    return mean
