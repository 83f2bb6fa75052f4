"""Intervals: how far the result of some trials may be from the result of very many.

Formulas and their sources: docs/experiment_report.md. NaN among values stands for a trial without a value; it is left
out.
"""
from __future__ import annotations

import math
from typing import List, NamedTuple, Sequence, Tuple, Union

import numpy as np
from scipy import special, stats

LEVEL = 0.95
ALPHA = 0.05
ROUNDING = 1e-11  # relative to the values: sums of the same numbers in another order differ by less
MOST_EXACT_FLIPS = 500  # replications; with more, the normal distribution is close enough
_FEWEST_FOR_SKEWNESS = 8  # the fewest values that scipy's test takes
_SKEWNESS_ALPHA = 0.01


class Estimate(NamedTuple):
    """A value and its interval; low and high are NaN if there is no interval."""

    value: float
    low: float
    high: float
    n: int
    # 't', 'wilson', 'newcombe', 'order', 'none', 'cut' (of effects.summary), 'constant' (all values are the same) or
    # 'fixed' (the mean over the rows is the same in each column)
    method: str

    @property
    def has_interval(self) -> bool:
        """Whether there is an interval. If all values are the same, there is one, and its width is 0."""
        return not math.isnan(self.low)


class Comparison(NamedTuple):
    """A paired difference, and the probability p of one at least as large if nothing differed; NaN: no test."""

    estimate: Estimate
    p: float


NOTHING = Estimate(math.nan, math.nan, math.nan, 0, 'none')


def known(values: Union[Sequence[float], np.ndarray]) -> np.ndarray:
    """Return the values that are not NaN, as an array."""
    values = np.asarray(values, dtype=float)
    return values[~np.isnan(values)]


def rounding_of(values: np.ndarray) -> float:
    """Return the largest difference of such values that may come from rounding alone; 0 for whole numbers."""
    values = np.asarray(values, dtype=float)
    return 0.0 if (values == np.rint(values)).all() else ROUNDING * float(np.abs(values).max(initial=0.0))


def contrast(signs: Sequence[int], tables: Sequence[np.ndarray]) -> Tuple[np.ndarray, np.ndarray]:
    """Return the sum of the tables with these signs, and per entry the largest error of rounding.

    An entry that is not larger than its error of rounding is 0.

    :param signs: +1 or -1 for each table. :param tables: arrays of one shape, NaN where there is no value.
    """
    tables = np.asarray(tables, dtype=float)
    found = np.tensordot(np.asarray(signs, dtype=float), tables, axes=1)
    largest = np.abs(tables).max(axis=0)
    left = np.where((tables == np.rint(tables)).all(axis=0), 0.0, ROUNDING * largest)
    return np.where(np.abs(found) <= left, 0.0, found), left


def mean_and_sd(values: np.ndarray) -> Tuple[float, float]:
    """Return mean and standard deviation (n - 1), summed exactly. The latter is 0 if it may be rounding alone."""
    mean = math.fsum(values) / len(values)
    if len(values) < 2:
        return mean, math.nan
    size = max(map(abs, values)) or 1.0  # otherwise squares of very small numbers would be 0
    sd = size * math.sqrt(math.fsum(((value - mean) / size) ** 2 for value in values) / (len(values) - 1))
    return mean, 0.0 if sd <= rounding_of(values) else sd


def mean_estimate(values: Union[Sequence[float], np.ndarray]) -> Estimate:
    """Return the Estimate of the mean with Student's interval, mean -+ t sd / sqrt(n)."""
    values = known(values)
    if not len(values):
        return NOTHING
    mean, sd = mean_and_sd(values)
    if len(values) == 1:
        return Estimate(mean, math.nan, math.nan, 1, 'none')
    if sd == 0.0:
        return Estimate(mean, mean, mean, len(values), 'constant')
    reach = float(special.stdtrit(len(values) - 1, 0.5 + LEVEL / 2.0)) * sd / math.sqrt(len(values))
    return Estimate(mean, mean - reach, mean + reach, len(values), 't')


def share_estimate(values: Union[Sequence[int], np.ndarray]) -> Estimate:
    """Return the Estimate of the share of ones among zeros and ones, with Wilson's score interval."""
    values = known(values)
    if not len(values):
        return NOTHING
    n, p, z = len(values), float(np.count_nonzero(values)) / len(values), float(stats.norm.ppf(0.5 + LEVEL / 2.0))
    middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n)
    reach = z / (1.0 + z * z / n) * math.sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n))
    low = 0.0 if p == 0.0 else middle - reach
    return Estimate(p, low, 1.0 if p == 1.0 else middle + reach, n, 'wilson')


