"""Comparisons as sentences: which difference, how large, averaged over what, from how many trials, what is left out."""

from . import endings, intervals
from .design import level_label
from .phrases import amount, between, is_noun, levels_listed, some, than_with_level, with_level
from .verdicts import verdict_of
from .wording import NBSP, counted, digits, estimate_texts, listed, probability, whole, with_interval


def difference_scale(metric, scale):
    """Return the Scale for differences of a metric: differences of shares are in percentage points."""
    return scale._replace(unit='percentage points') if metric.is_share else scale


def names_of(experiment, difference):
    """Return the labels of the two levels or configurations that are compared, as tables have them."""
    if difference.factor is None:
        return tuple(experiment.configurations[place].label for place in (difference.first, difference.second))
    return tuple(level_label(experiment.factors, difference.factor, level)
                 for level in (difference.first, difference.second))


def spoken(experiment, difference):
    """Return (first, second, first as it follows 'than with') in the words of sentences."""
    if difference.factor is None:
        first, second = names_of(experiment, difference)
        return first, second, first
    about = experiment.factors, difference.factor
    return with_level(*about, difference.first), with_level(*about, difference.second), \
        than_with_level(*about, difference.first)


def at_text(experiment, difference):
    """Return the levels of the other factors that are held fixed, in words."""
    return ', '.join(level_label(experiment.factors, place, level) for place, level in difference.at)


def sentence_case(text):
    """Return a text with a capital letter at its beginning."""
    return text[:1].upper() + text[1:]


def some_sentences(texts, most=6):
    """Return texts as sentences; if there are many, the first ones and the number of the others."""
    texts = [sentence_case(text) for text in texts]
    more = f' {whole(len(texts) - most)} more are in the tables.' if len(texts) > most else ''
    return ' '.join(texts[:most]) + more


def sentence(experiment, difference, scale, aside=''):
    """Return one or more sentences about a Difference. ``aside``: words that follow the first one's name, or ''."""
    scale = difference_scale(difference.metric, scale)
    verdict = verdict_of(difference)
    first, second, than = spoken(experiment, difference)
    words = _WORDS.get(verdict, _amount)(experiment, difference, scale, (first, second, than, aside))
    if verdict == 'empty':
        return words
    return words + _rest(experiment, difference, scale, verdict)


def _amount(experiment, difference, scale, names):
    first, second, than, aside = names
    size, interval = amount(difference.estimate, scale,
                            float('nan') if difference.metric.is_share else difference.reference)
    is_same = difference.estimate.value == 0.0
    only = _only(experiment, difference)
    over = over_text(experiment, difference)
    aside = f', {aside}' if aside else ''
    size = f'the same with {second} as' if is_same else f'{size} with {second} than'
    return f'{only}{size} with {than}{aside}{over} ' \
           f'({interval}; {pairs_text(difference)}).'


def _none(experiment, difference, scale, names):
    first, second, than, aside = names
    aside = f' ({aside})' if aside else ''
    return f'{_only(experiment, difference)}{second} and {than}{aside} are not told apart: the difference lies ' \
           f'between {between(difference.estimate, scale)}{over_text(experiment, difference)} (95 % interval; ' \
           f'{pairs_text(difference)}).'


def _weak(experiment, difference, scale, names):
    first, second, than, aside = names
    aside = f' ({aside})' if aside else ''
    value = estimate_texts(difference.estimate, scale)[0]
    return f'{_only(experiment, difference)}too weak to count (Holm p{NBSP}' \
           f'{probability(difference.p_holm)}): {second} − {than}{aside} is {value}{scale.suffix}, between ' \
           f'{between(difference.estimate, scale)}{over_text(experiment, difference)} (95 % interval; ' \
           f'{pairs_text(difference)}).'


def _negligible(experiment, difference, scale, names):
    first, second, than, aside = names
    return f'negligible: the difference of {second} and {than} lies between {between(difference.estimate, scale)}, ' \
           f'less than {_smallest(difference, scale)}{over_text(experiment, difference)} (95 % interval; ' \
           f'{pairs_text(difference)}).'


def _same(experiment, difference, scale, names):
    first, second, than, aside = names
    return f'{_only(experiment, difference)}the same with {second} and {than} in all {pairs_text(difference)}.'


