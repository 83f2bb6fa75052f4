"""Ordinary kriging of samples to the field's grid: mean and variance of every cell.

Up to 64 samples all of them decide each cell. With more, the grid is cut into tiles of 20 x 20 cells, and the 64
samples nearest to a tile's middle decide the tile's cells (a moving neighbourhood: J.-P. Chiles and P. Delfiner,
Geostatistics, 1999, section 3.6), so that time grows no further. Many near samples make nearly singular systems; in
neighbourhoods the nugget is therefore a millionth of the partial sill at least.

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
NEIGHBOURS = 64  # samples that decide a cell, at most
TILE_CELLS = 20  # edge of what shares its neighbours
NUGGET_SHARE = 1e-6  # of the partial sill, at least, in a neighbourhood


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
        if len(points) > NEIGHBOURS and variogram.sill > 0.0:
            return self._evaluate_tiles(points, values, variogram)
        mean = evaluate_mean(points, values, variogram, self._x, self._y)
        if variogram.sill == 0.0:
            return mean, np.zeros(self.grid.shape)
        return mean, _variance(points, variogram, self._x, self._y)

    def _evaluate_tiles(self, points, values, variogram):
        """Return (mean, variance) of all cells, each tile by its nearest samples; at equal distance the earlier one."""
        variogram = variogram._replace(nugget=max(variogram.nugget, NUGGET_SHARE * variogram.psill))
        mean, variance = np.empty(self.grid.shape), np.empty(self.grid.shape)
        for south in range(0, self.grid.rows, TILE_CELLS):
            for west in range(0, self.grid.columns, TILE_CELLS):
                rows, columns = slice(south, south + TILE_CELLS), slice(west, west + TILE_CELLS)
                x, y = self._x[columns], self._y[rows]
                distance = (points[:, 0] - (x[0] + x[-1]) / 2.0) ** 2 + (points[:, 1] - (y[0] + y[-1]) / 2.0) ** 2
                near = np.sort(np.argsort(distance, kind='stable')[:NEIGHBOURS])
                mean[rows, columns] = evaluate_mean(points[near], values[near], variogram, x, y)
                variance[rows, columns] = np.maximum(_variance(points[near], variogram, x, y), 0.0)
        return mean, variance


def _variance(points, variogram, x, y):
    """Return -b' A^-1 b, with b = (-gamma to each point, 1), shape (len(y), len(x)).

    Block by block, so that what is worked on stays in the processor's cache.
    """
    count = len(points)
    inverse = inverse_system(points, variogram)
    decay_x = variogram.decay(points[:, 0, None] - x)  # (n, columns)
    decay_y = variogram.psill * variogram.decay(points[:, 1, None] - y)  # (n, rows)
    variance = np.empty((len(y), len(x)))
    for south in range(0, len(y), BLOCK_ROWS):
        rows = slice(south, min(south + BLOCK_ROWS, len(y)))
        right = np.ones((count + 1, rows.stop - south, len(x)))
        np.multiply(decay_y[:, rows, None], decay_x[:, None, :], out=right[:count])
        right[:count] -= variogram.sill
        right = right.reshape(count + 1, -1)
        form = inverse @ right
        form *= right
        variance[rows] = -form.sum(axis=0).reshape(-1, len(x))
    for point in points:
        variance[np.ix_(np.abs(y - point[1]) < COINCIDENT, np.abs(x - point[0]) < COINCIDENT)] = 0.0
    return variance
