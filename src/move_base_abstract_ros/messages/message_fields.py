"""Two messages field by field, as genpy reads them: which fields differ, and what they are."""
import os
import struct

import genpy
import roslib.message

from move_base_abstract.common.shown import shown

MOST = 12  # fields that are told
_LENGTH = struct.Struct('<I')
_BROKEN = (genpy.MessageException, ValueError, TypeError, LookupError)


def class_of(kind):
    """Return the class of messages of a type such as 'std_msgs/String', or None where it is not installed."""
    try:
        return roslib.message.get_message_class(kind)
    except (ImportError, ValueError, LookupError):
        return None


def kept(path, number):
    """Return (type, bytes) of a message by its number, from 1 on, in a file of the time master's ``message_bytes``.

    None where the file does not have it: it has an upper limit. Of calls and responses the type is ''.
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
    """Return texts of the fields in which two messages differ; why there are none, if they cannot be read.

    :param kind: a class of messages, or None; :param one, other: bytes.
    """
    if kind is None:
        return ['the type of the message is not known here']
    try:
        first, second = (dict(_fields('', kind().deserialize(data))) for data in (one, other))
    except _BROKEN as error:
        return ['the messages cannot be read as {}: {}'.format(kind._type, error)]
    names = [name for name in dict.fromkeys([*first, *second]) if repr(first.get(name)) != repr(second.get(name))]
    lines = ['{}: {} / {}'.format(name, *(shown(values[name]) if name in values else 'not there'
                                          for values in (first, second))) for name in names[:MOST]]
    more = len(names) - MOST
    return lines + (['... and {} more fields'.format(more)] if more > 0 else []) or [
        'all fields are equal; the bytes are not (NaN, or the lengths of what is empty)']


def _fields(name, value):
    """Yield (path, value) of all that a message holds, in the order of its definition."""
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
