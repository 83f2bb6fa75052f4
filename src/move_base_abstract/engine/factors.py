"""How many times as long as by its law something takes: distributions of a factor, each drawn from uniform numbers.

``draw(uniform)`` of each draws from a :data:`Uniform`.
"""
from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from statistics import NormalDist
from typing import Callable, Tuple

#: gives the ``place``-th of independent numbers in (0, 1)
Uniform = Callable[[int], float]
_NORMAL = NormalDist()


@dataclass(frozen=True)
class Constant:
    """Always ``mean`` (> 0)."""

    mean: float = 1.0

    def draw(self, _uniform: Uniform) -> float:
        """Return the factor."""
        return self.mean


@dataclass(frozen=True)
class Lognormal:
    """Lognormal of mean ``mean`` (> 0) and coefficient of variation ``cv`` (> 0): sigma^2 = ln(1 + cv^2)."""

    mean: float
    cv: float

    def draw(self, uniform: Uniform) -> float:
        """Return a factor, by the inverse of the normal distribution."""
        variance = math.log1p(self.cv * self.cv)
        return self.mean * math.exp(math.sqrt(variance) * _NORMAL.inv_cdf(uniform(0)) - 0.5 * variance)


_LEAST_CV = 1e-9  # below it no number shows the spread


@dataclass(frozen=True)
class Gamma:
    """Gamma of mean ``mean`` (> 0) and coefficient of variation ``cv`` (> 0): shape 1/cv^2."""

    mean: float
    cv: float

    def draw(self, uniform: Uniform) -> float:
        """Return a factor (Marsaglia, Tsang: A simple method for generating gamma variables. ACM TOMS 26(3), 2000).

        For a shape below 1 that of one more is multiplied by u^(1/shape), as they say.
        """
        if self.cv < _LEAST_CV:
            return self.mean
        shape = 1.0 / (self.cv * self.cv)
        boost = 1.0 if shape >= 1.0 else uniform(0) ** (1.0 / shape)
        d = (shape if shape >= 1.0 else shape + 1.0) - 1.0 / 3.0
        c = 1.0 / math.sqrt(9.0 * d)
        place, accepted = 1, False
        while not accepted:
            normal = _NORMAL.inv_cdf(uniform(place))
            v = (1.0 + c * normal) ** 3
            accepted = v > 0.0 and math.log(uniform(place + 1)) < 0.5 * normal * normal + d * (1.0 - v + math.log(v))
            place += 2
        return self.mean * boost * d * v / shape


@dataclass(frozen=True)
class Quantiles:
    """``mean`` times what lies between ``points`` ((probability, factor), ...), straight from one to the next.

    Both ascend, the probabilities from 0 to 1.
    """

    mean: float
    points: Tuple[Tuple[float, float], ...]

    def draw(self, uniform: Uniform) -> float:
        """Return a factor."""
        return self.mean * along(self.points, uniform(0))


def along(points: Tuple[Tuple[float, float], ...], at: float) -> float:
    """Return y at x = ``at``, straight between ``points`` ((x, y), ...), beyond the ends that of the end."""
    index = bisect_right([x for x, _ in points], at)
    if index == 0:
        return points[0][1]
    if index == len(points):
        return points[-1][1]
    (x0, y0), (x1, y1) = points[index - 1:index + 1]
    return y0 + (y1 - y0) * (at - x0) / (x1 - x0)