def _untold(experiment, difference, scale, names):
    first, second, than, aside = names
    if difference.estimate.has_interval:  # the same in each replication, but not in each pair
        return (_amount if difference.estimate.value else _same)(experiment, difference, scale, names)
    size = f'{amount(difference.estimate, scale)[0]} with {second} than with {than}' if difference.estimate.value else \
        f'the same with {second} and {than}'
    is_only = difference.estimate.n == 1 and len(difference.used) == 1
    what = 'in the only pair' if is_only else f'in {pairs_text(difference)}'
    return f'{_only(experiment, difference)}{size} {what}{over_text(experiment, difference)}; no interval, so ' \
           'this says nothing about other seeds.'


def _order(experiment, difference, scale, names):
    first, second, than, aside = names
    order = difference.order
    is_larger = order.larger > order.smaller
    most, rest = (order.larger, order.smaller) if is_larger else (order.smaller, order.larger)
    size = f'{"more" if is_larger else "fewer"} {scale.unit}' if is_noun(scale.unit) else \
        'higher' if is_larger else 'lower'
    where = f'all {counted(most, "pairs")}' if most == order.known else \
        f'{whole(most)} of {counted(order.known, "pairs")}, the other way round in {whole(rest)}'
    hidden = f' The order of {counted(order.unknown, "more pairs")} is not known.' if order.unknown else ''
    aside = f', {aside}' if aside else ''
    return f'{size} with {second} than with {than}{aside}, by order alone: in {where} ' \
           f'(test of signs, Holm p{NBSP}{probability(difference.p_holm)}).{hidden} The size of the difference ' \
           f'is not known: {_limited(difference, second, than)}; their values are lower bounds.'


def _limited(difference, second, than):
    ends = ' and '.join(f'{whole(side.cut)} of {whole(side.run)} trials with {name}'
                        for side, name in zip(reversed(difference.sides), (second, than)))
    return f'the limit of time ended {ends}'


def _cut(experiment, difference, scale, names):
    first, second, than, aside = names
    bounds = 'their values are lower bounds' if difference.metric.at_limit in endings.BOUNDS else \
        "what their values would have become is not known (at_limit in the experiment's file may say it)"
    return f'{second} and {than} are not compared: {_limited(difference, second, than)}; {bounds}.' \
           f'{_order_seen(difference)}'


def _order_seen(difference):
    """Return the sentence about an order that was tested and is not shown, '' if none was tested."""
    order = difference.order
    if order is None:
        return ''
    if difference.p_holm < intervals.ALPHA:
        return ' Their order is not the same in all combinations of the other factors.'
    return f' Their order is known in {counted(order.known, "pairs")}, which do not tell them apart ' \
           f'({whole(order.larger)} to {whole(order.smaller)}; Holm p{NBSP}{probability(difference.p_holm)}).'


def _empty(experiment, difference, scale, names):
    _, second, than, _ = names
    return f'no pair of complete trials of {second} and {than} has a value on both sides.'


_WORDS = {'none': _none, 'weak': _weak, 'negligible': _negligible, 'same': _same, 'untold': _untold,
          'empty': _empty, 'cut': _cut, 'order': _order}


def _smallest(difference, scale):
    return f'the smallest difference that counts, {digits(difference.metric.smallest * scale.factor)}{scale.suffix}'


def pairs_text(difference, noun='pairs'):
    """Return '30 pairs', or if several combinations are averaged '5 to 30 pairs with each'."""
    if len(difference.used) < 2:
        return counted(difference.estimate.n, noun)
    counts = [count for count in difference.counts if count >= difference.needed]
    least, most = min(counts), max(counts)
    each = counted(most, noun) if least == most else f'{whole(least)} to {whole(most)} {noun}'
    return f'{each} with each'


def over_text(experiment, difference):
    """Return in words the combinations over which a difference is averaged, '' if it is of one only."""
    if len(difference.used) < 2:
        return ''
    return f', on average over {groups_text(experiment, difference, difference.used)}'


