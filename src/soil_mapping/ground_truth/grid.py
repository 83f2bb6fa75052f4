"""The field's grid of cells. Map frame: origin at the field's south-west corner, x east, y north [m]."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

FIELD_WIDTH_M = 324.0  # of the published study's field, and of synthetic fields
FIELD_HEIGHT_M = 220.0
MAX_CELLS = 1_000_000  # kriging on more cells takes too long


@dataclass(frozen=True)
class Grid:
    """rows x columns square cells; row 0 is at the south edge, column 0 at the west edge."""

    rows: int
    columns: int
    cell_m: float  # edge of a cell [m]

    @classmethod
    def of_field(cls, cell_m: float) -> Grid:
        """Return the grid of the study's field, 324 x 220 m, with cells of cell_m [m]."""
        return cls(round(FIELD_HEIGHT_M / cell_m), round(FIELD_WIDTH_M / cell_m), float(cell_m))

    @property
    def is_published(self) -> bool:
        """Whether it covers the published study's field, 324 x 220 m."""
        return (self.width_m, self.height_m) == (FIELD_WIDTH_M, FIELD_HEIGHT_M)

    @property
    def shape(self) -> Tuple[int, int]:
        """Shape of an array over the grid: (rows, columns)."""
        return self.rows, self.columns

    @property
    def width_m(self) -> float:
        """East-west extent [m]."""
        return self.columns * self.cell_m

    @property
    def height_m(self) -> float:
        """North-south extent [m]."""
        return self.rows * self.cell_m

    def x_centres(self) -> np.ndarray:
        """Return the x of the columns' centres [m], shape (columns,)."""
        return (np.arange(self.columns) + 0.5) * self.cell_m

    def y_centres(self) -> np.ndarray:
        """Return the y of the rows' centres [m], shape (rows,)."""
        return (np.arange(self.rows) + 0.5) * self.cell_m

    def cell_of(self, x: float, y: float) -> Tuple[int, int]:
        """Return (row, column) of the cell that contains the place; places outside belong to the nearest cell.

        A cell contains its south and west edges.
        """
        row = min(max(int(y // self.cell_m), 0), self.rows - 1)
        return row, min(max(int(x // self.cell_m), 0), self.columns - 1)

    def centre(self, row: int, column: int) -> Tuple[float, float]:
        """Return (x, y) of a cell's centre [m]."""
        return (column + 0.5) * self.cell_m, (row + 0.5) * self.cell_m

    def snap(self, x: float, y: float) -> Tuple[float, float]:
        """Return the centre (x, y) [m] of the cell that contains the place."""
        return self.centre(*self.cell_of(x, y))