def median_estimate(values: Union[Sequence[float], range, np.ndarray]) -> Estimate:
    """Return the Estimate of the median with the narrowest symmetric interval between two order statistics.

    The interval holds the level and assumes nothing about the distribution. With fewer than six values there is none.
    """
    values = np.sort(known(values))
    n = len(values)
    if not n:
        return NOTHING
    median = float(np.median(values))
    below = int(stats.binom.ppf(ALPHA / 2.0, n, 0.5))  # the largest rank whose tail is no larger than alpha / 2
    if below < 1:
        return Estimate(median, math.nan, math.nan, n, 'none')
    return Estimate(median, float(values[below - 1]), float(values[n - below]), n, 'order')


def is_skewed(values: np.ndarray) -> bool:
    """Return whether Student's interval is in doubt: fewer values than Cochran's 25 g1^2, and g1 is not by chance."""
    values = known(values)
    if len(values) < _FEWEST_FOR_SKEWNESS:
        return False
    mean, sd = mean_and_sd(values)
    if sd == 0.0:
        return False
    parts = (values - mean) / sd
    g1 = float((parts ** 3).mean() / (parts ** 2).mean() ** 1.5)
    return len(values) < 25.0 * g1 * g1 and float(stats.skewtest(values)[1]) < _SKEWNESS_ALPHA


def paired(differences: Union[Sequence[float], np.ndarray]) -> Comparison:
    """Return the Comparison of paired differences: Student's interval and paired t test.

    If all differences are the same, the test is the test of signs: p = 2^(1 - n).
    """
    differences = known(differences)
    return clustered(differences[None, :]) if len(differences) else Comparison(NOTHING, math.nan)


def clustered(rows: np.ndarray, left: Union[float, np.ndarray] = 0.0) -> Comparison:
    """Return the Comparison of the mean of the means of rows; the values of one column had the same seed.

    All rows have the same weight, however many values they have, so that no row weighs more because trials of others
    failed. The error is that of independent columns. Student's t has the degrees of freedom of the row with the fewest
    values.

    :param rows: shape (combinations, replications), NaN where there is no value; at least one value in each row.
    :param left: the largest error of rounding of each entry.
    """
    rows = np.asarray(rows, dtype=float)
    there = ~np.isnan(rows)
    counts, n = there.sum(axis=1), int(there.any(axis=0).sum())
    left = np.where(there, np.broadcast_to(left, rows.shape), 0.0).max(axis=1)
    means = np.array([math.fsum(known(row)) / count for row, count in zip(rows, counts)])
    value = math.fsum(means) / len(means)
    value = 0.0 if abs(value) <= left.mean() else value
    if counts.min() < 2:
        return Comparison(Estimate(value, math.nan, math.nan, n, 'none'), math.nan)
    rest = np.where(there, rows - means[:, None], 0.0)
    limits = np.maximum(left, [rounding_of(known(row)) for row in rows])
    rest[np.abs(rest).max(axis=1) <= limits] = 0.0
    size = np.abs(rest).max() or 1.0  # otherwise squares of very small numbers would be 0
    shares = ((rest / size) * (np.sqrt(counts / (counts - 1.0)) / (counts * len(rows)))[:, None]).sum(axis=0)
    error = size * math.sqrt(math.fsum(shares ** 2))
    fewest = int(counts.min())
    if error == 0.0:
        is_one = not rest.any() and np.ptp(means) <= limits.max()
        return Comparison(Estimate(value, value, value, n, 'constant' if is_one else 'fixed'),
                          1.0 if value == 0.0 else 2.0 ** (1 - fewest))
    reach = float(special.stdtrit(fewest - 1, 0.5 + LEVEL / 2.0)) * error  # as scipy.stats' t, but faster
    return Comparison(Estimate(value, value - reach, value + reach, n, 't'),
                      float(2.0 * special.stdtr(fewest - 1, -abs(value) / error)))


