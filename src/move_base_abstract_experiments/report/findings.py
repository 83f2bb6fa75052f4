"""The findings: one sentence for each comparison, with its verdict and a little picture."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import design, effects, endings, intervals, orders
from .comparisons import LAST_RESULT, VERDICTS, difference_scale, names_of, sentence, size_text, verdict_of
from .intervals import Estimate
from .outcome import FAILED
from .wording import EXACT_DIGITS, counted, digits, whole, with_interval

if TYPE_CHECKING:
    from .design import Metric
    from .effects import Difference
    from .outcome import Experiment
    from .wording import Scale

MOST_TOLD = 12  # the number of comparisons of one factor that are findings; all are in the tables


class Finding(NamedTuple):
    """A finding about a metric, in a sentence."""

    metric: str  # its title
    verdict: str  # a key of VERDICTS
    text: str
    mini: object  # (zero, low, mid, high) in per cent of the little picture, or None
    is_primary: bool = False

    @property
    def verdict_text(self) -> str:
        """The verdict in words."""
        return VERDICTS[self.verdict][0]

    @property
    def is_result(self) -> bool:
        """Whether it says that something differs, or gives a mean without any comparison."""
        return VERDICTS[self.verdict][1] <= LAST_RESULT


def findings(experiment: Experiment, scales: Mapping[str, Scale], mains: Sequence[Difference],
             singles: Sequence[Difference], changes: Sequence[Difference]) -> List[Finding]:
    """Return the Findings. Within each metric, differences come first.

    :param scales: metric name: wording.Scale. :param mains, singles, changes: effects.main_effects, single_differences
        and interactions of the experiment.
    """
    found = []
    for metric in experiment.metrics:
        scale = scales[metric.name]
        if is_constant(experiment, metric):
            told = [Finding(metric.title, 'same', constant_text(experiment, metric, scale), None)]
        else:
            told = of_differences(experiment, effects.of_metric(metric, mains, singles), scale)
            told += [_change(experiment, each, scale) for each in _strongest(changes, metric)]
            told = told or _means(experiment, metric, scale)
        found += [each._replace(is_primary=metric.is_primary)
                  for each in sorted(told, key=lambda finding: VERDICTS[finding.verdict][1])]
    return found


def is_constant(experiment: Experiment, metric: Metric) -> bool:
    """Return whether a metric is the same in all trials of all configurations, of which there are several."""
    values = experiment.values(metric)
    has_all = len(values) > 1 and not np.isnan(values).all(axis=1).any() and not experiment.cut(metric).any()
    return has_all and intervals.mean_and_sd(intervals.known(values))[1] == 0.0


def constant_text(experiment: Experiment, metric: Metric, scale: Scale) -> str:
    """Return the sentence about a metric that is the same in all trials."""
    values = intervals.known(experiment.values(metric))
    count = 'trials' if len(values) == len(experiment.trials) else 'trials that have a value,'
    return f'{digits(float(values[0]) * scale.factor, EXACT_DIGITS)}{scale.suffix} in all ' \
           f'{whole(len(values))} {count} of all configurations.'


def of_differences(experiment: Experiment, differences: Sequence[Difference], scale: Scale) -> List[Finding]:
    """Return the Findings of one metric's Differences between levels, or between configurations."""
    told = []
    for factor in dict.fromkeys(each.factor for each in differences):
        own = [each for each in differences if each.factor == factor]
        told += [Finding(each.metric.title, verdict_of(each), sentence(experiment, each, scale), _mini(each, own))
                 for each in _chosen(experiment, factor, own)]
    return told


def _chosen(experiment: Experiment, factor: Optional[int], own: Sequence[Difference]) -> Sequence[Difference]:
    """Return the Differences of a factor that are told: with the baseline, or else of the best level with each other.

    The best level comes second, so that the others are subtracted from it. If no level leads all others, or if whole
    configurations are compared, the first ones are told.
    """
    baseline = None if factor is None else design.baseline_of(experiment.plan, experiment.factors[factor])
    if baseline is not None:
        own = [turned(each) if each.second == baseline else each for each in own
               if baseline in (each.first, each.second)]
    elif factor is not None and len(own) > 1:
        own = _leads(own) or own
    return own[:MOST_TOLD]


def turned(difference: Difference) -> Difference:
    """Return a Difference with first and second exchanged."""
    estimate, median = _negative(difference.estimate), difference.median
    return difference._replace(
        first=difference.second, second=difference.first, estimate=estimate, sides=difference.sides[::-1],
        reference=difference.reference + difference.estimate.value,
        groups=tuple(each[::-1] for each in difference.groups), median=None if median is None else _negative(median),
        against=tuple((group[::-1], _negative(each)) for group, each in difference.against),
        order=orders.turned(difference.order))


