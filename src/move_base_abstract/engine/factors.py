"""Distributions of a factor: how many times as long something takes as its law says.

Each distribution has ``draw(uniform)``, which returns a factor from the uniform numbers of a :data:`Uniform`.
"""
from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from statistics import NormalDist
from typing import Callable, Tuple

#: a function that returns the ``place``-th of independent, uniform numbers in (0, 1)
Uniform = Callable[[int], float]
_NORMAL = NormalDist()


@dataclass(frozen=True)
class Constant:
    """The factor is always ``mean`` (> 0)."""

    mean: float = 1.0

    def draw(self, _uniform: Uniform) -> float:
        """Return the factor."""
        return self.mean


@dataclass(frozen=True)
class Even:
    """Evenly distributed from ``mean`` - ``spread`` to ``mean`` + ``spread``; 0 <= spread <= mean."""

    mean: float
    spread: float

    def draw(self, uniform: Uniform) -> float:
        """Return a factor."""
        return self.mean + self.spread * (2.0 * uniform(0) - 1.0)


@dataclass(frozen=True)
class Lognormal:
    """Lognormal distribution: mean ``mean`` (> 0), coefficient of variation ``cv`` (> 0), sigma^2 = ln(1 + cv^2)."""

    mean: float
    cv: float

    def draw(self, uniform: Uniform) -> float:
        """Return a factor, by the inverse of the normal distribution."""
        variance = math.log1p(self.cv * self.cv)
        return self.mean * math.exp(math.sqrt(variance) * _NORMAL.inv_cdf(uniform(0)) - 0.5 * variance)


_LEAST_CV = 1e-9  # a smaller spread would not be visible in any number


@dataclass(frozen=True)
class Gamma:
    """Gamma distribution: mean ``mean`` (> 0), coefficient of variation ``cv`` (> 0), shape 1/cv^2."""

    mean: float
    cv: float

    def draw(self, uniform: Uniform) -> float:
        """Return a factor (Marsaglia, Tsang: A simple method for generating gamma variables. ACM TOMS 26(3), 2000).

        For a shape below 1, a number with the shape + 1 is multiplied by u^(1/shape), as in that paper.
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
    """The factor is ``mean`` times a number by its quantiles ``points`` ((probability, factor), ...).

    Between two points it is interpolated linearly. Probabilities and factors ascend, the probabilities from 0 to 1.
    """

    mean: float
    points: Tuple[Tuple[float, float], ...]

    def draw(self, uniform: Uniform) -> float:
        """Return a factor."""
        return self.mean * along(self.points, uniform(0))


def along(points: Tuple[Tuple[float, float], ...], at: float) -> float:
    """Return y at x = ``at``, linear between ``points`` ((x, y), ...); beyond the first or last, that point's y."""
    index = bisect_right([x for x, _ in points], at)
    if index == 0:
        return points[0][1]
    if index == len(points):
        return points[-1][1]
    (x0, y0), (x1, y1) = points[index - 1:index + 1]
    return y0 + (y1 - y0) * (at - x0) / (x1 - x0)