def flip_test(sums: np.ndarray) -> float:
    """Return the probability of a total at least as far from 0 if the sign of each whole number were by chance."""
    sums = np.abs(np.asarray(sums, dtype=int)), int(np.sum(sums))
    sizes, total = sums[0][sums[0] > 0], abs(sums[1])
    if len(sizes) > MOST_EXACT_FLIPS:
        return float(2.0 * stats.norm.sf(total / math.sqrt(float((sizes ** 2).sum()))))
    chances = np.ones(1)
    for size in sizes:
        wider = np.zeros(len(chances) + 2 * size)
        wider[:len(chances)] += chances / 2.0
        wider[2 * size:] += chances / 2.0
        chances = wider
    return min(1.0, float(chances[np.abs(np.arange(len(chances)) - sizes.sum()) >= total].sum()))


def paired_shares(first: Union[Sequence[float], np.ndarray], second: Union[Sequence[float], np.ndarray]) -> Comparison:
    """Return the Comparison of paired zeros and ones, second - first.

    The interval is Newcombe's: from the score intervals of both shares, and their correlation, which is moved toward 0
    for continuity. The test is McNemar's exact test.
    """
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    both = ~np.isnan(first) & ~np.isnan(second)
    first, second = first[both] > 0.5, second[both] > 0.5
    n = len(first)
    if n < 2:
        return Comparison(mean_estimate(second.astype(float) - first), math.nan)
    a, b = int((first & second).sum()), int((~first & second).sum())
    c, d = int((first & ~second).sum()), int((~first & ~second).sum())
    return Comparison(_newcombe(a, b, c, d), min(1.0, 2.0 * float(stats.binom.cdf(min(b, c), b + c, 0.5))))


def share_differences(first: np.ndarray, second: np.ndarray) -> Comparison:
    """Return the Comparison of the mean over rows of differences of paired shares, second - first.

    On each side the interval is the wider of two: Student's interval, and Newcombe's intervals of the rows with their
    squares added. The former takes into account what seeds have in common, the latter that shares of few trials are
    uncertain. The test is exact: whether the signs of the contributions of the seeds may be by chance.

    :param first, second: zeros and ones, shape (combinations, replications), NaN where there is no value.
    """
    if len(first) == 1:
        return paired_shares(first[0], second[0])
    rows = second - first
    found = clustered(rows).estimate
    if found.method == 'none':
        return Comparison(found, math.nan)
    parts = [paired_shares(*each).estimate for each in zip(first, second)]
    below, above = (math.sqrt(math.fsum(((part.value - bound_of(part)) / len(parts)) ** 2 for part in parts))
                    for bound_of in (lambda part: part.low, lambda part: part.high))
    sums = np.nansum(rows, axis=0)
    is_alike = (sums.sum() < 0.0) == (found.value < 0.0)  # otherwise the rows with many values have the opposite sign
    return Comparison(found._replace(low=max(-1.0, min(found.low, found.value - below)), method='newcombe',
                                     high=min(1.0, max(found.high, found.value + above))),
                      flip_test(sums) if is_alike else 1.0)


def _newcombe(a: int, b: int, c: int, d: int) -> Estimate:
    """Return the Estimate of the difference of shares (a + b) / n - (a + c) / n.

    The numbers of pairs with a one: a: on both sides, b: only on the second, c: only on the first, d: on neither.
    """
    n = a + b + c + d
    one, two = share_estimate([1] * (a + b) + [0] * (c + d)), share_estimate([1] * (a + c) + [0] * (b + d))
    product = math.sqrt(float(a + b) * (c + d) * (a + c) * (b + d))
    covariance = float(a * d - b * c)
    if covariance > 0:
        covariance = max(covariance - n / 2.0, 0.0)
    correlation = covariance / product if product else 0.0
    value = one.value - two.value

    def reach(up: float, down: float) -> float:
        return math.sqrt(max(0.0, up * up - 2.0 * correlation * up * down + down * down))
    return Estimate(value, value - reach(one.value - one.low, two.high - two.value),
                    value + reach(one.high - one.value, two.value - two.low), n, 'newcombe')


def holm(probabilities: Sequence[float]) -> List[float]:
    """Return Holm's adjusted probabilities, in the order given. NaN, where there was no test, does not count."""
    order = sorted((p, place) for place, p in enumerate(probabilities) if not math.isnan(p))
    adjusted, largest = [math.nan] * len(probabilities), 0.0
    for rank, (p, place) in enumerate(order):
        largest = max(largest, min(1.0, (len(order) - rank) * p))
        adjusted[place] = largest
    return adjusted
