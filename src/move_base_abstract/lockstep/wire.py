"""The bytes between a participant and the time master: frames, report items out, grant items in.

All functions are made from the table in :mod:`.wire_format`, which docs/lockstep_protocol.md describes. All numbers are
little endian. A frame has its length (u32), its type (u8) and its body. A function that makes an item or a body takes
the values of the fields in the order of the table.
"""
from __future__ import annotations

import struct
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Callable, List, Tuple, Union

from . import wire_format
from .wire_format import LARGEST_FRAME, NEVER, ODOMETRY, PROTOCOL

if TYPE_CHECKING:
    from .wire_format import Layout

__all__ = ['LARGEST_FRAME', 'NEVER', 'ODOMETRY', 'PROTOCOL']
MAX_RANK = 2 ** 31 - 1  # a rank has 32 bits with its sign

FRAMES = {layout.name: layout for layout in wire_format.PARTICIPANT_FRAMES + wire_format.MASTER_FRAMES}
ITEMS = {layout.name: layout for layout in wire_format.REPORT_ITEMS + wire_format.GRANT_ITEMS}
NoteKind: Any
Delivery: Any
CallStatus: Any
Slot: Any
NoteKind, Delivery, CallStatus, Slot = (
    IntEnum(name, [(value, number) for number, value in wire_format.CHOICES[name]])
    for name in ('NoteKind', 'Delivery', 'CallStatus', 'Slot'))


def _numbers(layouts: Any, names: Any) -> Any:
    return (layouts[name].number for name in names.split())


HELLO, REPORT, KNOCK, LEAVE, STOPPING, BUSY, CRASHING, LOOKED = _numbers(
    FRAMES, 'HELLO REPORT KNOCK LEAVE STOPPING BUSY CRASHING LOOKED')
WELCOME, MEMBER, GONE, GRANT, END = _numbers(FRAMES, 'WELCOME MEMBER GONE GRANT END')
# The kinds, the first byte, of those items that other modules use.
SEND, CALL, RESPONSE = _numbers(ITEMS, 'SEND CALL RESPONSE')
REST, PARAMETER = _numbers(ITEMS, 'REST PARAMETER')
PUBLISHER, NO_PUBLISHER, SUBSCRIBER, NO_SUBSCRIBER = _numbers(ITEMS, 'PUBLISHER NO_PUBLISHER SUBSCRIBER NO_SUBSCRIBER')
DELIVER, CALL_IN, ANSWER, FOUND, HAPPENED, DELIVERY_CHOSEN = _numbers(
    ITEMS, 'DELIVER CALL_IN ANSWER FOUND HAPPENED DELIVERY_CHOSEN')
WINDOW, ARRIVES, CAME, CHANGED = _numbers(ITEMS, 'WINDOW ARRIVES CAME CHANGED')

_CODES = {'u8': 'B', 'u32': 'I', 'u64': 'Q', 'i32': 'i', 'flag': '?', 'instant': 'q'}
_CODES.update((name, 'B') for name in wire_format.CHOICES)
_U32 = struct.Struct('<I')
_FRAME = struct.Struct('<IB')


class WireError(ValueError):
    """The bytes received are not a frame of this protocol."""


def frame(kind: int, body: bytes = b'') -> bytes:
    """Return a whole frame."""
    return _FRAME.pack(len(body) + 1, kind) + body


def _names_and_kinds(fields: Tuple[str, ...]) -> List[Tuple[str, str]]:
    """Return (name, type) of each field, except for the items, which are appended."""
    pairs = [field.split()[:2] for field in fields]
    return [(name, kind) for kind, name in pairs if kind not in ('ReportItem', 'GrantItem')]


def _kinds(layout: Layout) -> List[str]:
    return [kind for _, kind in _names_and_kinds(layout.fields)]


# --- writing --------------------------------------------------------------------------------------------------------

def text(value: Any) -> bytes:
    """Return a text as bytes, its length before them."""
    return payload(value.encode('utf-8'))


def payload(data: bytes) -> bytes:
    """Return bytes with their length (u32) before them."""
    return _U32.pack(len(data)) + data


def _texts(values: List[str]) -> bytes:
    return b''.join([text(value) for value in values])


