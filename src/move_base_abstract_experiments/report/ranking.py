"""Rank the levels of a factor: find the best one, and its lead over each of the others."""

import math
from typing import NamedTuple

from . import orders
from .intervals import Estimate


class Ranking(NamedTuple):
    """The best level and its Differences to the others, in which it is the second one; the smallest lead first."""

    level: int
    leads: tuple  # of effects.Difference


def turned(difference):
    """Return a Difference with first and second exchanged."""
    estimate, median = _negative(difference.estimate), difference.median
    return difference._replace(
        first=difference.second, second=difference.first, estimate=estimate, sides=difference.sides[::-1],
        reference=difference.reference + difference.estimate.value,
        groups=tuple(each[::-1] for each in difference.groups), median=None if median is None else _negative(median),
        against=tuple((group[::-1], _negative(each)) for group, each in difference.against),
        order=orders.turned(difference.order))


def _negative(estimate):
    return Estimate(-estimate.value or 0.0, -estimate.high or 0.0, -estimate.low or 0.0, *estimate[3:])


def ranking(differences, better):
    """Return the Ranking of one factor's Differences between levels, or None if none has a value.

    The best level is the one whose smallest lead is the largest; of equal ones the first. ``better`` is 'lower',
    'higher' or None; with None the lowest level counts as the best.
    """
    sign = 1.0 if better == 'higher' else -1.0
    leads = {}
    for each in differences:
        if not math.isnan(each.estimate.value):
            leads.setdefault(each.second, []).append(each)
            leads.setdefault(each.first, []).append(turned(each))
    if not leads:
        return None
    for own in leads.values():
        own.sort(key=lambda each: (sign * each.estimate.value, each.first))
    most = max(map(len, leads.values()))  # a level with fewer comparisons cannot be the best of all
    level = max((level for level, own in leads.items() if len(own) == most),
                key=lambda level: (sign * leads[level][0].estimate.value, -level))
    return Ranking(level, tuple(leads[level]))
