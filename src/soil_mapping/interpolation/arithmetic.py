"""Arithmetic that gives the same bits on every computer.

Sums, products, quotients and square roots of single elements do so anyway (IEEE 754). BLAS and LAPACK do not: the
processor chooses their kernel, and each kernel sums in its own order. The order of numpy's sums may depend on the width
of registers. numpy and the C library have one exp and one log for each kind of processor. Therefore all computations
that decide something in a trial use this module instead.
"""
from __future__ import annotations

from typing import Tuple, Union

import numpy as np

LOG2_E = 1.4426950408889634
LN2_HIGH, LN2_LOW = 0.693147180369123816490, 1.90821492927058770002e-10  # the first has zeros at its end
LEAST_EXPONENT = -300.0  # of exp; smaller values do not matter here, and products of two stay normal numbers
EXP_TERMS = 14  # of Taylor's series, for |x| <= ln(2) / 2: the rest is below 1e-17
SLICE = 2.0**22  # bound of the whole numbers in slices
MOST_TERMS = 512  # of a sum in product: 2^22 2^22 512 = 2^53, up to which floats represent every whole number
SINE_TERMS = 12  # of Taylor's series, for |x| <= pi / 2: the rest is below 1e-20
LOG_TERMS = 12  # of the series of artanh, for |x| <= 0.172: the rest is below 1e-18


def exp(x: Union[float, np.ndarray]) -> Union[float, np.ndarray]:
    """Return e^x elementwise, x <= 0, to 2 units of the last place; e^-300 if x is less than -300."""
    x = np.maximum(np.asarray(x, dtype=np.float64), LEAST_EXPONENT)
    doublings = np.rint(x * LOG2_E)
    rest = (x - doublings * LN2_HIGH) - doublings * LN2_LOW
    result = np.ones_like(rest)
    for term in range(EXP_TERMS, 0, -1):  # Horner's scheme
        result *= rest
        result /= term
        result += 1.0
    return np.ldexp(result, doublings.astype(np.int32))


def log(x: Union[float, np.ndarray]) -> Union[float, np.ndarray]:
    """Return the natural logarithm elementwise, x > 0, to 1e-15 of the larger of itself and 1."""
    mantissa, exponent = np.frexp(np.asarray(x, dtype=np.float64))
    small = mantissa < 0.7071067811865476
    mantissa, exponent = np.where(small, 2.0 * mantissa, mantissa), np.where(small, exponent - 1, exponent)
    ratio = (mantissa - 1.0) / (mantissa + 1.0)  # ln(m) = 2 artanh((m - 1) / (m + 1))
    square = ratio * ratio
    result = np.zeros_like(ratio)
    for term in range(LOG_TERMS, 0, -1):
        result += 1.0 / (2 * term - 1)
        if term > 1:
            result *= square
    return exponent * LN2_HIGH + (exponent * LN2_LOW + 2.0 * ratio * result)


def sine(x: np.ndarray) -> np.ndarray:
    """Return the sine elementwise, |x| <= pi / 2, to 2 units of the last place."""
    square = x * x
    result = np.ones_like(square)
    for term in range(SINE_TERMS, 0, -1):  # Horner's scheme
        result *= square
        result /= -2 * term * (2 * term + 1)
        result += 1.0
    return x * result


def fold(terms: np.ndarray) -> Union[float, np.ndarray]:
    """Return the sum over the first axis, by halves. It overwrites terms, a float array."""
    count = len(terms)
    while count > 1:
        half = (count + 1) // 2
        terms[:count - half] += terms[half:count]
        count = half
    return terms[0]


def mean(values: np.ndarray) -> float:
    """Return the mean of all values of an array, as a float."""
    terms = np.array(values, dtype=np.float64).ravel()
    return float(fold(terms)) / len(terms)


def slices(values: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Return (high, low) of values in -1..1: multiples of 2^-22 and of 2^-44 with values = high + low, to 2^-45."""
    scaled = values * SLICE
    high = np.rint(scaled)
    scaled -= high
    scaled *= SLICE
    np.rint(scaled, out=scaled)
    high *= 1.0 / SLICE  # powers of two: nothing is rounded
    scaled *= 1.0 / (SLICE * SLICE)
    return high, scaled


def product(left: Tuple[np.ndarray, np.ndarray], right: Tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Return the matrix product of two arrays that are given as slices, to 2^-43 per term.

    The absolute values of the terms of each sum are at most 512 together, as those of 512 terms in -1..1 are.

    BLAS computes it, but the result is the same on every computer. All sums, in any order, are whole numbers below
    2^53 times a power of two, so nothing is ever rounded (K. Ozaki et al., Numerical Algorithms 59, 2012).
    """
    result = left[0] @ right[1]
    result += left[1] @ right[0]
    result += left[0] @ right[0]
    return result