def _negative(estimate: Estimate) -> Estimate:
    return Estimate(-estimate.value or 0.0, -estimate.high or 0.0, -estimate.low or 0.0, *estimate[3:])


def _leads(own: Sequence[Difference]) -> Optional[List[Difference]]:
    """Return the Differences of the best level with each other one, in which it is the second: the smallest lead first.

    The best level is the one whose smallest lead is the largest; of equal ones the first. If neither side is better,
    it is the lowest. Those without a mean come last. None if no level leads all that it is compared with.
    """
    sign = 1.0 if own[0].metric.better == 'higher' else -1.0
    sides: Dict[int, List[Difference]] = {}
    leads: Dict[int, List[Difference]] = {}
    for each in own:
        sides.setdefault(each.second, []).append(each)
        sides.setdefault(each.first, []).append(turned(each))
    for level, found in sides.items():
        leads[level] = sorted((each for each in found if not math.isnan(each.estimate.value)),
                              key=lambda each: (sign * each.estimate.value, each.first))
    most = max(map(len, leads.values()))  # a level with fewer comparisons cannot be the best of all
    level = max((level for level, found in leads.items() if len(found) == most),
                key=lambda level: (sign * leads[level][0].estimate.value if most else 0.0, -level))
    if not most or sign * leads[level][0].estimate.value < 0.0:
        return None
    return [*leads[level], *(each for each in sides[level] if math.isnan(each.estimate.value))]


def _strongest(changes: Sequence[Difference], metric: Metric) -> List[Difference]:
    """Return for each pair of factors the interaction with the smallest Holm p, if any is shown."""
    best: Dict[Any, Difference] = {}
    for each in changes:
        key = each.factor, each.at[0][0]
        if each.metric is metric and each.is_shown and (key not in best or each.p_holm < best[key].p_holm):
            best[key] = each
    return list(best.values())


def _change(experiment: Experiment, difference: Difference, scale: Scale) -> Finding:
    """Return the Finding of an interaction."""
    first, second = (design.level_label(experiment.factors, *place) for place in difference.at)
    a, b = names_of(experiment, difference)
    scale = difference_scale(difference.metric, scale)
    size = size_text(difference._replace(reference=math.nan), scale, 'replications')
    return Finding(difference.metric.title, 'depends',
                   f'{b} − {a} depends on {experiment.factors[difference.at[0][0]].title}: with {second} minus with '
                   f'{first} it is {size}.', None)


def _means(experiment: Experiment, metric: Metric, scale: Scale) -> List[Finding]:
    """Return the Findings of a metric without any comparison: its means."""
    told = []
    for place, (configuration, estimate) in enumerate(zip(experiment.configurations,
                                                          effects.summary(experiment, metric))):
        where = f'{configuration.label}: ' if len(experiment.configurations) > 1 else ''
        failed = int(experiment.count(FAILED)[place])
        lost = f', {whole(failed)} more failed' if failed else ''
        if estimate.method == 'cut':
            verdict, text = 'cut', _cut_text(experiment, metric, place)
        elif not estimate.n:
            verdict, text = 'empty', 'no complete trial has a value'
        else:
            verdict = 'mean' if estimate.n > 1 else 'untold'
            text = f'{with_interval(estimate, scale)}, {counted(estimate.n, "trials")}'
        told.append(Finding(metric.title, verdict, f'{where}{text}{lost}.', None))
    return told


def _cut_text(experiment: Experiment, metric: Metric, place: int) -> str:
    """Return the words that say why a configuration has no mean of a metric. ``place``: the configuration's place."""
    cut, seen = int(experiment.cut(metric)[place].sum()), len(intervals.known(experiment.values(metric)[place]))
    bounds = 'their values are lower bounds' if metric.at_limit in endings.BOUNDS else \
        'what their values would have become is not known'
    return f'no mean: the limit of time ended {whole(cut)} of {counted(seen, "trials")}; {bounds}'


def _mini(difference: Difference, family: Sequence[Difference]) -> Optional[Tuple[float, ...]]:
    """Return where zero, the low end, the difference and the high end lie in its picture, in per cent of the width.

    All differences of a family have the same scale. None if the difference has no interval.
    """
    estimate = difference.estimate
    bounds = [abs(bound) for each in family for bound in each.estimate[:3] if not math.isnan(bound)]
    largest = max(bounds, default=0.0)
    if not estimate.has_interval or largest == 0.0:
        return None
    return tuple(round(50.0 + 46.0 * value / largest, 2)
                 for value in (0.0, estimate.low, estimate.value, estimate.high))
