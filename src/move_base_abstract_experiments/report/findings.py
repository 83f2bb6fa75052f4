"""The findings in words, each with its interval: what differs, and what no difference can be shown for."""

import math
from typing import NamedTuple

import numpy as np

from . import effects, intervals
from .design import level_label
from .intervals import Estimate
from .wording import EXACT_DIGITS, NBSP, counted, digits, estimate_texts, probability, with_interval

MAX_LEVELS = 3  # of a factor of words, whose levels are all compared; of more, and of numbers, two are
#: verdict: what stands before the sentence
VERDICTS = {'better': 'better', 'worse': 'worse', 'differs': 'differs', 'depends': 'depends', 'weak': 'too weak',
            'always': 'in all pairs', 'none': 'not shown', 'same': 'the same', 'untold': 'too few trials',
            'mean': 'mean'}
_ORDER = {'better': 0, 'worse': 0, 'differs': 0, 'mean': 0, 'depends': 1, 'always': 1, 'weak': 2, 'none': 3, 'same': 3,
          'untold': 4}


class Finding(NamedTuple):
    """What is found about a metric, in a sentence or two."""

    metric: str  # its title
    verdict: str  # a key of VERDICTS
    text: str
    mini: object  # (zero, low, mid, high) in per cent of the little picture, or None

    @property
    def verdict_text(self):
        """The verdict in words."""
        return VERDICTS[self.verdict]

    @property
    def is_result(self):
        """Whether it says that something differs."""
        return _ORDER[self.verdict] < 2


def findings(experiment, scales, mains, singles, changes):
    """Return the Findings, what differs first within each metric.

    :param scales: metric name: wording.Scale. :param mains, singles, changes: effects.main_effects, single_differences
        and interactions of the experiment.
    """
    found = []
    for metric in experiment.metrics:
        scale = scales[metric.name]
        if is_constant(experiment, metric):
            found.append(Finding(metric.title, 'same', _sentence_case(constant_text(experiment, metric, scale)), None))
            continue
        own = [each for each in mains if each.metric is metric] or [each for each in singles if each.metric is metric]
        told = [_comparison(experiment, each, scale, own) for each in _selected(experiment, own)]
        told += [_change(experiment, each, scale) for each in _strongest(changes, metric)]
        if not told:
            told = _means(experiment, metric, scale)
        found += sorted(told, key=lambda finding: _ORDER[finding.verdict])
    return found


def is_constant(experiment, metric):
    """Return whether a metric is the same in all trials of all configurations, of which there are several."""
    values = experiment.values(metric.name)
    has_all = len(values) > 1 and not np.isnan(values).all(axis=1).any()
    return has_all and intervals.mean_and_sd(intervals.known(values))[1] == 0.0


def constant_text(experiment, metric, scale):
    """Return what is to be said about such a metric."""
    values = intervals.known(experiment.values(metric.name))
    return f'{digits(float(values[0]) * scale.factor, EXACT_DIGITS)}{scale.suffix} in all ' \
           f'{counted(len(values), "trials")} of all configurations.'


def _selected(experiment, differences):
    """Return the Differences that are told: of numbers the ends, of many words the extremes, of few all."""
    told = []
    for factor in dict.fromkeys(each.factor for each in differences):
        own = [each for each in differences if each.factor == factor]
        if factor is not None and experiment.factors[factor].is_numeric:
            told.append(max(own, key=lambda each: each.second - each.first))
        elif factor is None or len(experiment.factors[factor].levels) <= MAX_LEVELS:
            told += own[:MAX_LEVELS * MAX_LEVELS]
        else:
            told.append(max(own, key=lambda each: (abs(each.estimate.value), -each.first, -each.second)
                            if each.estimate.n else (-1.0, 0, 0)))
    return told


def _strongest(changes, metric):
    """Return of each pair of factors the change that is shown best, if one is."""
    best = {}
    for each in changes:
        key = each.factor, each.at[0][0]
        if each.metric is metric and each.is_shown and (key not in best or each.p_holm < best[key].p_holm):
            best[key] = each
    return list(best.values())


def names_of(experiment, difference):
    """Return the texts of what is compared, first and second."""
    if difference.factor is None:
        return tuple(experiment.configurations[place].label for place in (difference.first, difference.second))
    return tuple(level_label(experiment.factors, difference.factor, level)
                 for level in (difference.first, difference.second))


def at_text(experiment, difference):
    """Return what is held fixed, in words."""
    return ', '.join(level_label(experiment.factors, place, level) for place, level in difference.at)


def difference_scale(metric, scale):
    """Return the Scale of differences of a metric: shares differ by percentage points."""
    return scale._replace(unit='percentage points') if metric.is_share else scale


def verdict_of(difference):
    """Return what a Difference says, a key of VERDICTS."""
    estimate = difference.estimate
    if estimate.n < 2:
        return 'untold'
    if estimate.value == 0.0 and estimate.method == 'constant':
        return 'same'
    if difference.is_shown:
        if difference.metric.better is None:
            return 'differs'
        return 'better' if (estimate.value < 0.0) == (difference.metric.better == 'lower') else 'worse'
    if estimate.method == 'constant':  # what was seen is told as it is; the test of signs has no more to say
        return 'always'
    return 'weak' if difference.is_hint else 'none'


