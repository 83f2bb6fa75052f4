"""Comparison of two messages field by field, as genpy reads them."""
import os
import struct

import genpy
import roslib.message

from move_base_abstract.common.shown import first_lines, shown

MOST = 12  # fields that are shown
_LENGTH = struct.Struct('<I')
_BROKEN = (genpy.MessageException, ValueError, TypeError, LookupError)


def class_of(kind):
    """Return the class of a message type such as 'std_msgs/String', or None if it is not installed."""
    try:
        return roslib.message.get_message_class(kind)
    except (ImportError, ValueError, LookupError):
        return None


def kept(path, number):
    """Return (type, bytes) of message ``number``, counted from 1, in a file of the time master's ``message_bytes``.

    Return None if the file does not have it, since such a file has an upper limit, or cannot be read. Calls and
    responses have the type ''.
    """
    try:
        with open(path, 'rb') as stream:
            while True:
                words = [_word(stream, number == 1) for _ in range(2)]
                number -= 1
                if number == 0 or None in words:
                    return None if None in words else (words[0].decode('utf-8', 'replace'), words[1])
    except OSError:
        return None


def _word(stream, is_wanted):
    length = stream.read(_LENGTH.size)
    if len(length) < _LENGTH.size:
        return None
    size, = _LENGTH.unpack(length)
    if is_wanted:
        data = stream.read(size)
        return data if len(data) == size else None
    stream.seek(size, os.SEEK_CUR)
    return b''


def difference(kind, one, other):
    """Return lines that name the fields in which two messages differ, with both values.

    If the messages cannot be read, or all fields are equal, the only line says so.

    :param kind: the class of the messages, or None if it is not installed.
    :param one: the bytes of the first message.
    :param other: the bytes of the second message.
    """
    if kind is None:
        return ['the type of the message is not known here']
    try:
        first, second = (dict(_fields('', kind().deserialize(data))) for data in (one, other))
    except _BROKEN as error:
        return ['the messages cannot be read as {}: {}'.format(kind._type, error)]
    names = [name for name in dict.fromkeys([*first, *second]) if repr(first.get(name)) != repr(second.get(name))]
    return first_lines(['{}: {} / {}'.format(name, *(shown(values[name]) if name in values else 'not there'
                                                     for values in (first, second))) for name in names],
                       MOST, '... and {} more fields') or [
        'all fields are equal; the bytes are not (NaN, or the lengths of empty fields)']


def _fields(name, value):
    """Yield (path, value) of each field of a message, in the order of its definition."""
    if isinstance(value, genpy.Message):
        for field in value.__slots__:
            yield from _fields('{}.{}'.format(name, field) if name else field, getattr(value, field))
    elif isinstance(value, (list, tuple)):
        yield name + '.length', len(value)
        for number, one in enumerate(value):
            yield from _fields('{}[{}]'.format(name, number), one)
    elif isinstance(value, genpy.TVal):
        yield name + ' [ns]', value.to_nsec()
    else:
        yield name, value
