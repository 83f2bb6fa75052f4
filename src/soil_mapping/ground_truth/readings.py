"""Reads the readings of a field from files: rows of (east, north, value), checked when they are read."""
from __future__ import annotations

from pathlib import Path
from typing import Any, Dict, Optional, Sequence, Union

import numpy as np

from move_base_abstract.common.csv_files import read_values
from move_base_abstract.common.kinds import error

from ..config import Crs

MIN_READINGS, MAX_READINGS = 3, 5000  # kriging of this many takes 10 s
MAX_VALUE = 1e12  # in any unit; squares and their sums stay finite
MEUSE_FILE = Path(__file__).parents[1] / 'data' / 'meuse_zinc.csv'


def read_readings(path: str, crs: Union[str, Crs] = Crs.DEGREES) -> np.ndarray:
    """Return the readings of a CSV file as an array of shape (n, 3): lon, lat [degrees], or x, y [m], and the value.

    The file has a header with the columns lat and lon (crs metres: x and y) and one for the value: 'value', or the
    first other column if there is no 'value'.

    :raises ConfigurationError: with file and line, if a column is missing, a number is not finite, two readings lie at
        the same place, or there are fewer than 3 readings.
    """
    return _read(path, ('lon', 'lat') if Crs(crs) is Crs.DEGREES else ('x', 'y'))


def read_meuse() -> np.ndarray:
    """Return the zinc readings of the Meuse data set, shape (n, 3): x, y [m, Dutch national grid] and mg/kg.

    M. G. J. Rikken and R. P. G. Van Rijn, Soil pollution with heavy metals, Utrecht University, 1993.
    """
    return _read(MEUSE_FILE, ('x', 'y'), 'zinc')


def _read(path: Union[str, Path], places: Sequence[str], value: Optional[str] = None) -> np.ndarray:
    rows = read_values(path, places, value)
    if not MIN_READINGS <= len(rows) <= MAX_READINGS:
        raise error(str(path), len(rows), f'{MIN_READINGS} to {MAX_READINGS} readings')
    seen: Dict[Any, str] = {}
    for where, numbers in rows:
        if max(map(abs, numbers)) > MAX_VALUE:
            raise error(where, max(numbers, key=abs), f'numbers in -{MAX_VALUE:g}..{MAX_VALUE:g}')
        if numbers[:2] in seen:
            raise error(where, numbers[:2], f'places that differ; it is also that of {seen[numbers[:2]]}')
        seen[numbers[:2]] = where
    return np.array([numbers for _, numbers in rows], dtype=np.float64)