def _writer(name: str, fields: Tuple[str, ...], head: Tuple[Tuple[str, int], ...] = ()) -> Callable[..., Any]:
    """Return a function that takes the fields' values and returns their bytes, after ``head``: ((code, number), ...).

    Its source is made here, as in collections.namedtuple, so that it has no loop: it is called for each message.
    """
    kinds = _names_and_kinds(fields)
    lines, terms, names = [], [], {'text': text, '_texts': _texts}
    codes, values = ''.join(code for code, _ in head), [str(number) for _, number in head]

    def end_of_run() -> None:
        nonlocal codes, values
        if codes:
            pack = '_pack{}'.format(len(names))
            names[pack] = struct.Struct('<' + codes).pack
            terms.append('{}({})'.format(pack, ', '.join(values)))
        codes, values = '', []

    for field, kind in kinds:
        if kind == 'text':
            lines.append("    {0} = {0}.encode('utf-8')\n".format(field))
        codes += _CODES.get(kind, 'I')
        values.append(field if kind in _CODES else 'len({})'.format(field))
        if kind not in _CODES:
            end_of_run()
            terms.append('_texts({})'.format(field) if kind == 'texts' else field)
    end_of_run()
    source = 'def {}({}):\n{}    return {}\n'.format(name, ', '.join(field for field, _ in kinds), ''.join(lines),
                                                  ' + '.join(terms) or "b''")
    exec(source, names)
    return names[name]


def _item(name: Any) -> Any:
    """Return the function that makes the item ``name`` of a report."""
    layout = ITEMS[name]
    return _writer(name.lower(), layout.fields, (('B', layout.number),))


advertise, unadvertise = _item('ADVERTISE'), _item('UNADVERTISE')
subscribe, unsubscribe = _item('SUBSCRIBE'), _item('UNSUBSCRIBE')
serve, unserve = _item('SERVE'), _item('UNSERVE')
send, call, response = _item('SEND'), _item('CALL'), _item('RESPONSE')
log, note, watch, at = _item('LOG'), _item('NOTE'), _item('WATCH'), _item('AT')
rest, choose_delivery, background, idle = _item('REST'), _item('CHOOSE_DELIVERY'), _item('BACKGROUND'), _item('IDLE')
keep_until, motion, play = _item('KEEP_UNTIL'), _item('MOTION'), _item('PLAY')
parameter, asks = _item('PARAMETER'), _item('ASKS')

_hello = _writer('hello', FRAMES['HELLO'].fields)
_busy = _writer('busy', FRAMES['BUSY'].fields)
_report = _writer('report', ('u32 length', 'u8 type') + FRAMES['REPORT'].fields)
_REPORT_HEAD = len(_report(0, 0, 0, False, 0, 0)) - 4  # the bytes after the length


def hello(name: str, uri: str, rank: int, rank_declared: bool, incarnation: int, secret: bytes = b'') -> bytes:
    """Return the frame by which a participant presents itself; ``secret``: that of the run, b'' if it has none."""
    return frame(HELLO, _hello(PROTOCOL, name, uri, rank, rank_declared, incarnation, secret))


def report(round_number: int, is_leaving: bool, next_ns: int, open_waits: int, items: List[bytes]) -> bytes:
    """Return the frame of a report; ``next_ns`` [ns] may be NEVER, ``open_waits`` is a number of threads."""
    body = b''.join(items)
    head: bytes = _report(len(body) + _REPORT_HEAD, REPORT, round_number, is_leaving, next_ns, open_waits)
    return head + body


def leave(reason: str) -> bytes:
    """Return the frame by which a participant leaves without a grant."""
    return frame(LEAVE, text(reason))


def stopping(reason: str) -> bytes:
    """Return the frame by which a participant that was told to end says so before it leaves."""
    return frame(STOPPING, text(reason))


def crashing() -> bytes:
    """Return the frame by which a participant says that it ends by its own doing, and not because it is killed."""
    return frame(CRASHING)


def busy(round_number: int, where: str) -> bytes:
    """Return the frame by which a participant says what it is doing, if its work on a grant takes long."""
    return frame(BUSY, _busy(round_number, where))


def looked(is_looked_at: bool) -> bytes:
    """Return the frame by which a participant says that somebody looks at it in a debugger, or no more."""
    return frame(LOOKED, bytes([is_looked_at]))


