"""The findings in words, each with its interval: the differences, and the levels that are not told apart."""

import math
from typing import NamedTuple

import numpy as np

from . import design, effects, endings, intervals
from .outcome import FAILED
from .phrases import amount, some, than_with_level, with_level
from .ranking import ranking, turned
from .sentences import difference_scale, pairs_text, sentence, sentence_case, some_sentences, spoken
from .verdicts import ORDER, VERDICTS, is_result, verdict_of
from .wording import EXACT_DIGITS, counted, digits, estimate_texts, whole

FEW_LEVELS = 2  # so many levels are compared with one another; if there are more, the best one is named
MOST_WITH_BASELINE = 12  # the number of levels that sentences compare with the baseline


class Finding(NamedTuple):
    """A finding about a metric, in one or more sentences."""

    metric: str  # its title
    verdict: str  # a key of VERDICTS
    text: str
    mini: object  # (zero, low, mid, high) in per cent of the little picture, or None
    is_primary: bool = False

    @property
    def verdict_text(self):
        """The verdict in words."""
        return VERDICTS[self.verdict]

    @property
    def is_result(self):
        """Whether it says that something differs, or gives a mean without any comparison."""
        return is_result(self.verdict)


def findings(experiment, scales, mains, singles, changes):
    """Return the Findings. Within each metric, differences come first.

    :param scales: metric name: wording.Scale. :param mains, singles, changes: effects.main_effects, single_differences
        and interactions of the experiment.
    """
    found = []
    for metric in experiment.metrics:
        scale = scales[metric.name]
        if is_constant(experiment, metric):
            told = [Finding(metric.title, 'same', sentence_case(constant_text(experiment, metric, scale)), None)]
        else:
            own = [[each for each in kind if each.metric is metric] for kind in (mains, singles)]
            own = own[0] or own[1]
            told = [one for factor in dict.fromkeys(each.factor for each in own)
                    for one in _of_factor(experiment, factor, [each for each in own if each.factor == factor], scale)]
            told += [_change(experiment, each, scale) for each in _strongest(changes, metric)]
            told = told or _means(experiment, metric, scale)
        found += [each._replace(is_primary=metric.is_primary)
                  for each in sorted(told, key=lambda finding: ORDER[finding.verdict])]
    return found


def is_constant(experiment, metric):
    """Return whether a metric is the same in all trials of all configurations, of which there are several."""
    values = experiment.values(metric)
    has_all = len(values) > 1 and not np.isnan(values).all(axis=1).any() and not experiment.cut(metric).any()
    return has_all and intervals.mean_and_sd(intervals.known(values))[1] == 0.0


def constant_text(experiment, metric, scale):
    """Return the sentence about a metric that is the same in all trials."""
    values = intervals.known(experiment.values(metric))
    count = 'trials' if len(values) == len(experiment.trials) else 'trials that have a value,'
    return f'{digits(float(values[0]) * scale.factor, EXACT_DIGITS)}{scale.suffix} in all ' \
           f'{whole(len(values))} {count} of all configurations.'


def _of_factor(experiment, factor, own, scale):
    """Return the Findings of one factor: comparisons with the baseline, and the best of more than two levels."""
    if factor is None:
        return [_comparison(experiment, each, scale, own) for each in own[:effects.ALL_PAIRS]]
    baseline = design.baseline_of(experiment.plan, experiment.factors[factor])
    told = []
    if baseline is not None:
        against = [turned(each) if each.second == baseline else each for each in own
                   if baseline in (each.first, each.second)]
        told = [_comparison(experiment, each, scale, own, 'the baseline') for each in against[:MOST_WITH_BASELINE]]
    if len({level for each in own for level in (each.first, each.second)}) <= FEW_LEVELS:
        return told or [_comparison(experiment, each, scale, own) for each in own]
    best = _best(experiment, own, scale)
    return [best, *told] if best else [_comparison(experiment, each, scale, own) for each in own[:effects.ALL_PAIRS]]


def _comparison(experiment, difference, scale, family, aside=''):
    """Return the Finding of a Difference."""
    return Finding(difference.metric.title, verdict_of(difference),
                   sentence_case(sentence(experiment, difference, scale, aside)), _mini(difference, family))


def _best(experiment, own, scale):
    """Return the Finding that names the best of several levels, and by how much it leads.

    None if no level leads all that it is compared with: the means of its pairs are over other trials each time.
    """
    metric = own[0].metric
    found = ranking(own, metric.better)
    if found is None:
        return _by_order(experiment, own, scale)
    lead = found.leads[0]
    if lead.estimate.value * (-1.0 if metric.better == 'higher' else 1.0) > 0.0:
        return None
    by_verdict = {}
    for each in found.leads:
        by_verdict.setdefault(verdict_of(each), []).append(each)
    alone = _not_compared(experiment, own, found, scale)
    is_best = set(by_verdict) <= {'better', 'differs'} and not alone
    superlative = 'best' if metric.better and is_best else 'highest' if metric.better == 'higher' else 'lowest'
    name = with_level(experiment.factors, lead.factor, found.level)
    text = sentence(experiment, lead, scale, f'the second {superlative}')
    if verdict_of(lead) == 'same':
        verdict = 'same'
    elif is_best:
        verdict, text = 'best' if metric.better else 'differs', f'{superlative} with {name}: {text}'
    else:
        verdict, text = verdict_of(lead), f'{superlative} in these trials with {name}. {sentence_case(text)}'
        if set(by_verdict) & {'better', 'differs'}:
            verdict = 'part' if alone else 'among' if metric.better else 'differs'
    for key, leads in by_verdict.items():
        text += _others(experiment, key, [each for each in leads if each is not lead], scale)
    return Finding(metric.title, verdict, sentence_case(text + alone), _mini(lead, own))


