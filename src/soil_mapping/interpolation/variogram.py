"""Gaussian variograms, and their fit to samples.

Formula: gamma(h) = psill (1 - exp(-h^2 / s^2)) + nugget for h > 0, gamma(0) = 0, with s = 4/7 of the range. PyKrige
writes the gaussian variogram in the same way.

The fit is well-posed for any samples. It takes the most likely entry of a fixed table of ranges and shares of the
nugget, by restricted likelihood (H. D. Patterson and R. Thompson, Biometrika 58, 1971; for kriging: N. Cressie,
Statistics for Spatial Data, 1993, section 2.6), with a prior, which matters most if there are few samples. The sill
follows in closed form. Scores are compared to the sixth decimal, and no BLAS is used, so the same samples have the same
variogram on every computer.
"""
from __future__ import annotations

import functools
from typing import Any, NamedTuple, Tuple

import numpy as np

from .arithmetic import exp, fold, log

RANGE_TO_SCALE = 4.0 / 7.0
RANGES = (1.0, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125, 0.09375, 0.0625)  # of the extent; among equals the first is taken
NUGGETS = (0.001, 0.01, 0.05, 0.2, 0.5, 0.8)  # of the sill; never 0, so that no system is nearly singular
USUAL_RANGE, USUAL_SPREAD = 0.3, 0.7  # the prior: ln(range / extent) is normal; the nugget's share falls to 0 at 1
GROUP = 64  # more values are split into groups, evenly spread over them, with one composite likelihood
SCORE_DECIMALS = 6


class Variogram(NamedTuple):
    """A gaussian variogram. If psill and nugget are both 0, the field is constant."""

    psill: float  # kPa^2, without the nugget
    range_m: float  # unit of the coordinates
    nugget: float  # kPa^2

    @property
    def sill(self) -> float:
        """Variance at large distances [kPa^2]."""
        return self.psill + self.nugget

    @property
    def scale_m(self) -> float:
        """The s of the formula [unit of the coordinates]."""
        return self.range_m * RANGE_TO_SCALE

    def decay(self, differences: np.ndarray) -> np.ndarray:
        """Return exp(-d^2 / s^2) for differences of coordinates, elementwise."""
        scaled = differences / self.scale_m
        return exp(-(scaled * scaled))


def fit(points: np.ndarray, values: np.ndarray, extent: float) -> Variogram:
    """Return the Variogram of values at points, shape (n, 2), n >= 2; extent: the diagonal of the area around them.

    Equal values give a variogram of zeros, and so do values whose squared differences are too small for a float.
    """
    spread = float(values.max() - values.min())
    if spread * spread < np.finfo(np.float64).tiny:
        return Variogram(0.0, float(extent), 0.0)
    ranges = np.repeat(extent * np.array(RANGES), len(NUGGETS))
    nuggets = np.tile(NUGGETS, len(RANGES))
    groups = -(-len(points) // GROUP)
    scaled = (values - values[0]) / spread
    parts = [_restricted(points[first::groups], scaled[first::groups], ranges, nuggets) for first in range(groups)]
    freedom = len(points) - groups
    sills = sum(squares for squares, _ in parts) / freedom
    scores = _prior() - 0.5 * (freedom * log(sills) + sum(determinants for _, determinants in parts))
    best = int(np.argmax(np.round(scores, SCORE_DECIMALS)))
    sill, nugget = float(sills[best]) * spread * spread, float(nuggets[best])
    return Variogram(sill * (1.0 - nugget), float(ranges[best]), sill * nugget)


@functools.lru_cache(maxsize=None)
def _prior() -> np.ndarray:
    """Return the logarithm of the prior of each candidate (range, share of the nugget), except for a constant."""
    offset: Any = (log(np.array(RANGES)) - log(USUAL_RANGE)) / USUAL_SPREAD
    return (-0.5 * offset[:, None] * offset[:, None] + log(1.0 - np.array(NUGGETS))).ravel()


def _restricted(points: np.ndarray, values: np.ndarray, ranges: np.ndarray,
                nuggets: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Return (squares, log determinants) of each candidate, the two parts of its restricted likelihood.

    R are the correlations of a candidate, 1 is the vector of ones, and m the mean by generalised least squares. The
    squares are (z - m)' R^-1 (z - m), the log determinants ln(det R) + ln(1' R^-1 1).
    """
    count = len(points)
    x, y = points[:, None, 0] - points[:, 0], points[:, None, 1] - points[:, 1]
    scale = (ranges[::len(NUGGETS)] * RANGE_TO_SCALE)[:, None, None]  # each range is there once for each nugget
    correlations = np.repeat(exp(-(x * x + y * y) / (scale * scale)), len(NUGGETS), axis=0)
    systems = np.zeros((len(ranges), count + 2, count + 2))  # bordered by the ones and the values
    systems[:, :count, :count] = (1.0 - nuggets)[:, None, None] * correlations
    systems[:, range(count), range(count)] = 1.0
    systems[:, :count, count] = systems[:, count, :count] = 1.0
    systems[:, :count, count + 1] = systems[:, count + 1, :count] = values
    pivots = np.empty((count, len(ranges)))
    for k in range(count):
        pivots[k] = systems[:, k, k]
        column = systems[:, k + 1:, k] / pivots[k][:, None]
        systems[:, k + 1:, k + 1:] -= column[:, :, None] * systems[:, k, None, k + 1:]
    ones, both, squares = (-systems[:, -2, -2], -systems[:, -2, -1], -systems[:, -1, -1])
    return squares - both * both / ones, fold(log(pivots)) + log(ones)
