"""A comparison: its verdict, its one sentence, and what else its row in a table says.

The sentence has the difference, its interval and the number of pairs. The verdict is a word that these and the outcomes
of the trials justify. What the difference leaves out, and where it is the other way round, is in the row.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Sequence, Tuple

from .design import level_label
from .wording import NBSP, counted, digits, estimate_texts, probability, whole, with_interval

if TYPE_CHECKING:
    from .design import Metric
    from .effects import Difference, Group
    from .outcome import Experiment
    from .wording import Scale

#: verdict: (its words, its place among the findings: 0 and 1 are results)
VERDICTS = {
    'better': ('better', 0), 'worse': ('worse', 0), 'differs': ('differs', 0), 'mean': ('mean', 0),
    'survivors': ('of the complete', 1), 'part': ('in part', 1), 'average': ('on average', 1),
    'even': ('the same on average', 1), 'depends': ('depends', 1), 'always': ('in all pairs', 1),
    'order': ('by order', 1), 'cut': ('not compared', 2), 'small': ('may be negligible', 2), 'weak': ('too weak', 2),
    'negligible': ('negligible', 3), 'none': ('not told apart', 3), 'same': ('the same', 3),
    'untold': ('too few trials', 4), 'empty': ('no values', 4)}
LAST_RESULT = 1
#: the columns that a table of comparisons has if a row has something there
ASIDES = ('not in it', 'the other way round', 'without a value', 'ended by the limit', 'by order', 'median')
_AT_ONCE = {'constant': 'in every pair', 'fixed': 'the same in every replication'}
_MOST_LISTED = 6


def verdict_of(difference: Difference) -> str:
    """Return the verdict of an effects.Difference, a key of VERDICTS."""
    estimate, smallest = difference.estimate, difference.metric.smallest
    if difference.is_cut:
        return 'order' if difference.is_ordered else 'cut'
    if not estimate.has_interval:
        return 'untold' if estimate.n else 'empty'
    if estimate.method == 'constant' and estimate.value == 0.0:
        return 'same' if difference.is_everywhere else 'untold'
    if smallest and -smallest < estimate.low and estimate.high < smallest and _is_whole(difference):
        return 'negligible'
    if difference.is_shown:
        return _of_shown(difference)
    if estimate.method in _AT_ONCE:  # the same in each replication; the test of signs needs more of them
        return 'always' if difference.is_everywhere else 'untold' if estimate.value else 'even'
    return 'weak' if difference.is_hint else 'none'


def _is_whole(difference: Difference) -> bool:
    """Return whether a difference leaves nothing out and has an interval with a width."""
    return difference.estimate.method not in _AT_ONCE and not difference.against \
        and len(difference.used) == len(difference.groups) and not any(side.lacking for side in difference.sides)


def _of_shown(difference: Difference) -> str:
    estimate, metric = difference.estimate, difference.metric
    if difference.against:
        return 'average'
    if len(difference.used) < len(difference.groups):
        return 'part'
    if abs(estimate.value) < metric.smallest:
        return 'small'
    first, second = difference.sides
    if metric.better is None:
        return 'differs' if first.lacking == second.lacking == 0.0 else 'survivors'
    is_better = (estimate.value < 0.0) == (metric.better == 'lower')
    favoured, other = (second, first) if is_better else (first, second)
    if favoured.lacking > other.lacking:  # the better side has lost more trials, which may be the hard ones
        return 'survivors'
    return 'better' if is_better else 'worse'


# ---- the sentence ------------------------------------------------------------------------------------------------

def difference_scale(metric: Metric, scale: Scale) -> Scale:
    """Return the Scale for differences of a metric: differences of shares are in percentage points."""
    return scale._replace(unit='percentage points') if metric.is_share else scale


def names_of(experiment: Experiment, difference: Difference) -> Tuple[str, str]:
    """Return the labels of the two levels or configurations that are compared."""
    if difference.factor is None:
        return experiment.configurations[difference.first].label, experiment.configurations[difference.second].label
    return (level_label(experiment.factors, difference.factor, difference.first),
            level_label(experiment.factors, difference.factor, difference.second))


def at_text(experiment: Experiment, difference: Difference) -> str:
    """Return the levels of the other factors that are held fixed, in words."""
    return ', '.join(level_label(experiment.factors, place, level) for place, level in difference.at)


def sentence(experiment: Experiment, difference: Difference, scale: Scale) -> str:
    """Return the sentence about a Difference. ``scale``: the wording.Scale of its metric."""
    first, second = names_of(experiment, difference)
    at = at_text(experiment, difference)
    return f'{second} − {first}{f" (with {at})" if at else ""}: ' \
           f'{size_text(difference, difference_scale(difference.metric, scale))}.'


def size_text(difference: Difference, scale: Scale, noun: str = 'pairs') -> str:
    """Return '−12.0 s (−7.9 %; 95 % interval −12.7 to −11.2 s; 6 pairs)', or why there is no such figure."""
    estimate = difference.estimate
    if difference.is_cut:
        return 'the limit of time ended trials, so there is no mean' + (
            f'; {_order_text(difference)} (Holm p{NBSP}{probability(difference.p_holm)})' if difference.order else '')
    if not estimate.n:
        return 'no pair of complete trials has a value on both sides'
    value, low, high = estimate_texts(estimate, scale)
    interval = _AT_ONCE.get(estimate.method, f'95 % interval {low} to {high}{scale.suffix}') \
        if estimate.has_interval else 'no interval, so this says nothing about other seeds'
    inside = (_share_text(difference), interval, pairs_text(difference, noun))
    return f'{value}{scale.suffix} ({"; ".join(filter(None, inside))})'


def _share_text(difference: Difference) -> str:
    """Return the difference in per cent of the first side, '' where that says nothing."""
    value, reference = difference.estimate.value, difference.reference
    if difference.metric.is_share or value == 0.0 or not 0.0 < reference + value <= 11.0 * reference:
        return ''
    return f'{digits(100.0 * value / reference, 2)}{NBSP}%'


def pairs_text(difference: Difference, noun: str = 'pairs') -> str:
    """Return '30 pairs', or if several combinations are averaged '5 to 30 pairs with each'."""
    if len(difference.used) < 2:
        return counted(difference.estimate.n, noun)
    counts = [count for count in difference.counts if count >= difference.needed]
    least, most = min(counts), max(counts)
    each = counted(most, noun) if least == most else f'{whole(least)} to {whole(most)} {noun}'
    return f'{each} with each'


def _order_text(difference: Difference) -> str:
    order = difference.order
    assert order is not None
    return f'larger in {whole(order.larger)}, smaller in {whole(order.smaller)} of {counted(order.known, "pairs")}'


# ---- the row ------------------------------------------------------------------------------------------------------

def asides(experiment: Experiment, difference: Difference, scale: Scale) -> Dict[str, str]:
    """Return {one of ASIDES: text} of a Difference, of those that have something to say."""
    found = {'not in it': _left_out(experiment, difference),
             'the other way round': '; '.join(f'{groups_text(experiment, difference, [group])}: '
                                              f'{with_interval(estimate, scale)}'
                                              for group, estimate in difference.against),
             'without a value': _of_sides(difference, 'failed', 'without'),
             'ended by the limit': _of_sides(difference, 'cut')}
    if difference.order is not None:
        turned = f'; turned in {groups_text(experiment, difference, difference.order.against)}' \
            if difference.order.against else ''
        found['by order'] = f'{_order_text(difference)}; {whole(difference.order.unknown)} unknown{turned}'
    if difference.median is not None:
        found['median'] = with_interval(difference.median, scale._replace(unit=''))
    return {name: text for name, text in found.items() if text}


def _left_out(experiment: Experiment, difference: Difference) -> str:
    """Return the combinations of the other factors of which a difference says nothing, and why."""
    texts: Dict[str, List[Group]] = {}
    for group, count, is_cut in zip(difference.groups, difference.counts, difference.cut):
        if count < difference.needed or not difference.used:
            why = 'limit of time' if is_cut else 'too few pairs' if count else 'no pairs'
            texts.setdefault(why, []).append(group)
    if len(difference.groups) < 2:
        return ''
    return '; '.join(f'{groups_text(experiment, difference, groups)} ({why})' for why, groups in texts.items())


def _of_sides(difference: Difference, *counts: str) -> str:
    """Return '0 of 30 and 10 of 30', of the first and the second side; '' if both are 0."""
    sums = [sum(getattr(side, what) for what in counts) for side in difference.sides]
    return ' and '.join(f'{whole(count)} of {whole(side.run)}' for count, side in zip(sums, difference.sides)) \
        if any(sums) else ''


def groups_text(experiment: Experiment, difference: Difference, groups: Sequence[Group]) -> str:
    """Return groups of configurations in words, by the factors that are not compared."""
    varied = [place for place in range(len(experiment.factors)) if place != difference.factor
              and len({each.levels[place] for each in experiment.configurations}) > 1]
    labels = []
    for group in groups[:_MOST_LISTED]:
        levels = experiment.configurations[group[0]].levels
        labels.append(' '.join(level_label(experiment.factors, place, level) for place, level in enumerate(levels)
                               if place in varied and level is not None))
    more = f' and {whole(len(groups) - len(labels))} more' if len(groups) > len(labels) else ''
    return ', '.join(labels) + more

