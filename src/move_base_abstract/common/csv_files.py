"""Reads CSV tables of users, also compressed by gzip. Only regular files of a bounded size are opened."""
from __future__ import annotations

import contextlib
import csv
import gzip
import io
import math
import os
import zlib
from typing import IO, TYPE_CHECKING, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Tuple

from .errors import ConfigurationError
from .input_files import open_input
from .kinds import as_number
from .shown import shown, shown_text

if TYPE_CHECKING:
    from .type_names import StrPath

MAX_BYTES = 64 * 1024 * 1024


@contextlib.contextmanager
def open_csv(path: StrPath) -> Iterator[IO[str]]:
    """Open a CSV file as text. Errors of a CSV reader in the with block become errors that name the file.

    A file whose name ends with .gz is unpacked, to at most MAX_BYTES.

    :raises ConfigurationError: if it is not a regular file, too large, or cannot be read.
    """
    try:
        with open_input(path, MAX_BYTES, ConfigurationError, 'CSV file') as stream:
            plain = _unpacked(stream, path) if os.fspath(path).endswith('.gz') else stream
            with io.TextIOWrapper(plain, newline='', encoding='utf-8-sig') as text:
                yield text
    except ConfigurationError:
        raise
    except (ValueError, csv.Error, EOFError, zlib.error, gzip.BadGzipFile) as error:  # ValueError: not UTF-8
        raise ConfigurationError(f'{path}: cannot be read as CSV: {error}') from None


def _unpacked(stream: IO[bytes], path: StrPath) -> IO[bytes]:
    data = gzip.GzipFile(fileobj=stream).read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise ConfigurationError(f'{path}: unpacks to more than {MAX_BYTES} bytes, the most that are read')
    return io.BytesIO(data)


def rows_of(lines: Iterable[str], path: StrPath, needed: Sequence[str] = ()) -> Iterator[Tuple[str, Dict[str, str]]]:
    """Yield (where, {column: cell}) for each row of a table whose first line names the columns; skip empty lines.

    ``lines``: an iterable of text lines; it may have the number of its last line as the attribute ``number``. ``where``
    is a text with the path and the line, for errors.

    :raises ConfigurationError: if there are no columns, one of ``needed`` is missing, a column is there twice, or a row
        has another length.
    """
    reader = csv.reader(lines, strict=True)
    columns = [name.strip() for name in next(reader, ())]
    if not any(columns):
        raise ConfigurationError('{}: line 1: got no columns; allowed: a first line that names them'.format(path))
    for name in columns:
        if name and columns.count(name) > 1:  # tables may end with empty columns
            raise ConfigurationError('{}: line 1: the column {} is there {} times; allowed: names that differ'.format(
                path, shown(name), columns.count(name)))
    missing = [name for name in needed if name not in columns]
    if missing:
        raise ConfigurationError('{}: no column {}; allowed: a table with {}'.format(
            path, ', '.join(missing), ', '.join(needed)))
    for cells in reader:
        if cells:
            where = '{}: line {}'.format(path, getattr(lines, 'number', reader.line_num))
            if len(cells) != len(columns):
                raise ConfigurationError('{}: got {} cells; allowed: {}, as many as the first line has'.format(
                    where, len(cells), len(columns)))
            yield where, dict(zip(columns, cells))


def number_in(row: Mapping[str, str], name: str, where: str) -> float:
    """Return the number in the column ``name`` of a row that :func:`rows_of` has yielded with ``where``.

    :raises ConfigurationError: if it is not a finite number.
    """
    try:
        value = as_number(row[name])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ConfigurationError('{}: {}: got {}; allowed: a finite number'.format(
            where, shown_text(name), shown(row[name])))
    return value


def read_values(path: StrPath, places: Sequence[str],
                value_column: Optional[str] = None) -> List[Tuple[str, Tuple[float, ...]]]:
    """Return [(where, (place ..., value)), ...] of a table of values at places, whose columns are ``places``.

    ``places`` such as lat, lon [degrees], or x, y. ``value_column``: None: 'value', or if there is none the first that
    is not of a place. ``where`` is a text with the path and the line, for errors.

    :raises ConfigurationError: if the table cannot be read, or has no such numbers.
    """
    found = []
    with open_csv(path) as stream:
        for where, row in rows_of(stream, path, places):
            name = value_column or next((one for one in ('value', *row) if one in row and one not in places), 'value')
            if name not in row:
                raise ConfigurationError(f'{path}: no column {shown_text(name)}; allowed: a table with '
                                         f'{", ".join(places)} and a value')
            for place, limit in (('lat', 90.0), ('lon', 180.0)):
                if place in places and abs(number_in(row, place, where)) > limit:
                    raise ConfigurationError(
                        f'{where}: {place}: got {shown(row[place])}; allowed: {-limit:g}..{limit:g}')
            found.append((where, tuple(number_in(row, one, where) for one in (*places, name))))
    return found
