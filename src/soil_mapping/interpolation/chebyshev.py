"""Sums of Gaussians on a grid, from their values at few places: polynomials through Chebyshev nodes.

Formulas: L. N. Trefethen, Approximation Theory and Approximation Practice, 2013, chapters 2 and 5 (nodes, barycentric
formula) and theorem 8.2 (error). With arithmetic.py the results are the same on every computer.
"""
from __future__ import annotations

import functools
from typing import Any, Callable, Optional, Tuple

import numpy as np

from .arithmetic import fold, product, sine, slices

NODES, NODES_PER_WIDTH = 15, 12.5  # with these, theorem 8.2 bounds the error of exp(-t^2 / w^2) by 1e-16, up to 25 w


def on_grid(function: Callable[..., Any], x: np.ndarray, y: np.ndarray, width: float) -> np.ndarray:
    """Return the values of function on the grid that x and y span, shape (k, len(y), len(x)).

    :param function: it returns values of shape (k, len(y), len(x)) for any x and y. Along each line in x and in y they
        are constants plus sums of exp(-(t - a)^2 / w^2) with w >= width.
    :param x: increasing coordinates. :param y: the same. :param width: in their unit, > 0.
    """
    (at_x, to_x), (at_y, to_y) = (_known_nodes(line.tobytes(), width) for line in (x, y))
    values = function(at_x, at_y)
    if to_x is to_y is None:
        return values
    _, exponents = np.frexp(np.abs(values).max(axis=(1, 2), keepdims=True))
    values = values * np.ldexp(1.0, -exponents)
    if to_y is not None:
        values = np.stack([product(to_y, slices(each)) for each in values])
    if to_x is not None:
        values = product(slices(values.reshape(-1, len(at_x))), tuple(part.T for part in to_x))
    values = values.reshape(-1, len(y), len(x))
    values *= np.ldexp(1.0, exponents)
    return values


@functools.lru_cache(maxsize=32)  # a mission's maps have one grid, and few widths
def _known_nodes(line: bytes, width: float) -> Tuple[np.ndarray, Optional[Tuple[np.ndarray, np.ndarray]]]:
    return _nodes(np.frombuffer(line), width)


def _nodes(line: np.ndarray, width: float) -> Tuple[np.ndarray, Optional[Tuple[np.ndarray, np.ndarray]]]:
    """Return (nodes, slices of the matrix from values there to the line's); (line, None) if that saves little."""
    half, middle = (line[-1] - line[0]) / 2.0, (line[0] + line[-1]) / 2.0
    most = len(line) // 2 - 1  # with more nodes the matrix costs what they save
    if most < NODES or not NODES_PER_WIDTH * half <= (most - NODES) * width:  # the user's own fit may give 0 or nan
        return line, None
    count = int(NODES + NODES_PER_WIDTH * half / width) + 1
    odd = np.arange(1, 2 * count, 2)
    nodes = middle + half * sine((count - odd) * (np.pi / (2 * count)))
    weights = sine(np.minimum(odd, 2 * count - odd) * (np.pi / (2 * count)))
    weights[1::2] *= -1.0
    away = line - nodes[:, None]
    on_node = away == 0.0
    terms = weights[:, None] / np.where(on_node, 1.0, away)
    terms = np.where(on_node.any(axis=0), on_node, terms)  # a place on a node has the node's value
    # The polynomials' values at a place are in sum their Lebesgue constant. It grows as the logarithm of their number,
    # and is 10 for a million of them, so product() never rounds.
    return nodes, slices((terms / fold(terms.copy())).T)
