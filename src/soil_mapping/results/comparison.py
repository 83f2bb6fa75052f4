"""The similarity of two studies: the published measure, its noise floor, and measures that depend on scale.

A study is a mapping from a configuration's name to an array of shape (trials, metrics), with the columns in the order
of METRICS. Both studies of a comparison have the same configurations.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Mapping, NamedTuple, Tuple

import numpy as np

from ..seeds import Purpose, generator

if TYPE_CHECKING:
    from .result import Metrics

METRICS = ('rmse_kpa', 'mean_variance_kpa2', 'samples', 'distance_m', 'idle_s', 'task_s')  # waiting is 0 everywhere
RESAMPLES = 2000
PUBLISHED_TABLE = (  # Table 1 of the TAROS 2023 abstract: first study, second study, mean cosine similarity
    ('TAROS 22 Mesa trials', 'TAROS 23 stage_ros trials - 10x sim. speed', 0.969960079),
    ('TAROS 23 stage_ros trials - 1x sim. speed', 'TAROS 23 stage_ros trials - 10x sim. speed', 0.992865229),
    ('TAROS 23 stage_ros trials - 1x sim. speed', 'TAROS 23 stage_ros trials - 15x sim. speed', 0.869587149),
)
PUBLISHED_OVERALL_SPEED_UPS = ((10.0, 2.87), (15.0, 14.18))  # nominal factor, simulated s per wall s overall
#: {configuration: array (trials, metrics)}
Study = Mapping[str, Any]


class Difference(NamedTuple):
    """The difference of one metric of one configuration, of the second study from the first."""

    configuration: str
    metric: str
    first_mean: float
    second_mean: float
    first_sd: float  # of the trials, n - 1
    second_sd: float
    relative: float  # (second - first) / |first| of the means; NaN if only the first is 0
    standardised: float  # (second - first) of the means / pooled sd of the trials; +-inf if that is 0


def trial_row(metrics: Metrics) -> List[float]:
    """Return the row of a trial's Metrics, in the order of METRICS."""
    return [float(getattr(metrics, name)) for name in METRICS]


def cosine_similarity(first: Study, second: Study) -> float:
    """Return the mean over the metrics of the cosine between the studies' vectors of configuration means.

    This measure is coarse: it does not depend on scale, and positive vectors are never far apart. Two vectors of zeros
    score 1; a vector of zeros and another one score 0. NaNs of trials are left out of the means.
    """
    return float(np.mean(metric_cosines(first, second)))


def metric_cosines(first: Study, second: Study) -> np.ndarray:
    """Return the cosine of each metric, in the order of METRICS."""
    return _cosines(_means(first, first), _means(second, first))


def noise_floor(study: Study, trials: int = 10, resamples: int = RESAMPLES, seed: int = 0,
                level: float = 0.95) -> Tuple[float, float]:
    """Return (lower, upper) of the range in which the cosine similarity of two runs of one study lies.

    Both runs are drawn from the study's own trials, with replacement (percentile bootstrap: B. Efron and R. Tibshirani,
    An Introduction to the Bootstrap, 1993, chapter 13). If two runs differ by chance only, their score lies in this
    range with the probability ``level``.

    :param trials: the number of trials of each run per configuration.
    """
    chance = generator(seed, Purpose.BOOTSTRAP)
    scores = [np.mean(_cosines(_redrawn_means(study, trials, chance), _redrawn_means(study, trials, chance)))
              for _ in range(resamples)]
    return _range_of(scores, 50.0 * (1.0 - level))


def similarity_interval(first: Study, second: Study, resamples: int = RESAMPLES,
                        seed: int = 0, level: float = 0.95) -> Tuple[float, float]:
    """Return (lower, upper) of the bootstrap interval of the cosine similarity of two studies.

    Both must have the same seeds in the same order. Pairs of trials are drawn with replacement, as many as there are.
    """
    chance = generator(seed, Purpose.BOOTSTRAP)
    both = {name: np.hstack((np.asarray(first[name], dtype=float), np.asarray(second[name], dtype=float)))
            for name in _names(first, second)}
    scores = []
    for _ in range(resamples):
        means = _redrawn_means(both, None, chance)
        scores.append(np.mean(_cosines(means[:, :len(METRICS)], means[:, len(METRICS):])))
    return _range_of(scores, 50.0 * (1.0 - level))