def _by_order(experiment, own, scale):
    """Return the Finding about several levels of which no means can be compared: what the order of values shows."""
    shown = [each for each in own if each.is_ordered] or [next((each for each in own if each.is_cut), own[0])]
    text = some_sentences(sentence(experiment, each, scale) for each in shown)
    return Finding(own[0].metric.title, verdict_of(shown[0]), text, None)


def _not_compared(experiment, own, found, scale):
    """Return the sentences about levels with which the best one could not be compared, '' if there are none."""
    levels = {level: each for each in own for level in (each.first, each.second)}
    rest = sorted({*levels} - {found.level} - {each.first for each in found.leads})
    if not rest:
        return ''
    names = some(with_level(experiment.factors, own[0].factor, level) for level in rest)
    why = 'the limit of time ended trials' if all(levels[level].is_cut for level in rest) else \
        'no two trials of one seed have a value on both sides'
    shown = [each for each in own if each.is_ordered and found.level in (each.first, each.second)]
    ordered = some_sentences(sentence(experiment, each, scale) for each in shown)
    return f' Its mean could not be compared with {names}: {why}.{ordered and " "}{ordered}'


_OTHERS = {'better': 'It is better than', 'differs': 'It is lower than', 'none': 'It is not told apart from',
           'weak': 'A difference that is too weak to count separates it from', 'same': 'It is the same as',
           'negligible': 'At most a negligible difference separates it from',
           'part': 'In the combinations that can be compared it is ahead of',
           'survivors': 'Among complete trials it is ahead of', 'average': 'On average it is ahead of',
           'even': 'On average it is the same as', 'always': 'In too few pairs for a test it is ahead of',
           'small': 'A difference that may be negligible separates it from'}


def _others(experiment, verdict, leads, scale):
    """Return the sentence that compares the best level with those levels that have the same verdict."""
    if not leads or verdict in ('untold', 'empty'):
        return ''
    texts = []
    for each in leads:
        size, interval = amount(each.estimate, difference_scale(each.metric, scale))
        name = than_with_level(experiment.factors, each.factor, each.first)
        texts.append(name if verdict == 'same' or not each.estimate.has_interval else f'{name} ({size}, {interval})')
    return f' {_OTHERS[verdict]} {some(texts)}.'


def _strongest(changes, metric):
    """Return for each pair of factors the interaction with the smallest Holm p, if any is shown."""
    best = {}
    for each in changes:
        key = each.factor, each.at[0][0]
        if each.metric is metric and each.is_shown and (key not in best or each.p_holm < best[key].p_holm):
            best[key] = each
    return list(best.values())


def _change(experiment, difference, scale):
    """Return the Finding of an interaction."""
    scale = difference_scale(difference.metric, scale)
    first, second, than = spoken(experiment, difference)
    other = difference.at[0][0]
    size, interval = amount(difference.estimate, scale, is_change=True)
    here = with_level(experiment.factors, *difference.at[1]), than_with_level(experiment.factors, *difference.at[0])
    over = f', on average over {counted(len(difference.used), "combinations")} of the other factors' \
        if len(difference.used) > 1 else ''
    text = f'The difference {second} − {than} depends on {experiment.factors[other].title}: it is {size} with ' \
           f'{here[0]} than with {here[1]}{over} ({interval}; {pairs_text(difference, "replications")}).'
    if len(difference.used) < len(difference.groups):
        out = len(difference.groups) - len(difference.used)
        text += f' It says nothing of {whole(out)} of {counted(len(difference.groups), "combinations")} of the other ' \
                'factors: values are missing or cut off.'
    if any(side.lacking for side in difference.sides):
        text += ' Only complete trials count.'
    return Finding(difference.metric.title, 'depends', text, None)


def _means(experiment, metric, scale):
    """Return the Findings of a metric without any comparison: its means."""
    told = []
    for place, (configuration, estimate) in enumerate(zip(experiment.configurations,
                                                          effects.summary(experiment, metric))):
        where = f' with {configuration.label}' if len(experiment.configurations) > 1 else ''
        failed = int(experiment.count(FAILED)[place])
        lost = f' {whole(failed)} more failed.' if failed else ''
        value, low, high = estimate_texts(estimate, scale)
        verdict = 'mean' if estimate.n > 1 else 'untold' if estimate.n else 'empty'
        if not estimate.n:
            text = f'no complete trial{where} has a value.'
        elif estimate.method == 'cut':
            verdict = 'cut'
            text = cut_text(experiment, metric, place, where)
        elif not estimate.has_interval:
            text = f'{value}{scale.suffix}{where}, one trial; no interval, so this says nothing about other seeds.'
        elif estimate.method == 'constant':
            text = f'{value}{scale.suffix}{where} in all {counted(estimate.n, "trials")}.'
        else:
            text = f'{value}{scale.suffix}{where} (95 % interval {low} to {high}{scale.suffix}; ' \
                   f'{counted(estimate.n, "trials")}).'
        told.append(Finding(metric.title, verdict, sentence_case(text) + lost, None))
    return told


def cut_text(experiment, metric, place, where=''):
    """Return the words that say why a configuration has no mean of a metric. ``place``: the configuration's place."""
    cut, seen = int(experiment.cut(metric)[place].sum()), len(intervals.known(experiment.values(metric)[place]))
    bounds = 'their values are lower bounds' if metric.at_limit in endings.BOUNDS else \
        'what their values would have become is not known'
    return f'no mean{where}: the limit of time ended {whole(cut)} of {counted(seen, "trials")}; {bounds}.'


def _mini(difference, family):
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