# --- reading --------------------------------------------------------------------------------------------------------

def read_text(body: bytes, at: int) -> Tuple[str, int]:
    """Return (text, position after it) of the text at position ``at``."""
    data, at = _read_bytes(body, at)
    return data.decode('utf-8'), at


def _read_bytes(body: bytes, at: int) -> Tuple[bytes, int]:
    length, = _U32.unpack_from(body, at)
    at += 4
    if len(body) - at < length:
        raise IndexError('{} bytes of {}'.format(length, len(body) - at))
    return bytes(body[at:at + length]), at + length


def _read_texts(body: bytes, at: int) -> Tuple[List[str], int]:
    count, = _U32.unpack_from(body, at)
    at += 4
    values = []
    for _ in range(count):
        value, at = read_text(body, at)
        values.append(value)
    return values, at


def _reader_of_one(code: str) -> Callable[..., Any]:
    layout = struct.Struct('<' + code)

    def read(body: bytes, at: int) -> Tuple[int, int]:
        return layout.unpack_from(body, at)[0], at + layout.size
    return read


_READERS = {'text': read_text, 'bytes': _read_bytes, 'texts': _read_texts}
_READERS.update((kind, _reader_of_one(code)) for kind, code in _CODES.items())


def _reader(kinds: List[str], head: str = '') -> Callable[..., Any]:
    """Return a function (body, at) -> (tuple of the fields' values, position after them); ``head``: codes before."""
    codes = '<' + head + ''.join(_CODES.get(kind, '') for kind in kinds)
    layout = struct.Struct(codes + ('I' if kinds[-1:] == ['bytes'] else ''))
    unpack_from, size = layout.unpack_from, layout.size
    if all(kind in _CODES for kind in kinds):
        return lambda body, at: (unpack_from(body, at), at + size)
    if kinds[-1] == 'bytes' and all(kind in _CODES for kind in kinds[:-1]):  # the frequent case

        def read(body: bytes, at: int) -> Tuple[Tuple[Union[bytes, int], ...], int]:
            values = unpack_from(body, at)
            begin = at + size
            end = begin + values[-1]
            return values[:-1] + (body[begin:end],), end
        return read
    readers = [_reader_of_one(code) for code in head] + [_READERS[kind] for kind in kinds]

    def read_each(body: bytes, at: int) -> Tuple[Tuple[Any, ...], int]:
        values = []
        for read_one in readers:
            value, at = read_one(body, at)
            values.append(value)
        return tuple(values), at
    return read_each


_read_grant = _reader(_kinds(FRAMES['GRANT']))
_READ_ITEM = {layout.number: _reader(_kinds(layout), 'B') for layout in wire_format.GRANT_ITEMS}
_READ_FRAME = {layout.number: _reader(_kinds(layout)) for layout in wire_format.MASTER_FRAMES}


def read_frame(kind: int, body: bytes) -> Tuple[Any, ...]:
    """Return the values of a frame's fields as a tuple, for a frame of the time master; for a grant, without its items.

    :raises WireError: if the bytes are not a frame of this kind.
    """
    try:
        values: Tuple[Any, ...] = _READ_FRAME[kind](body, 0)[0]
        return values
    except (struct.error, IndexError, KeyError, UnicodeDecodeError) as error:
        raise WireError('a frame of type {} and {} bytes cannot be read: {!r}'.format(kind, len(body), error)) from None


def read_grant(body: bytes) -> Tuple[int, int, int, List[Tuple[Any, ...]]]:
    """Return (round, time [ns], microstep, list of items) of a grant; an item is a tuple that begins with its kind.

    :raises WireError: if the bytes are not a grant.
    """
    at = 0
    try:
        head, at = _read_grant(body, 0)
        end, items = len(body), []
        while at < end:
            item, at = _READ_ITEM[body[at]](body, at)
            items.append(item)
    except (struct.error, IndexError, KeyError, UnicodeDecodeError) as error:
        raise WireError('a grant of {} bytes cannot be read from byte {} on: {!r}'.format(
            len(body), at, error)) from None
    if at != end:
        raise WireError('a grant of {} bytes ends within an item'.format(end))
    return head + (items,)  # type: ignore[no-any-return]
