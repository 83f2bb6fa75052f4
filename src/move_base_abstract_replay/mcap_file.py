"""Write MCAP files of ROS 1 messages: the part of the format that a replay needs, by its specification (mcap.dev/spec).

The chunks are not compressed and have checksums (CRC-32) and all indexes, so that readers can seek. Debian has no
library for the format, and the one on PyPI needs two compiled libraries for compressions that are not used here.
"""
from __future__ import annotations

import struct
import zlib
from typing import Any, Dict, List, Optional

_MAGIC = b'\x89MCAP0\r\n'
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _MESSAGE_INDEX, _CHUNK_INDEX = range(0x01, 0x09)
_STATISTICS, _SUMMARY_OFFSET, _DATA_END = 0x0B, 0x0E, 0x0F
_CHUNK_BYTES = 1 << 20


def _text(text: Any) -> Any:
    data = text.encode('utf-8', 'replace')
    return struct.pack('<I', len(data)) + data


def _sized(data: bytes) -> Any:
    return struct.pack('<I', len(data)) + data


def _record(code: Any, data: bytes) -> Any:
    return struct.pack('<BQ', code, len(data)) + data


class McapWriter:
    """Writes messages of genpy's classes to a binary stream. The same calls write the same bytes.

    Times are in ns and need not ascend. Call :meth:`finish` at the end; the stream stays open.
    """

    def __init__(self, stream: Any, library: Any) -> None:
        self._stream = stream
        self._at = 0
        self._crc = 0
        self._schemas: Dict[Any, Any] = {}  # {type: (id, record)}
        self._channels: Dict[Any, Any] = {}  # topic: (id, record)
        self._counts: Dict[Any, Any] = {}  # channel id: messages
        self._chunk_indexes: List[Any] = []
        self._chunk: List[Any] = []
        self._chunk_size = 0
        self._index: Dict[Any, Any] = {}
        self._times = None
        self._all_times = None
        self._put(_MAGIC)
        self._put(_record(_HEADER, _text('ros1') + _text(library)))

    def write(self, topic: Optional[str], kind: Any, data: bytes, time_ns: int) -> None:
        """Write a message of the genpy class ``kind``, serialized as ``data`` (bytes), on ``topic`` at ``time_ns``."""
        channel = self._channel_of(topic, kind)
        offset = self._chunk_size
        self._add(_record(_MESSAGE, struct.pack('<HIQQ', channel, self._counts[channel], time_ns, time_ns) + data))
        self._counts[channel] += 1
        self._index.setdefault(channel, []).append((time_ns, offset))
        self._times = _widened(self._times, time_ns)
        if self._chunk_size >= _CHUNK_BYTES:
            self._end_chunk()

    def finish(self) -> None:
        """Write the end of the file, with all indexes."""
        self._end_chunk()
        self._put(_record(_DATA_END, struct.pack('<I', self._crc)))
        self._crc = 0
        start, offsets = self._at, []
        for code, records in ((_SCHEMA, [record for _, record in self._schemas.values()]),
                              (_CHANNEL, [record for _, record in self._channels.values()]),
                              (_STATISTICS, [self._statistics()]), (_CHUNK_INDEX, self._chunk_indexes)):
            if records:
                group = self._at
                self._put(b''.join(records))
                offsets.append(_record(_SUMMARY_OFFSET, struct.pack('<BQQ', code, group, self._at - group)))
        offsets_start = self._at
        self._put(b''.join(offsets))
        self._put(struct.pack('<BQQQ', _FOOTER, 20, start, offsets_start))
        self._put(struct.pack('<I', self._crc))
        self._put(_MAGIC)

    def _put(self, data: bytes) -> None:
        self._stream.write(data)
        self._at += len(data)
        self._crc = zlib.crc32(data, self._crc)

    def _add(self, record: Any) -> None:
        self._chunk.append(record)
        self._chunk_size += len(record)

    def _channel_of(self, topic: Optional[str], kind: Any) -> Any:
        """Return the ID of a topic's channel. The first call for a topic writes its channel, and its schema if new."""
        if topic not in self._channels:
            name = kind._type
            if name not in self._schemas:
                number = len(self._schemas) + 1
                record = _record(_SCHEMA, struct.pack('<H', number) + _text(name) + _text('ros1msg')
                                 + _text(kind._full_text))
                self._schemas[name] = number, record
                self._add(record)
            number = len(self._channels)
            about = b''.join(_text(key) + _text(value) for key, value in (('md5sum', kind._md5sum), ('topic', topic)))
            record = _record(_CHANNEL, struct.pack('<HH', number, self._schemas[name][0]) + _text(topic)
                             + _text('ros1') + _sized(about))
            self._channels[topic] = number, record
            self._counts[number] = 0
            self._add(record)
        return self._channels[topic][0]

    def _end_chunk(self) -> None:
        if self._times is None:
            return
        records = b''.join(self._chunk)
        start, times = self._at, struct.pack('<QQ', *self._times)
        self._put(_record(_CHUNK, times + struct.pack('<QI', len(records), zlib.crc32(records)) + _text('')
                          + struct.pack('<Q', len(records)) + records))
        length, offsets = self._at - start, []
        for channel, entries in self._index.items():
            offsets.append(struct.pack('<HQ', channel, self._at))
            pairs = b''.join(struct.pack('<QQ', *entry) for entry in sorted(entries))
            self._put(_record(_MESSAGE_INDEX, struct.pack('<H', channel) + _sized(pairs)))
        self._chunk_indexes.append(_record(
            _CHUNK_INDEX, times + struct.pack('<QQ', start, length) + _sized(b''.join(offsets))
            + struct.pack('<Q', self._at - start - length) + _text('') + struct.pack('<Q', len(records)) * 2))
        self._all_times = _widened(_widened(self._all_times, self._times[0]), self._times[1])
        self._chunk, self._chunk_size, self._index, self._times = [], 0, {}, None

    def _statistics(self) -> Any:
        counts = b''.join(struct.pack('<HQ', *pair) for pair in self._counts.items())
        return _record(_STATISTICS, struct.pack(
            '<QHIIIIQQ', sum(self._counts.values()), len(self._schemas), len(self._channels), 0, 0,
            len(self._chunk_indexes), *(self._all_times or (0, 0))) + _sized(counts))


def _widened(times: Any, time_ns: int) -> Any:
    return (time_ns, time_ns) if times is None else (min(times[0], time_ns), max(times[1], time_ns))
