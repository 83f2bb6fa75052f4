"""Reads PGM and PPM images, text (P2, P3) and binary (P5, P6), as their formats are described (netpbm.sourceforge.net).

Pillow reads text only since 9.2, and scales values with a small maximum only since 9.1. With Pillow, a map would
depend on the release of Debian.
"""
from __future__ import annotations

import re
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from .errors import ConfigurationError

if TYPE_CHECKING:
    from .type_names import StrPath

CHANNELS = {b'P2': 1, b'P3': 3, b'P5': 1, b'P6': 3}
PIXELS_MAX = 2 ** 27  # 134 million: 11.6 km x 11.6 km in cells of 1 m
BYTES_MAX = 2 ** 31
_GAP = rb'(?:\s|#[^\n]*\n)+'
_HEADER = re.compile(rb'P[2356]' + _GAP + rb'(\d{1,9})' + _GAP + rb'(\d{1,9})' + _GAP + rb'(\d{1,9})(?:\s|(?=#)|$)')


def is_pnm(stream: IO[bytes]) -> bool:
    """Return whether the file ``stream`` begins like a PGM or PPM image; afterwards it is at its beginning again.

    :raises OSError: if it cannot be read.
    """
    magic = stream.read(2)
    stream.seek(0)
    return magic in CHANNELS


def check_size(path: StrPath, rows: int, columns: int) -> None:
    """Check that an image has no more pixels than are read. :raises ConfigurationError: if it has more."""
    if rows * columns > PIXELS_MAX:
        raise ConfigurationError('{}: the image is too large: got {} x {} pixels; allowed: {} in all'.format(
            path, columns, rows, PIXELS_MAX))


def read_pnm(path: StrPath, stream: IO[bytes]) -> Any:
    """Return the pixels of a PGM or PPM file: uint8, 0 to 255, (rows from the top, columns, 1 or 3 channels).

    :raises ConfigurationError: if it is damaged, too large, or has more than 8 bits a value; the text names the file.
    :raises OSError: if it cannot be read.
    """
    data = stream.read(BYTES_MAX)
    magic, header = data[:2], _HEADER.match(data)
    columns, rows, greatest = (int(part) for part in header.groups()) if header else (0, 0, 0)
    if header is None or not (columns and rows and greatest):
        raise ConfigurationError('{}: is not an image of a known kind, or its header is damaged; allowed: PGM, PNG and '
                                 'other common formats'.format(path))
    check_size(path, rows, columns)
    if greatest > 255:
        raise ConfigurationError('{}: got an image with more than 8 bits a value; allowed: grey, colour or palette '
                                 'images with 8 bits a value, with or without alpha'.format(path))
    shape = (rows, columns, CHANNELS[magic])
    values = (_of_text if magic in (b'P2', b'P3') else _of_bytes)(path, data[header.end():], rows * columns * shape[2])
    if values.min() < 0 or values.max() > greatest:
        raise ConfigurationError('{}: the image is damaged or truncated: got the value {}; its header announces 0 to '
                                 '{}'.format(path, values.max(), greatest))
    if greatest < 255:
        values = np.rint(values * (255.0 / greatest))
    return values.astype(np.uint8).reshape(shape)


def _of_text(path: StrPath, text: bytes, count: int) -> Any:
    text = re.sub(rb'#[^\n]*', b'', text)
    if re.search(rb'[^0-9\s]|[0-9]{10}', text):
        raise ConfigurationError('{}: the image is damaged or truncated: its values are not all whole numbers below '
                                 '1000000000'.format(path))
    values = np.fromstring(text.decode('ascii'), dtype=np.int64, sep=' ') if text.strip() else np.zeros(0, np.int64)
    if len(values) < count:
        raise ConfigurationError('{}: the image is truncated: got {} values; its header announces {}'.format(
            path, len(values), count))
    return values[:count]


def _of_bytes(path: StrPath, data: bytes, count: int) -> Any:
    if len(data) < count:
        raise ConfigurationError('{}: the image is damaged or truncated: got {} values; its header announces {}'.format(
            path, len(data), count))
    return np.frombuffer(data, np.uint8, count)
