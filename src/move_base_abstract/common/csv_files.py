"""Reads CSV tables of users, also compressed by gzip. Only regular files of a bounded size are opened."""
from __future__ import annotations

import contextlib
import csv
import gzip
import io
import math
import os
import zlib
from typing import IO, TYPE_CHECKING, Dict, Iterable, Iterator, Mapping, Sequence, Tuple, Type

from .errors import ConfigurationError
from .input_files import open_input
from .shown import shown

if TYPE_CHECKING:
    from .type_names import StrPath

MAX_BYTES = 64 * 1024 * 1024


@contextlib.contextmanager
def open_csv(path: StrPath, error_type: Type[ConfigurationError] = ConfigurationError) -> Iterator[IO[str]]:
    """Open a CSV file as text. Errors of a CSV reader in the with block become errors that name the file.

    A file whose name ends with .gz is unpacked, to at most MAX_BYTES.

    :raises error_type: (a kind of ConfigurationError) if it is not a regular file, too large, or cannot be read.
    """
    try:
        with open_input(path, MAX_BYTES, error_type, 'CSV file') as stream:
            plain = _unpacked(stream, path, error_type) if os.fspath(path).endswith('.gz') else stream
            with io.TextIOWrapper(plain, newline='', encoding='utf-8-sig') as text:
                yield text
    except ConfigurationError:
        raise
    except (ValueError, csv.Error, EOFError, zlib.error, gzip.BadGzipFile) as error:  # ValueError: not UTF-8
        raise error_type(f'{path}: cannot be read as CSV: {error}') from None


def _unpacked(stream: IO[bytes], path: StrPath, error_type: Type[ConfigurationError]) -> IO[bytes]:
    data = gzip.GzipFile(fileobj=stream).read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise error_type(f'{path}: unpacks to more than {MAX_BYTES} bytes, the most that are read')
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
        if columns.count(name) > 1:
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
        value = float(row[name])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ConfigurationError('{}: {}: got {}; allowed: a finite number'.format(where, name, shown(row[name])))
    return value
