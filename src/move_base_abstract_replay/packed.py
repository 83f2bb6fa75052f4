"""Columns of numbers and texts as one text in a page: a head in JSON and the columns' bytes, deflated, in base64."""
import base64
import json
import sys
import zlib
from array import array

_ALIGNED = 8  # bytes; typed arrays begin at multiples of what they hold


class Packer:
    """Collects columns; :meth:`text` is what the page's unpack() (data.js) reads.

    Layout, little endian: length of the head (u32), the head {'about': ..., 'columns': {name: [type, begin, count]}},
    spaces up to a multiple of 8, the columns, each from a multiple of 8 bytes on. ``begin`` counts from the first.
    """

    def __init__(self):
        self._columns = {}
        self._parts = []
        self._size = 0

    def add(self, name, kind, values):
        """Add a column: 'f8' numbers, 'u4', 'u2' or 'u1' whole ones, or 'text' (of no newline)."""
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

    def text(self, about):
        """Return all of it with ``about``, what JSON can hold."""
        head = json.dumps({'about': about, 'columns': self._columns}, allow_nan=False).encode()
        head += b' ' * (-(len(head) + 4) % _ALIGNED)
        data = b''.join([len(head).to_bytes(4, 'little'), head, *self._parts])
        return base64.b64encode(zlib.compress(data, 6)).decode('ascii')