def _comparison(experiment, difference, scale, family):
    """Return the Finding of a Difference."""
    scale = difference_scale(difference.metric, scale)
    first, second = names_of(experiment, difference)
    verdict = verdict_of(difference)
    text = _sentence(difference, scale, first, second, verdict)
    if difference.median is not None and verdict != 'same':
        text += f' The differences are skewed; their median is {with_interval(difference.median, scale)}.'
    own = [each for each in family if each.factor == difference.factor]
    if verdict not in ('same', 'untold') and len(own) > len(_selected(experiment, own)):
        shown = sum(each.is_shown for each in own)
        which = {0: f'None of the {len(own)} pairs of levels differs',
                 1: f'Of the {len(own)} pairs of levels one differs',
                 len(own): f'All {len(own)} pairs of levels differ'}
        text += f' {which.get(shown, f"Of the {len(own)} pairs of levels {shown} differ")}.'
    return Finding(difference.metric.title, verdict, _sentence_case(text), _mini(difference, own))


def _sentence(difference, scale, first, second, verdict):
    estimate = difference.estimate
    pairs = counted(estimate.n, 'pairs')
    value, low, high = estimate_texts(estimate, scale)
    if estimate.n == 0:
        return f'no pair of complete trials of {second} and {first} has a value on both sides.'
    if verdict == 'untold':
        only = f'{_amount(difference, scale)[0]} with {second} than with {first}' if estimate.value else \
            f'the same with {second} and {first}'
        return f'{only} in the only pair; no interval, so that nothing is said about other seeds.'
    if verdict == 'same':
        return f'the same with {second} and {first} in all {pairs}.'
    if verdict in ('better', 'worse', 'differs', 'always'):
        amount, interval = _amount(difference, scale)
        return f'{amount} with {second} than with {first} ({interval}; {pairs}).'
    numbers = f'{value}{scale.suffix}, 95 % interval {low} to {high}{scale.suffix}'
    if verdict == 'weak':
        return f'too weak to count among so many comparisons (Holm p{NBSP}{probability(difference.p_holm)}): ' \
               f'{second} − {first} is {numbers} ({pairs}).'
    return f'no difference that {pairs} can show between {second} and {first}: {numbers}.'


def _amount(difference, scale):
    """Return '12 s (8 %) lower' and the words of its interval, in amounts of the same direction."""
    estimate = difference.estimate
    is_lower = estimate.value < 0.0
    size = Estimate(-estimate.value, -estimate.high, -estimate.low, *estimate[3:]) if is_lower else estimate
    value, low, high = estimate_texts(size, scale)
    share = ''
    if difference.reference > 0.0 and difference.reference + estimate.value > 0.0 and not difference.metric.is_share \
            and size.value <= 10.0 * difference.reference:
        share = f' ({digits(100.0 * size.value / difference.reference, 2)} %)'
    amount = f'{value}{scale.suffix}{share} {"lower" if is_lower else "higher"}'
    return amount, 'in every pair' if low == high else f'95 % interval {low} to {high}{scale.suffix}'


def _change(experiment, difference, scale):
    """Return the Finding of an interaction."""
    scale = difference_scale(difference.metric, scale)
    first, second = names_of(experiment, difference)
    places = [level_label(experiment.factors, *each) for each in difference.at]
    amount, interval = _amount(difference._replace(reference=math.nan), scale)
    text = f'What {second} changes against {first} depends on ' \
           f'{experiment.factors[difference.at[0][0]].title}: the difference is {amount} with {places[1]} than with ' \
           f'{places[0]} ({interval}; {counted(difference.estimate.n, "replications")}).'
    return Finding(difference.metric.title, 'depends', text, None)


def _means(experiment, metric, scale):
    """Return the Findings of a metric of which nothing can be compared: its means."""
    told = []
    for configuration, estimate in zip(experiment.configurations, effects.summary(experiment, metric)):
        where = f' with {configuration.label}' if len(experiment.configurations) > 1 else ''
        value, low, high = estimate_texts(estimate, scale)
        if not estimate.n:
            text = f'no complete trial{where} has a value.'
        elif not estimate.has_interval:
            text = f'{value}{scale.suffix}{where}, one trial; no interval, so that nothing is said about other seeds.'
        elif estimate.method == 'constant':
            text = f'{value}{scale.suffix}{where} in all {counted(estimate.n, "trials")}.'
        else:
            text = f'{value}{scale.suffix}{where} (95 % interval {low} to {high}{scale.suffix}; ' \
                   f'{counted(estimate.n, "trials")}).'
        told.append(Finding(metric.title, 'mean' if estimate.n > 1 else 'untold', _sentence_case(text), None))
    return told


def _sentence_case(text):
    return text[:1].upper() + text[1:]


def _mini(difference, family):
    """Return where zero, the difference and its interval lie in a picture that all of a family share, in per cent."""
    estimate = difference.estimate
    bounds = [abs(bound) for each in family for bound in each.estimate[:3] if not math.isnan(bound)]
    largest = max(bounds, default=0.0)
    if not estimate.has_interval or largest == 0.0:
        return None
    return tuple(round(50.0 + 46.0 * value / largest, 2)
                 for value in (0.0, estimate.low, estimate.value, estimate.high))
