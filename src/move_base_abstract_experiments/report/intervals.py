"""Intervals: how far what was seen in some trials may be from what more of them would show.

Formulas and their sources: docs/experiment_report.md. NaN among values is what a trial did not give; it is left out.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy import stats

LEVEL = 0.95
ALPHA = 0.05
_ROUNDING = 1e-9  # of the largest value: what is smaller is left of rounding
_FEWEST_FOR_SKEWNESS = 8  # of scipy's test
_SKEWNESS_ALPHA = 0.01


class Estimate(NamedTuple):
    """A value and its interval; low and high are NaN where there is none."""

    value: float
    low: float
    high: float
    n: int
    method: str  # 't', 'wilson', 'newcombe', 'order', 'constant' (all values are the same), 'none'

    @property
    def has_interval(self):
        """Whether there is one; that of values which are all the same has no width."""
        return not math.isnan(self.low)


class Comparison(NamedTuple):
    """A paired difference and the probability of one as large if there was none; NaN: it cannot be told."""

    estimate: Estimate
    p: float


NOTHING = Estimate(math.nan, math.nan, math.nan, 0, 'none')


def known(values):
    """Return those values that are not NaN."""
    values = np.asarray(values, dtype=float)
    return values[~np.isnan(values)]


def mean_and_sd(values):
    """Return mean and standard deviation (n - 1), summed exactly; the latter is 0 if only rounding is left of it."""
    mean = math.fsum(values) / len(values)
    squares = math.fsum((value - mean) ** 2 for value in values)
    sd = math.sqrt(squares / (len(values) - 1)) if len(values) > 1 else math.nan
    return mean, 0.0 if sd <= _ROUNDING * max(map(abs, values)) else sd


def mean_estimate(values):
    """Return the mean with Student's interval, mean -+ t sd / sqrt(n)."""
    values = known(values)
    if not len(values):
        return NOTHING
    mean, sd = mean_and_sd(values)
    if len(values) == 1:
        return Estimate(mean, math.nan, math.nan, 1, 'none')
    if sd == 0.0:
        return Estimate(mean, mean, mean, len(values), 'constant')
    reach = float(stats.t.ppf(0.5 + LEVEL / 2.0, len(values) - 1)) * sd / math.sqrt(len(values))
    return Estimate(mean, mean - reach, mean + reach, len(values), 't')


def share_estimate(values):
    """Return the share of ones among zeros and ones with Wilson's score interval."""
    values = known(values)
    if not len(values):
        return NOTHING
    n, p, z = len(values), float(np.count_nonzero(values)) / len(values), float(stats.norm.ppf(0.5 + LEVEL / 2.0))
    middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n)
    reach = z / (1.0 + z * z / n) * math.sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n))
    low = 0.0 if p == 0.0 else middle - reach
    return Estimate(p, low, 1.0 if p == 1.0 else middle + reach, n, 'wilson')


def median_estimate(values):
    """Return the median with the narrowest symmetric interval between two order statistics that holds the level.

    It asks nothing of the distribution. With fewer than six values there is none.
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


def is_skewed(values):
    """Return whether Student's interval is in doubt: fewer values than Cochran's 25 g1^2, and g1 is not chance."""
    values = known(values)
    if len(values) < _FEWEST_FOR_SKEWNESS or mean_and_sd(values)[1] == 0.0:
        return False
    g1 = float(stats.skew(values))
    return len(values) < 25.0 * g1 * g1 and float(stats.skewtest(values)[1]) < _SKEWNESS_ALPHA


def paired(differences):
    """Return the Comparison of paired differences: Student's interval and paired t test.

    Where all differences are the same the test is that of signs: p = 2^(1 - n).
    """
    differences = known(differences)
    estimate = mean_estimate(differences)
    if estimate.n < 2:
        return Comparison(estimate, math.nan)
    mean, sd = mean_and_sd(differences)
    if sd == 0.0:
        return Comparison(estimate, 1.0 if mean == 0.0 else 2.0 ** (1 - estimate.n))
    t = abs(mean) / (sd / math.sqrt(estimate.n))
    return Comparison(estimate, float(2.0 * stats.t.sf(t, estimate.n - 1)))


def paired_shares(first, second):
    """Return the Comparison of paired zeros and ones, second - first.

    The interval is Newcombe's (score intervals of both shares, and their correlation, which is taken toward 0 for
    continuity), the test McNemar's, exact.
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


def _newcombe(a, b, c, d):
    """Return the difference of shares (a + b) / n - (a + c) / n; a: both, b: second only, c: first only, d: neither."""
    n = a + b + c + d
    one, two = share_estimate([1] * (a + b) + [0] * (c + d)), share_estimate([1] * (a + c) + [0] * (b + d))
    product = math.sqrt(float(a + b) * (c + d) * (a + c) * (b + d))
    covariance = a * d - b * c
    if covariance > 0:
        covariance = max(covariance - n / 2.0, 0.0)
    correlation = covariance / product if product else 0.0
    value = one.value - two.value

    def reach(up, down):
        return math.sqrt(max(0.0, up * up - 2.0 * correlation * up * down + down * down))
    return Estimate(value, value - reach(one.value - one.low, two.high - two.value),
                    value + reach(one.high - one.value, two.value - two.low), n, 'newcombe')


def holm(probabilities):
    """Return Holm's adjusted probabilities, in the order given; NaN, which no test gave, counts for none."""
    order = sorted((p, place) for place, p in enumerate(probabilities) if not math.isnan(p))
    adjusted, largest = [math.nan] * len(probabilities), 0.0
    for rank, (p, place) in enumerate(order):
        largest = max(largest, min(1.0, (len(order) - rank) * p))
        adjusted[place] = largest
    return adjusted
