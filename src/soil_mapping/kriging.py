"""Ordinary kriging of few samples to the field's grid: mean and variance of every cell.

What is defined beyond the ordinary case:

- Samples in the same cell count as one, at their mean place, with their mean value.
- Fewer than 3 samples: there is no map; Kriging.estimate refuses them.
- Equal values: the mean is that value, the variance 0 everywhere (the fitted variogram is zero).
- Samples in a line need nothing of their own: the variogram depends on distances alone. Off the line the variance
  grows as it does in any direction without samples.
"""

from typing import NamedTuple

import numpy as np

from .variogram import COINCIDENT, Variogram, evaluate_mean, fit, inverse_system

MIN_SAMPLES = 3
BLOCK_ROWS = 6


class Estimate(NamedTuple):
    """A map made of samples. Arrays have the shape of the grid."""

    mean: np.ndarray  # kPa
    variance: np.ndarray  # kPa^2
    variogram: Variogram
    rmse: float  # kPa, of the mean against the truth, over all cells
    mean_variance: float  # kPa^2, over all cells


class Kriging:
    """Kriging to one grid, whose geometry is computed once."""

    def __init__(self, grid):
        self.grid = grid
        self._x = grid.x_centres()
        self._y = grid.y_centres()

    def estimate(self, points, values, truth):
        """Return the Estimate of samples.

        points: places (x, y) in the map frame [m]; values: kPa; truth: array of the grid's shape [kPa].
        :raises ValueError: if there are fewer than 3 samples.
        """
        points, values = np.asarray(points, dtype=np.float64), np.asarray(values, dtype=np.float64)
        if len(points) < MIN_SAMPLES:
            raise ValueError(f'kriging needs at least {MIN_SAMPLES} samples, got {len(points)}')
        points, values = self.merge(points, values)
        variogram = fit(points, values)
        mean, variance = self.evaluate(points, values, variogram)
        error = mean - truth
        return Estimate(mean, variance, variogram, float(np.sqrt(np.mean(error * error))), float(variance.mean()))

    def merge(self, points, values):
        """Return the samples with those of one cell made one; order: as first seen."""
        groups = {}
        for index, (x, y) in enumerate(points):
            groups.setdefault(self.grid.cell_of(x, y), []).append(index)
        members = list(groups.values())
        if len(members) == len(points):
            return points, values
        return np.array([points[m].mean(axis=0) for m in members]), np.array([values[m].mean() for m in members])

    def evaluate(self, points, values, variogram):
        """Return (mean, variance) of all cells with a given Variogram; at a sample: its value and 0."""
        mean = evaluate_mean(points, values, variogram, self._x, self._y)
        if variogram.sill == 0.0:
            return mean, np.zeros(self.grid.shape)
        return mean, self._variance(points, variogram)

    def _variance(self, points, variogram):
        """Return -b' A^-1 b, with b = (-gamma to each point, 1), shape of the grid.

        Block by block, so that what is worked on stays in the processor's cache.
        """
        count = len(points)
        inverse = inverse_system(points, variogram)
        decay_x = variogram.decay(points[:, 0, None] - self._x)  # (n, columns)
        decay_y = variogram.psill * variogram.decay(points[:, 1, None] - self._y)  # (n, rows)
        variance = np.empty(self.grid.shape)
        for south in range(0, self.grid.rows, BLOCK_ROWS):
            rows = slice(south, min(south + BLOCK_ROWS, self.grid.rows))
            right = np.ones((count + 1, rows.stop - south, self.grid.columns))
            np.multiply(decay_y[:, rows, None], decay_x[:, None, :], out=right[:count])
            right[:count] -= variogram.sill
            right = right.reshape(count + 1, -1)
            form = inverse @ right
            form *= right
            variance[rows] = -form.sum(axis=0).reshape(-1, self.grid.columns)
        for x, y in points:
            variance[np.ix_(np.abs(self._y - y) < COINCIDENT, np.abs(self._x - x) < COINCIDENT)] = 0.0
        return variance
