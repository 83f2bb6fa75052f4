"""Measure how well legs are predicted that were not fitted: random parts, other recordings, regions of the map."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.engine.factors import along

from .fit import ended, fit, succeeded
from .law import Durations
from .legs import met_no_robot

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D

    from .law import Values
    from .legs import Pair, Pairs, RecordedLeg

    #: the legs to fit, and the legs to predict
    Fold = Tuple[Sequence[Pair], Sequence[Pair]]

PARTS = 10
_MOST_RECORDINGS = 8  # up to so many recordings, each is predicted from the others
MET = 1.5  # m; a leg that came nearer to another robot may have been held up
_SEED = 20130213
_INTERVAL = (0.05, 0.95)
#: (name, unit, function that returns the value of a (leg, way) or None, borders of the classes)
_KINDS = (
    ('start turn', 'degrees', lambda leg, way: math.degrees(abs(way.start_turn)), (60.0, 120.0, 150.0)),
    ('nearest other robot', 'm', lambda leg, way: leg.nearest_robot, (1.0, 1.5, 3.0, 5.0)),
    ('clearance of the way', 'm', lambda leg, way: leg.clearance, (0.3, 0.5, 1.0)),
)


class Predicted(NamedTuple):
    """Predicted and measured durations of legs: arrays with one value per leg [s]."""

    measured: np.ndarray
    median: np.ndarray
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    below: np.ndarray  # the predicted chance of a duration of at most the measured one
    straight: np.ndarray  # the duration of a straight line at the nominal speed


class Score(NamedTuple):
    """How well legs were predicted, as shares and not in per cent."""

    name: str  # of these legs, in words
    legs: int  # the number of legs
    median_error: float  # the median error of the predicted median
    mean_ratio: float  # the sum of predicted means by the sum of measured durations
    within: float  # the share of legs within the predicted interval of 90 %
    straight_error: float  # the median error of the straight line
    straight_ratio: float  # the median of measured durations by those of the straight line
    success: Optional[Tuple[float, float]] = None  # the rates of success (predicted, measured)


def predict(values: Values, pairs: Pairs, nominal_speed: float) -> Predicted:
    """Return the Predicted for those ``pairs`` [(leg, way)] that succeeded and count.

    ``values``: {parameter of a calibration: value}; ``nominal_speed`` [m/s]: that of the straight line.
    """
    used = succeeded(pairs)
    law = Durations(values, [way for _, way in used])
    measured = np.array([leg.duration for leg, _ in used])
    straight = np.array([leg.start.distance_to(leg.goal) for leg, _ in used]) / nominal_speed
    return Predicted(measured, law.quantile(0.5), law.mean(), law.quantile(_INTERVAL[0]),
                     law.quantile(_INTERVAL[1]), law.share_below(measured), straight)


def score(name: str, predicted: Predicted, success: Optional[Tuple[float, float]] = None) -> Score:
    """Return the Score of a Predicted."""
    measured = predicted.measured
    return Score(
        name, len(measured), float(np.median(np.abs(predicted.median - measured) / measured)),
        float(predicted.mean.sum() / measured.sum()),
        float(np.mean((predicted.low <= measured) & (measured <= predicted.high))),
        float(np.median(np.abs(predicted.straight - measured) / measured)),
        float(np.median(measured / np.maximum(predicted.straight, 1e-9))), success)


def success_rates(values: Values, pairs: Pairs) -> Tuple[float, float]:
    """Return the predicted and the measured rate of success of ``pairs``, as shares."""
    all_ended = ended(pairs)
    failures = tuple((length, chance) for length, chance in values['failure_by_length'])
    chances = [along(failures, way.length) if failures else 0.0 for _, way in all_ended]
    return 1.0 - float(np.mean(chances)), sum(leg.succeeded for leg, _ in all_ended) / len(all_ended)


def by_parts(pairs: Pairs) -> List[Fold]:
    """Return [(legs to fit, legs to predict)] for random parts of ``pairs``; they are the same in each call."""
    order = np.random.default_rng(_SEED).permutation(len(pairs))
    return [([pairs[index] for index in np.setdiff1d(order, order[part::PARTS])],
             [pairs[index] for index in order[part::PARTS]]) for part in range(PARTS)]


def by_regions(pairs: Pairs) -> List[Fold]:
    """Return [(legs to fit, legs to predict)] for the four quarters around the median goal.

    The legs that end in a quarter are predicted from legs that neither begin nor end in it.
    """
    middle = np.median([(leg.goal.x, leg.goal.y) for leg, _ in pairs], axis=0)

    def quarter(pose: Pose2D) -> Tuple[bool, bool]:
        return pose.x > middle[0], pose.y > middle[1]
    quarters = [(east, north) for east in (False, True) for north in (False, True)]
    return [([pair for pair in pairs if one not in (quarter(pair[0].start), quarter(pair[0].goal))],
             [pair for pair in pairs if quarter(pair[0].goal) == one]) for one in quarters]


def by_recordings(pairs: Pairs) -> Dict[str, Fold]:
    """Return {name of a recording: (legs of the others, its own legs)}; {} if there is only one, or very many."""
    folds = _by(pairs, lambda leg: leg.recording)
    return folds if len(folds) <= _MOST_RECORDINGS else {}


def by_maps(pairs: Pairs) -> Dict[str, Fold]:
    """Return {name of a map: (legs on the others, legs on it)}; {} if there is only one."""
    return _by(pairs, lambda leg: leg.map)


def _by(pairs: Pairs, key: Callable[[RecordedLeg], str]) -> Dict[str, Fold]:
    names = sorted({key(leg) for leg, _ in pairs})
    return {name: ([pair for pair in pairs if key(pair[0]) != name],
                   [pair for pair in pairs if key(pair[0]) == name]) for name in names} if len(names) > 1 else {}


class Folds(NamedTuple):
    """The result of folds, all together."""

    predicted: Predicted
    pairs: List[Pair]  # the legs that were predicted, with their ways
    success: Tuple[float, float]  # the rates of success (predicted, measured)


def predict_folds(folds: Iterable[Fold], nominal_speed: float) -> Optional[Folds]:
    """Return the Folds of [(legs to fit, legs to predict)], or None if none can be used.

    Folds with too few legs to fit, or with none to predict, are left out.
    """
    found: List[Predicted] = []
    rates: List[Tuple[float, ...]] = []
    used: List[Pair] = []
    for known, asked in folds:
        try:
            values = fit(known)
        except ConfigurationError:
            continue
        if succeeded(asked):
            found.append(predict(values, asked, nominal_speed))
            rates.append((len(asked), *success_rates(values, asked)))
            used += succeeded(asked)
    if not found:
        return None
    weights, predicted, measured = np.transpose(rates)
    return Folds(Predicted(*(np.concatenate(parts) for parts in zip(*found))), used,
                 (float(np.average(predicted, weights=weights)), float(np.average(measured, weights=weights))))


def scores(values: Values, pairs: Pairs, nominal_speed: float) -> Tuple[List[Score], Optional[Folds]]:
    """Return ([Score], the Folds for the pictures and classes); the first Score is of the legs that were fitted.

    If there are several maps, the Folds are those by maps, otherwise random parts; None if there are too few legs.
    """
    rows = [score('the legs that were fitted', predict(values, pairs, nominal_speed), success_rates(values, pairs))]
    kinds = [('{} parts at random'.format(PARTS), by_parts(pairs))]
    maps = by_maps(pairs)
    kinds += [('map {} by the others'.format(name), [fold]) for name, fold in maps.items()]
    kinds += [] if maps else [('four quarters of the map', by_regions(pairs))]
    for name, (known, asked) in by_recordings(pairs).items():
        alone = [pair for pair in asked if met_no_robot(pair[0], MET)]
        kinds.append(('recording {} by the others'.format(name), [(known, asked)]))
        if len(alone) < len(asked):
            kinds.append(('of these, legs that met no other robot within {:g} m'.format(MET), [(known, alone)]))
    told = [(words, predict_folds(folds, nominal_speed)) for words, folds in kinds]
    rows += [score(words, folds.predicted, folds.success) for words, folds in told if folds is not None]
    return rows, predict_folds(list(maps.values()), nominal_speed) if maps else told[0][1]


class ClassErrors(NamedTuple):
    """The errors by one ``kind`` of classes (a name); ``rows``: [(class in words, Score)]."""

    kind: str
    rows: List[Tuple[str, Score]]


def by_class(pairs: Pairs, predicted: Predicted) -> List[ClassErrors]:
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


def _chosen(predicted: Predicted, which: np.ndarray) -> Predicted:
    """Return the part of a Predicted whose places are True in ``which``."""
    return Predicted(*(part[which] for part in predicted))


def _words(place: int, edges: Sequence[float], unit: str) -> str:
    if place < 0:
        return 'not known'
    if place == 0:
        return 'below {:g} {}'.format(edges[0], unit)
    if place == len(edges):
        return '{:g} {} or more'.format(edges[-1], unit)
    return '{:g} to {:g} {}'.format(edges[place - 1], edges[place], unit)
