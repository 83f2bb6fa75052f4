"""Pack columns of numbers and texts into one text for a page: a JSON head and the columns' bytes, deflated, base64."""
from __future__ import annotations

import base64
import json
import sys
import zlib
from array import array
from typing import Any, Dict, List, Mapping

_ALIGNED = 8  # bytes; typed arrays must begin at a multiple of the size of their elements


class Packer:
    """Collects columns. The page's unpack() (data.js) reads the result of :meth:`text`.

    The layout, little endian: the length of the head (u32), the head {'about': ..., 'columns': {name: [type, begin,
    count]}}, spaces up to a multiple of 8 bytes, then the columns, each from a multiple of 8 bytes on. ``begin`` counts
    bytes from the first column on.
    """

    def __init__(self) -> None:
        self._columns: Dict[Any, Any] = {}
        self._parts: List[Any] = []
        self._size = 0

    def add(self, name: str, kind: str, values: Any) -> None:
        """Add a column of this kind: 'f8' (numbers), 'u4', 'u2', 'u1' (whole numbers), or 'text' (without newlines)."""
        if kind == 'text':
            data = '\n'.join(values).encode('utf-8', 'replace')
            count = len(data)
        else:
            column = array({'f8': 'd', 'u4': 'I', 'u2': 'H', 'u1': 'B'}[kind], values)
            if sys.byteorder == 'big':
                column.byteswap()
            data, count = column.tobytes(), len(column)
        self._columns[name] = [kind, self._size, count]
        data += bytes(-len(data) % _ALIGNED)
        self._parts.append(data)
        self._size += len(data)

    def text(self, about: Mapping[str, Any]) -> str:
        """Return all columns, and ``about``, a value for JSON, as one text."""
        head = json.dumps({'about': about, 'columns': self._columns}, allow_nan=False).encode()
        head += b' ' * (-(len(head) + 4) % _ALIGNED)
        data = b''.join([len(head).to_bytes(4, 'little'), head, *self._parts])
        return base64.b64encode(zlib.compress(data, 6)).decode('ascii')
