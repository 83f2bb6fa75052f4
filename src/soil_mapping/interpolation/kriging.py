"""Ordinary kriging of samples on the field's grid: mean and variance of every cell.

Up to 64 samples, all of them decide each cell. With more samples, the grid is cut into tiles of 20 x 20 cells, and the
64 samples nearest to a tile's centre decide the tile's cells (a moving neighbourhood: J.-P. Chiles and P. Delfiner,
Geostatistics, 1999, section 3.6). So the computing time grows no further.

Special cases:

- Samples in the same cell count as one sample, at their mean place, with their mean value.
- If there are fewer than 3 samples, there is no map; Kriging.estimate refuses them.
- If all values are equal, the mean is that value and the variance is 0 everywhere (the fitted variogram is zero).
- Samples in a line are no special case, because the variogram depends on distances alone. Off the line the variance
  grows as in any direction without samples.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, NamedTuple, Sequence, Tuple, Union

import numpy as np

from . import arithmetic
from .kriging_system import KrigingSystem
from .variogram import Variogram, fit

if TYPE_CHECKING:
    from ..ground_truth.grid import Grid

MIN_SAMPLES = 3
NEIGHBOURS = 64  # most samples that decide a cell
TILE_CELLS = 20  # edge of a tile, whose cells share their neighbours


class Estimate(NamedTuple):
    """A map that was estimated from samples. Arrays have the shape of the grid."""

    mean: np.ndarray  # kPa
    variance: np.ndarray  # kPa^2
    variogram: Variogram
    rmse: float  # kPa, between mean and truth, over all cells
    mean_variance: float  # kPa^2, over all cells


class Kriging:
    """Kriging on one grid, whose geometry is computed once.

    :param fit: the function that returns the Variogram of values at points, called as variogram.fit.
    """

    def __init__(self, grid: Grid, fit: Callable[..., Any] = fit) -> None:
        self.grid = grid
        self._fit = fit
        self._extent = math.sqrt(grid.width_m * grid.width_m + grid.height_m * grid.height_m)
        self._x = grid.x_centres()
        self._y = grid.y_centres()

    def estimate(self, points: Union[Sequence[Tuple[float, float]], np.ndarray],
                 values: Union[Sequence[float], np.ndarray], truth: np.ndarray) -> Estimate:
        """Return the Estimate of samples.

        points: places (x, y) in the map frame [m]; values: kPa; truth: array of the grid's shape [kPa].
        :raises ValueError: if there are fewer than 3 samples.
        """
        points, values = np.asarray(points, dtype=np.float64), np.asarray(values, dtype=np.float64)
        if len(points) < MIN_SAMPLES:
            raise ValueError(f'kriging needs at least {MIN_SAMPLES} samples, got {len(points)}')
        points, values = self.merge(points, values)
        variogram = self._fit(points, values, self._extent) if len(points) > 1 else Variogram(0.0, self._extent, 0.0)
        mean, variance = self.evaluate(points, values, variogram)
        error = mean - truth
        return Estimate(mean, variance, variogram, math.sqrt(arithmetic.mean(error * error)),
                        arithmetic.mean(variance))

    def merge(self, points: np.ndarray, values: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Return (points, values) with the samples of each cell merged into one, in the order of first occurrence."""
        groups: Dict[Any, Any] = {}
        for index, (x, y) in enumerate(points):
            groups.setdefault(self.grid.cell_of(x, y), []).append(index)
        members = list(groups.values())
        if len(members) == len(points):
            return points, values
        return (np.array([[arithmetic.mean(points[m, axis]) for axis in (0, 1)] for m in members]),
                np.array([arithmetic.mean(values[m]) for m in members]))

    def evaluate(self, points: np.ndarray, values: np.ndarray, variogram: Variogram) -> Tuple[np.ndarray, np.ndarray]:
        """Return (mean, variance) of all cells for a given Variogram; at a sample its value and 0."""
        if variogram.sill == 0.0:
            return np.full(self.grid.shape, float(values[0])), np.zeros(self.grid.shape)
        mean, variance = np.empty(self.grid.shape), np.empty(self.grid.shape)
        for rows, columns, near in neighbourhoods(points, self._x, self._y, NEIGHBOURS):
            system = KrigingSystem(points[near], values[near], variogram)
            mean[rows, columns], variance[rows, columns] = system.mean_and_variance(self._x[columns], self._y[rows])
        return mean, variance


def neighbourhoods(points: np.ndarray, x: np.ndarray, y: np.ndarray, most: int) -> Iterator[Tuple[Any, Any, Any]]:
    """Yield (rows, columns, indices of the points that decide them) of the grid that x and y span.

    Up to `most` points, all of them decide all cells. With more points, the nearest ones decide each tile; among
    equally near points the earlier one comes first.
    """
    if len(points) <= most:
        yield slice(None), slice(None), slice(None)
        return
    for south in range(0, len(y), TILE_CELLS):
        for west in range(0, len(x), TILE_CELLS):
            rows, columns = slice(south, south + TILE_CELLS), slice(west, west + TILE_CELLS)
            in_x, in_y = (points[:, axis] - (line[0] + line[-1]) / 2.0
                          for axis, line in ((0, x[columns]), (1, y[rows])))
            yield rows, columns, np.sort(np.argsort(in_x * in_x + in_y * in_y, kind='stable')[:most])
