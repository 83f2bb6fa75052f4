"""The ordinary kriging system of samples, solved once, and its mean and variance on a grid.

Formulas: N. Cressie, Statistics for Spatial Data, 1993, section 3.2, with the covariance C(h) = sill - gamma(h) instead
of the variogram. C is factorised as L D L', by elimination without exchanges, which is stable due to the nugget. With
arithmetic.py the results are the same on every computer.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Iterator, Tuple

import numpy as np

from .arithmetic import MOST_TERMS, fold, product, slices
from .chebyshev import on_grid

if TYPE_CHECKING:
    from .variogram import Variogram

COINCIDENT = 1e-10  # coordinates that differ by less than this are one place, as in PyKrige
LEAST_PIVOT = 1e-12  # of the sill: a sample with less variance, given the others, is redundant and left out
BLOCK = 32768  # numbers in one step of the computation, so that they stay in the processor's cache


class KrigingSystem:
    """Samples and their variogram: points, shape (n, 2); values, shape (n,), n <= 512; a Variogram with a sill > 0."""

    def __init__(self, points: np.ndarray, values: np.ndarray, variogram: Variogram) -> None:
        if len(values) > MOST_TERMS:
            raise ValueError(f'at most {MOST_TERMS} samples make a system, got {len(values)}')
        self._points, self._values, self._variogram = points, values, variogram
        covariance = variogram.decay(points[:, None, 0] - points[:, 0]) * variogram.decay(
            points[:, None, 1] - points[:, 1]) * variogram.psill
        np.fill_diagonal(covariance, variogram.sill)
        self._lower, self._inverse_pivots = _factorise(covariance, LEAST_PIVOT * variogram.sill)
        self._of_ones = self._solve(np.ones(len(values)))
        self._ones = float(fold(self._of_ones.copy()))  # 1' C^-1 1
        offsets = values - values[0]
        self._mean = float(values[0]) + float(fold(self._of_ones * offsets)) / self._ones
        self._weights = self._solve(values - self._mean)

    def mean(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the kriged mean on the grid that x and y span, shape (len(y), len(x))."""
        mean = np.empty((len(y), len(x)))
        for block, found in self._blocks(x, y, self._weights[None, :]):
            mean[block] = found[0] + self._mean
        hits, values = self._samples_on(x, y)
        mean[hits] = values
        return mean

    def mean_and_variance(self, x: np.ndarray, y: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Return (mean, variance), each of shape (len(y), len(x)); at a sample its value and 0."""
        rows = np.vstack((self._weights, self._of_ones, _invert(self._lower)))

        def at(some_x: np.ndarray, some_y: np.ndarray) -> np.ndarray:
            values = np.empty((2, len(some_y), len(some_x)))
            for block, found in self._blocks(some_x, some_y, rows):
                values[0, block] = found[0] + self._mean
                values[1, block] = self._variance(1.0 - found[1], found[2:])
            return values
        mean, variance = on_grid(at, x, y, self._variogram.scale_m / math.sqrt(2.0))  # of two decays' product
        np.maximum(variance, 0.0, out=variance)
        hits, values = self._samples_on(x, y)
        mean[hits], variance[hits] = values, 0.0
        return mean, variance

    def _solve(self, right: np.ndarray) -> np.ndarray:
        """Return C^-1 right."""
        result = right.astype(np.float64)
        for k in range(len(result)):
            result[k + 1:] -= self._lower[k + 1:, k] * result[k]
        result *= self._inverse_pivots
        for k in range(len(result) - 1, -1, -1):
            result[:k] -= self._lower[k, :k] * result[k]
        return result

    def _blocks(self, x: np.ndarray, y: np.ndarray, matrix: np.ndarray) -> Iterator[Tuple[Any, np.ndarray]]:
        """Yield (rows of the grid, the product of the matrix and their covariances with the samples).

        The product has the shape (rows of the matrix, rows of the grid, len(x)).
        """
        decay_x = self._variogram.decay(self._points[:, 0, None] - x)  # (n, columns)
        decay_y = self._variogram.decay(self._points[:, 1, None] - y)  # (n, rows)
        _, exponents = np.frexp(np.abs(matrix).max(axis=1))
        sliced = slices(np.ldexp(matrix, -exponents[:, None]))
        scale = np.ldexp(self._variogram.psill, exponents)
        rows = max(1, BLOCK // (len(self._values) * len(x)))
        for south in range(0, len(y), rows):
            block = slice(south, south + rows)
            decay = (decay_y[:, block, None] * decay_x[:, None, :]).reshape(len(self._values), -1)
            found = product(sliced, slices(decay))
            found *= scale[:, None]
            yield block, found.reshape(len(matrix), -1, len(x))

    def _variance(self, missing: np.ndarray, reduced: np.ndarray) -> np.ndarray:
        """Return sill - c' C^-1 c + (1 - 1' C^-1 c)^2 / (1' C^-1 1).

        :param missing: 1 - 1' C^-1 c. :param reduced: L^-1 c, which is overwritten.
        """
        reduced *= reduced
        reduced *= self._inverse_pivots[:, None, None]
        return self._variogram.sill - fold(reduced) + missing * missing / self._ones

    def _samples_on(self, x: np.ndarray, y: np.ndarray) -> Tuple[Tuple[np.ndarray, np.ndarray], np.ndarray]:
        """Return (indices of the grid, values) of the samples on it: at its own place gamma is 0, not the nugget."""
        on_y, on_x = (np.abs(line - self._points[:, axis, None]) < COINCIDENT for line, axis in ((y, 1), (x, 0)))
        there = on_y.any(axis=1) & on_x.any(axis=1)
        return (on_y.argmax(axis=1)[there], on_x.argmax(axis=1)[there]), self._values[there]


def _factorise(matrix: np.ndarray, least_pivot: float) -> Tuple[np.ndarray, np.ndarray]:
    """Return (L, 1 / D) of a symmetric matrix, which is overwritten; 1 / D is 0 for pivots up to least_pivot."""
    count = len(matrix)
    lower, inverse_pivots = np.eye(count), np.zeros(count)
    for k in range(count):
        if matrix[k, k] > least_pivot:
            inverse_pivots[k] = 1.0 / matrix[k, k]
            lower[k + 1:, k] = matrix[k + 1:, k] * inverse_pivots[k]
            matrix[k + 1:, k + 1:] -= lower[k + 1:, k, None] * matrix[k, k + 1:]
    return lower, inverse_pivots


def _invert(lower: np.ndarray) -> np.ndarray:
    """Return the inverse of a lower triangular matrix with ones on its diagonal."""
    inverse = np.eye(len(lower))
    for k in range(len(lower)):
        inverse[k + 1:, :k + 1] -= lower[k + 1:, k, None] * inverse[k, :k + 1]
    return inverse
