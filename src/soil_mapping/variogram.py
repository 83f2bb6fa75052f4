"""Gaussian variograms, and the ordinary kriging system that belongs to one.

Formulas: gamma(h) = psill (1 - exp(-h^2 / s^2)) + nugget for h > 0, gamma(0) = 0, with s = 4/7 of the range, which is
how PyKrige writes the gaussian variogram. Ordinary kriging: N. Cressie, Statistics for Spatial Data, 1993, section 3.2.
"""

from typing import NamedTuple

import numpy as np

RANGE_TO_SCALE = 4.0 / 7.0
COINCIDENT = 1e-10  # coordinates nearer than this are one place, as in PyKrige


class Variogram(NamedTuple):
    """A gaussian variogram. All zero psill and nugget: a constant field."""

    psill: float  # kPa^2, without the nugget
    range_m: float  # unit of the coordinates
    nugget: float  # kPa^2

    @property
    def sill(self):
        """Variance at large distances [kPa^2]."""
        return self.psill + self.nugget

    def decay(self, differences):
        """Return exp(-d^2 / s^2) for differences of coordinates, elementwise."""
        scale = self.range_m * RANGE_TO_SCALE
        return np.exp(-(differences / scale) ** 2)


def fit(points, values):
    """Return the Variogram that PyKrige fits to values at points, shape (n, 2), n >= 2.

    Equal values give a variogram of zeros, and so do those whose differences have no squares.
    """
    if np.ptp(values) ** 2 < np.finfo(np.float64).tiny:
        return Variogram(0.0, float(np.ptp(points, axis=0).max()), 0.0)
    from pykrige.ok import OrdinaryKriging  # takes 0.9 s to import
    fitted = OrdinaryKriging(points[:, 0], points[:, 1], values, variogram_model='gaussian')
    psill, range_m, nugget = fitted.variogram_model_parameters
    return Variogram(float(psill), float(range_m), float(nugget))


def inverse_system(points, variogram):
    """Return the inverse of the ordinary kriging matrix, shape (n + 1, n + 1), the multiplier's row last.

    The matrix has -gamma between the points and 1 in its border. A singular one gets its pseudo-inverse.
    """
    count = len(points)
    decay = variogram.decay(points[:, None, 0] - points[:, 0]) * variogram.decay(points[:, None, 1] - points[:, 1])
    matrix = np.ones((count + 1, count + 1))
    matrix[:count, :count] = variogram.psill * decay - variogram.sill
    np.fill_diagonal(matrix, 0.0)
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.linalg.pinv(matrix)


def evaluate_mean(points, values, variogram, x, y):
    """Return the kriged mean, shape (len(y), len(x)), at the grid that x and y span.

    A gaussian decay is a product of one of x and one of y, so that the sum over the points is a product of matrices.
    """
    if variogram.sill == 0.0:
        return np.full((len(y), len(x)), float(values[0]))
    weights = inverse_system(points, variogram)[:, :-1] @ values  # of the dual system: mean = sum w_i (-gamma_i) + w_n
    decay_x = variogram.decay(x[:, None] - points[:, 0])
    decay_y = variogram.decay(y[:, None] - points[:, 1])
    mean = (decay_y * (variogram.psill * weights[:-1])) @ decay_x.T
    mean += weights[-1] - variogram.sill * weights[:-1].sum()
    for index in range(len(points)):  # gamma is 0, not the nugget, at a point itself
        hits = np.ix_(np.abs(y - points[index, 1]) < COINCIDENT, np.abs(x - points[index, 0]) < COINCIDENT)
        mean[hits] = values[index]
    return mean
