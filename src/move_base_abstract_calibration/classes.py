"""Errors by class of legs: by the turn at the start, the distance to the nearest other robot, and that to walls."""
import math
from typing import NamedTuple

import numpy as np

from .check import Predicted, score

#: (name, unit, function that returns the value of a (leg, way) or None, borders of the classes)
_KINDS = (
    ('start turn', 'degrees', lambda leg, way: math.degrees(abs(way.start_turn)), (60.0, 120.0, 150.0)),
    ('nearest other robot', 'm', lambda leg, way: leg.nearest_robot, (1.0, 1.5, 3.0, 5.0)),
    ('clearance of the way', 'm', lambda leg, way: leg.clearance, (0.3, 0.5, 1.0)),
)


class ClassErrors(NamedTuple):
    """The errors by one ``kind`` of classes (a name); ``rows``: [(class in words, check.Score)]."""

    kind: str
    rows: list


def by_class(pairs, predicted):
    """Return [ClassErrors] of ``pairs`` [(leg, way)]; ``predicted`` (Predicted) has a value for each, in their order.

    Legs without a value have a class of their own. A kind without any value is left out.
    """
    found = []
    for kind, unit, value_of, edges in _KINDS:
        values = [value_of(leg, way) for leg, way in pairs]
        if all(value is None for value in values):
            continue
        places = np.array([-1 if value is None else int(np.searchsorted(edges, value, side='right'))
                           for value in values])
        rows = [(_words(place, edges, unit), score('', _chosen(predicted, places == place)))
                for place in (*range(len(edges) + 1), -1) if (places == place).any()]
        found.append(ClassErrors(kind, rows))
    return found


def _chosen(predicted, which):
    return Predicted(*(part[which] for part in predicted))


def _words(place, edges, unit):
    if place < 0:
        return 'not known'
    if place == 0:
        return 'below {:g} {}'.format(edges[0], unit)
    if place == len(edges):
        return '{:g} {} or more'.format(edges[-1], unit)
    return '{:g} to {:g} {}'.format(edges[place - 1], edges[place], unit)