def differences(first: Study, second: Study) -> List[Difference]:
    """Return a Difference for each configuration and metric; configurations in the order of the first study."""
    found = []
    for name in _names(first, second):
        a, b = np.asarray(first[name], dtype=float), np.asarray(second[name], dtype=float)
        for column, metric in enumerate(METRICS):
            found.append(_difference(name, metric, a[:, column], b[:, column]))
    return found


def bootstrap_interval(first: np.ndarray, second: np.ndarray, comparisons: int = 1, resamples: int = 20 * RESAMPLES,
                       seed: int = 0, level: float = 0.95) -> Any:
    """Return (lower, upper) of the bootstrap interval of the difference of means, second - first.

    If 0 lies inside, no difference is shown.

    :param first, second: values of one metric, shape (trials,).
    :param comparisons: number of intervals that are used together. The level is corrected so that all of them hold
        with the given probability (Bonferroni).
    """
    chance = generator(seed, Purpose.BOOTSTRAP)
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    change = (second[chance.integers(len(second), size=(resamples, len(second)))].mean(axis=1)
              - first[chance.integers(len(first), size=(resamples, len(first)))].mean(axis=1))
    return _range_of(change, 50.0 * (1.0 - level) / comparisons)


def _difference(name: str, metric: str, a: np.ndarray, b: np.ndarray) -> Difference:
    a, b = a[~np.isnan(a)], b[~np.isnan(b)]
    means = [float(x.mean()) if len(x) else np.nan for x in (a, b)]
    sds = [float(x.std(ddof=1)) if len(x) > 1 else np.nan for x in (a, b)]
    change = means[1] - means[0]
    freedom = len(a) + len(b) - 2
    pooled = np.sqrt(((len(a) - 1) * sds[0] ** 2 + (len(b) - 1) * sds[1] ** 2) / freedom) if freedom > 0 else np.nan
    return Difference(name, metric, *means, *sds, _ratio(change, abs(means[0]), np.nan),  # type: ignore[call-arg]
                      _ratio(change, float(pooled), np.copysign(np.inf, change)))


def _ratio(change: float, by: float, if_zero: float) -> float:
    """Return change / by; 0 if change is 0, otherwise if_zero if by is 0."""
    if change == 0.0:
        return 0.0
    return float(if_zero) if by == 0.0 else float(change / by)


def _names(first: Study, second: Study) -> List[str]:
    if set(first) != set(second):
        raise ValueError(f'the studies must have the same configurations, got {sorted(first)} and {sorted(second)}')
    return list(first)


def _means(study: Study, like: Study) -> np.ndarray:
    """Return the means of the configurations, shape (configurations, metrics), in the order of the study ``like``."""
    return np.array([_known_means(np.asarray(study[name], dtype=float)) for name in _names(like, study)])


def _redrawn_means(study: Study, trials: Any, chance: Any) -> np.ndarray:
    rows = (np.asarray(rows, dtype=float) for rows in study.values())
    return np.array([_known_means(r[chance.integers(len(r), size=trials or len(r))]) for r in rows])


def _known_means(rows: np.ndarray) -> np.ndarray:
    """Return the mean of each column without its NaNs; NaN if it has only NaNs."""
    known = ~np.isnan(rows)
    count = known.sum(axis=0)
    total = np.where(known, rows, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _range_of(scores: Any, tail: float) -> Any:
    """Return the (tail, 100 - tail) percentiles; scores of NaN, from trials without a value, are left out."""
    known = np.asarray(scores)[~np.isnan(scores)]
    return tuple(map(float, np.percentile(known if len(known) else [np.nan], (tail, 100.0 - tail))))


def _cosines(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the cosine of each pair of columns; 1 if both are zero, 0 if one is zero."""
    product = (first * second).sum(axis=0)
    lengths = np.linalg.norm(first, axis=0), np.linalg.norm(second, axis=0)
    both = lengths[0] * lengths[1]
    zero = np.where((lengths[0] == 0.0) & (lengths[1] == 0.0), 1.0, 0.0)
    return np.where(both == 0.0, zero, product / np.where(both == 0.0, 1.0, both))
