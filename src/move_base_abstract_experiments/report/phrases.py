"""Levels and amounts as words in a sentence: 'with 3 robots than with 1', '24 more goals', '12 s (8 %) lower'."""

import math

from .design import level_label
from .intervals import Estimate
from .wording import digits, estimate_texts, listed

_UNITS = ('s', 'ms', 'min', 'h', 'm', 'mm', 'cm', 'km', 'kg', 'Hz', 'deg', 'rad')
_NO_PLURALS = ('ss', 'us', 'is', 'as', 'os')
_VOWELS = 'aeiou'
MOST_LISTED = 6


def with_level(factors, place, level):
    """Return a level in the words that follow 'with': 'auction', '3 robots', 'a pause of 5 s', 'charging true'."""
    factor = factors[place]
    text, words = factor.levels[level], factor.title.split(' ')
    if not factor.is_numeric or not all(word.isalpha() for word in words):
        return level_label(factors, place, level)
    if len(words) > 1 and words[-1] in _UNITS:
        return f'{_article(words[0])} {" ".join(words[:-1])} of {text} {words[-1]}'
    if _is_plural(words[-1]):
        return f'{text} {_singular(factor.title) if text == "1" else factor.title}'
    if len(factor.title) < 3:
        return level_label(factors, place, level)
    return f'{_article(words[0])} {factor.title} of {text}'


def than_with_level(factors, place, level):
    """Return a level in the words that follow 'than with', after another level of its factor: '1', 'greedy'."""
    factor = factors[place]
    long = with_level(factors, place, level)
    if long == level_label(factors, place, level):
        return long
    words = factor.title.split(' ')
    return factor.levels[level] + (f' {words[-1]}' if len(words) > 1 and words[-1] in _UNITS else '')


def levels_listed(factors, place, levels):
    """Return several levels of one factor: '1, 2 and 3 robots', 'auction and greedy'."""
    texts = [than_with_level(factors, place, level) for level in levels]
    last = levels[-1]
    if _is_plural(factors[place].title.split(' ')[-1]) and factors[place].is_numeric and len(levels) > 1 \
            and with_level(factors, place, last) != level_label(factors, place, last):
        return f'{listed(texts)} {factors[place].title}'
    return listed([with_level(factors, place, levels[0]), *texts[1:]])


def _article(word):
    return 'an' if word[:1].lower() in _VOWELS else 'a'


def _is_plural(word):
    return len(word) > 3 and word.endswith('s') and not word.endswith(_NO_PLURALS)


def _singular(text):
    if text.endswith('ies') and len(text) > 4:
        return text[:-3] + 'y'
    return text[:-2] if text.endswith(('ches', 'shes', 'xes', 'sses')) else text[:-1]


def is_noun(unit):
    """Return whether a unit is the plural noun of things that are counted: goals, tasks, collisions."""
    return unit.isalpha() and unit.islower() and _is_plural(unit)


def size_of(estimate):
    """Return the Estimate of a difference as a positive amount, and whether the difference is negative."""
    is_lower = estimate.value < 0.0
    if is_lower:
        estimate = Estimate(-estimate.value, -estimate.high, -estimate.low, *estimate[3:])
    return estimate, is_lower


def amount(estimate, scale, reference=math.nan, is_change=False):
    """Return '12 s (8 %) lower' or '24 more goals (300 %)', and the words of the interval, in the same direction.

    :param reference: the value of which the amount is also given in per cent; NaN for no per cent.
    :param is_change: whether this is the change of a difference, which is not a number of things: '24 goals higher'.
    """
    size, is_lower = size_of(estimate)
    value, low, high = estimate_texts(size, scale)
    share = ''
    if reference > 0.0 and reference + estimate.value > 0.0 and size.value <= 10.0 * reference:
        share = f' ({digits(100.0 * size.value / reference, 2)} %)'
    interval = f'95 % interval {low} to {high}{scale.suffix}'
    if estimate.method in ('constant', 'fixed'):
        interval = 'in every pair' if estimate.method == 'constant' else 'the same in every replication'
    if is_noun(scale.unit) and not is_change:
        noun = _singular(scale.unit) if value == '1' else scale.unit
        return f'{value} {"fewer" if is_lower else "more"} {noun}{share}', interval
    return f'{value}{scale.suffix}{share} {"lower" if is_lower else "higher"}', interval


def between(estimate, scale):
    """Return the bounds of an interval: '−3 and 8 s'."""
    _, low, high = estimate_texts(estimate, scale)
    return f'{low} and {high}{scale.suffix}'


def some(texts, most=MOST_LISTED):
    """Return texts as a list in a sentence; if there are many, the first ones and the number of the others."""
    texts = list(texts)
    return listed(texts) if len(texts) <= most else f'{", ".join(texts[:most - 1])} and {len(texts) - most + 1} more'