def _only(experiment, difference):
    """Return the words that limit a difference to a part of what was run, '' if it is about all of it."""
    is_one = len(difference.used) == 1 and _other_factors(experiment, difference) and difference.factor is not None
    if len(difference.used) < len(difference.groups) or is_one:
        return f'with {groups_text(experiment, difference, difference.used)} only: ' if difference.used else ''
    return 'among trials that are complete, ' if verdict_of(difference) == 'survivors' else ''


def groups_text(experiment, difference, groups):
    """Return groups of configurations in words, by the factors that are not compared."""
    levels = [experiment.configurations[group[0]].levels for group in groups]
    varied = _other_factors(experiment, difference)
    if len(varied) == 1 and all(each[varied[0]] is not None for each in levels):
        own = [each[varied[0]] for each in levels]
        return levels_listed(experiment.factors, varied[0], own) if len(own) <= 8 else \
            f'{counted(len(own), "levels")} of {experiment.factors[varied[0]].title}'
    labels = [', '.join(level_label(experiment.factors, place, each[place]) for place in varied
                        if each[place] is not None) for each in levels]
    if len(groups) <= 2:
        return ' and '.join(f'({label})' for label in labels)
    return f'{whole(len(groups))} combinations of {listed(experiment.factors[place].title for place in varied)}'


def _other_factors(experiment, difference):
    return [place for place in range(len(experiment.factors)) if place != difference.factor
            and len({each.levels[place] for each in experiment.configurations}) > 1]


def _rest(experiment, difference, scale, verdict):
    """Return the sentences that must follow a difference: what is left out, opposite, too small, lost, or skewed."""
    return ''.join((exceptions(experiment, difference, scale), _perhaps_small(difference, scale, verdict),
                    _lost(experiment, difference, verdict), _skewed(difference, scale, verdict)))


def exceptions(experiment, difference, scale):
    """Return the sentences about combinations that a difference leaves out, or in which its sign is the opposite."""
    return _left_out(experiment, difference) + _against(experiment, difference, scale)


def _left_out(experiment, difference):
    """Return the sentence about combinations of the other factors of which a difference says nothing, and why."""
    if not difference.used:
        return ''
    reasons = {}
    for group, count, is_cut in zip(difference.groups, difference.counts, difference.cut):
        if count < difference.needed:
            few = 'there are too few pairs for an interval' if count else 'no pair has a value on both sides'
            why = 'the limit of time ended trials' if is_cut else few
            reasons.setdefault(why, []).append(group)
    texts = [f'of {groups_text(experiment, difference, groups)}, where {why}' for why, groups in reasons.items()]
    return f' It says nothing {", nor ".join(texts)}.' if texts else ''


def _against(experiment, difference, scale):
    texts = []
    for group, estimate in difference.against:
        size, interval = amount(estimate, scale)
        texts.append(f'with {groups_text(experiment, difference, [group])} it is {size} ({interval})')
    return f' But {some(texts)}.' if texts else ''


def _perhaps_small(difference, scale, verdict):
    estimate = difference.estimate
    nearest = min(abs(estimate.low), abs(estimate.high)) if difference.leaves_out_0 else 0.0
    if verdict in ('better', 'worse', 'differs', 'small', 'survivors', 'part', 'average', 'always') \
            and nearest < difference.metric.smallest:
        return f' It may be less than {_smallest(difference, scale)}.'
    return ''


def _lost(experiment, difference, verdict):
    """Return the sentence about trials that failed or have no value, so that a comparison knows nothing of them."""
    if verdict == 'cut' or not any(side.lacking for side in difference.sides):
        return ''
    _, second, than = spoken(experiment, difference)
    texts = []
    for what, counts in (('failed', [side.failed for side in difference.sides]),
                         ('have no value', [side.without for side in difference.sides])):
        if any(counts):
            ends = [f'{whole(count)} of {whole(side.run)} with {name}' for count, side, name in
                    zip(reversed(counts), reversed(difference.sides), (second, than))]
            texts.append(f'{listed(ends)} {what}')
    return f' Only pairs of complete trials count: {"; ".join(texts)}.'


def _skewed(difference, scale, verdict):
    if difference.median is None or verdict in ('same', 'untold', 'cut'):
        return ''
    return f' The differences are skewed; their median is {with_interval(difference.median, scale)}.'
