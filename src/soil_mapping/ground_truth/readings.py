"""Reads the readings of a field from files: rows of (east, north, value), checked when they are read."""
from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from move_base_abstract.common.csv_files import open_csv
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown, shown_text

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
    names = ('lon', 'lat') if Crs(crs) is Crs.DEGREES else ('x', 'y')
    return _read(path, (*names, None))


def read_meuse() -> np.ndarray:
    """Return the zinc readings of the Meuse data set, shape (n, 3): x, y [m, Dutch national grid] and mg/kg.

    M. G. J. Rikken and R. P. G. Van Rijn, Soil pollution with heavy metals, Utrecht University, 1993.
    """
    return _read(MEUSE_FILE, ('x', 'y', 'zinc'))


def _read(path: Union[str, Path], names: Tuple[str, str, Optional[str]]) -> np.ndarray:
    rows = _read_rows(path, names)
    if len(rows) < MIN_READINGS:
        raise ConfigurationError(f'{path}: needs at least {MIN_READINGS} readings, got {len(rows)}')
    return np.array(rows, dtype=np.float64)


def _read_rows(path: Union[str, Path], names: Tuple[str, str, Optional[str]]) -> List[List[float]]:
    rows: List[Any] = []
    seen: Dict[Any, Any] = {}
    with open_csv(path) as stream:
        lines = csv.reader(stream, strict=True)
        header = [name.strip() for name in next(lines, [])]
        columns = _columns(header, names, path)
        for cells in lines:
            if cells:
                where = f'{path}:{lines.line_num}'
                row = [_number(cells, index, shown_text(header[index]), where) for index in columns]
                _check_place(row, header, columns, seen, where, lines.line_num)
                rows.append(row)
                if len(rows) > MAX_READINGS:
                    raise ConfigurationError(f'{where}: more than {MAX_READINGS} readings, the most that are read')
    return rows


def _columns(header: Sequence[str], names: Tuple[str, str, Optional[str]], path: Union[str, Path]) -> List[int]:
    """Return the indices of the columns; the name None means 'value', or the first other column if there is none."""
    left = [name for name in header if name not in names]
    value = 'value' if 'value' in left or not left else left[0]
    wanted = [value if name is None else name for name in names]
    for name in wanted:
        if header.count(name) != 1:
            problem = 'is missing' if name not in header else f'is there {header.count(name)} times'
            raise ConfigurationError(f"{path}:1: column '{shown_text(name)}' {problem}; needs "
                                     f"{shown_text(', '.join(wanted))}, "
                                     f'got {shown(header)}')
    return [header.index(name) for name in wanted]


def _number(cells: Sequence[str], index: int, name: str, where: str) -> float:
    if index >= len(cells):
        raise ConfigurationError(f"{where}: column '{name}' is missing; the line has {len(cells)} columns")
    try:
        number = float(cells[index])
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ConfigurationError(f"{where}: column '{name}' must be a finite number, got {shown(cells[index])}")
    if abs(number) > MAX_VALUE:
        raise ConfigurationError(f"{where}: column '{name}' must lie in -{MAX_VALUE:g}..{MAX_VALUE:g}, got {number!r}")
    return number


def _check_place(row: Sequence[float], header: Sequence[str], columns: Sequence[int],
                 seen: Dict[Tuple[float, float], int], where: str, line: int) -> None:
    for number, index in zip(row, columns):
        limit = {'lat': 90.0, 'lon': 180.0}.get(header[index], math.inf)
        if abs(number) > limit:
            raise ConfigurationError(f"{where}: column '{header[index]}' must lie in -{limit:g}..{limit:g} degrees, "
                                     f'got {number!r}')
    place: Any = tuple(row[:2])
    if place in seen:
        raise ConfigurationError(f'{where}: the same place as in line {seen[place]}; places must differ')
    seen[place] = line
