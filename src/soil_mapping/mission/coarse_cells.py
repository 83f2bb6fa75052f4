"""Coarse cells: a partition of the grid. The dynamic sampling makes at most one task in each part."""
from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from move_base_abstract.common.errors import ConfigurationError

from ..config import CoarseCells

if TYPE_CHECKING:
    from ..config import TrialConfig
    from ..ground_truth.grid import Grid

CLUSTERS_FILE = Path(__file__).parents[1] / 'data' / 'coarse_clusters.npy'  # compute_clusters(110, 162), made once


def coarse_cells(config: TrialConfig, grid: Grid) -> np.ndarray:
    """Return the coarse cell of each cell of the grid: labels from 0, shape (rows, columns), as a TrialConfig says.

    :raises ConfigurationError: if it asks for clusters and the field does not have the published size.
    """
    if config.coarse_cells is CoarseCells.SQUARES:
        return square_labels(grid, config.coarse_m)
    if not grid.is_published:
        raise ConfigurationError(f'coarse_cells: the clusters are those of the published field, 324 x 220 m; this one '
                                 f'has {grid.width_m:g} x {grid.height_m:g} m: take squares')
    labels = field_clusters()
    row = (grid.y_centres() // 2.0).astype(np.int64)  # the clusters have cells of 2 m
    column = (grid.x_centres() // 2.0).astype(np.int64)
    return labels[np.ix_(row, column)]


def square_labels(grid: Grid, edge_m: float) -> np.ndarray:
    """Return labels of squares of edge_m [m] from the south-west corner; the field's edge cuts the last ones."""
    row = (grid.y_centres() // edge_m).astype(np.int64)
    column = (grid.x_centres() // edge_m).astype(np.int64)
    return row[:, None] * (column[-1] + 1) + column


def field_clusters() -> np.ndarray:
    """Return the published Mesa study's coarse cells: 55 labels from 0 for 110 x 162 cells of 2 m, from a file."""
    return np.load(CLUSTERS_FILE, allow_pickle=False).astype(np.int64)


def compute_clusters(rows: int, columns: int) -> np.ndarray:
    """Return labels from 0 of complete-linkage clusters of the cells' places, at most sqrt(rows * columns) / 4 wide.

    The width is the largest distance between two cells of a cluster, in cells. Ties depend on the order in which scipy
    gets the cells, here column by column. For 110 x 162 cells this takes 5 s and 2.5 GB.
    """
    from scipy.cluster.hierarchy import fcluster, linkage
    column, row = np.divmod(np.arange(rows * columns), rows)
    tree = linkage(np.column_stack((row, column)).astype(np.float64), method='complete', metric='euclidean')
    labels = fcluster(tree, math.sqrt(rows * columns) / 4.0, criterion='distance') - 1
    found = np.empty((rows, columns), dtype=np.int64)
    found[row, column] = labels
    return found
