"""The bytes between a participant and the time master: frames, report items out, grant items in.

docs/lockstep_protocol.md describes them. All numbers are little endian; a frame is its length (u32), its type (u8) and
its body; a text or a payload is its length (u32) and its bytes.
"""
import struct

PROTOCOL = 2
NEVER = 2 ** 63 - 1
MAX_RANK = 2 ** 31 - 1  # a rank has 32 bits with its sign

HELLO, REPORT, KNOCK, LEAVE = 1, 2, 3, 4
WELCOME, MEMBER, GONE, GRANT, END = 16, 17, 18, 19, 20

LEAVING = 1  # flag of a report: it is the last one

# kinds of items in a report
ADVERTISE, UNADVERTISE, SUBSCRIBE, UNSUBSCRIBE, SEND, SERVE, UNSERVE, CALL, RESPONSE, LOG, NOTE, WATCH = range(1, 13)
# kinds of items in a grant
PUBLISHER, NO_PUBLISHER, SUBSCRIBER, NO_SUBSCRIBER, DELIVER, CALLED, ANSWERED, FOUND = range(1, 9)
# what a NOTE says
WAITS_FOR, NOT_REPEATABLE, DEGRADED = 1, 2, 3
# how a call was answered
ANSWER_ERROR, ANSWER_OK, ANSWER_UNKNOWN, ANSWER_GONE = 0, 1, 2, 3

_U32 = struct.Struct('<I')
_FRAME = struct.Struct('<IB')
_REPORT = struct.Struct('<IBQBqI')
_GRANT = struct.Struct('<QqI')
_SEND = struct.Struct('<BIIII')
_TWO = struct.Struct('<II')
_DELIVER = struct.Struct('<III')
_CALLED = struct.Struct('<IIII')
_ANSWERED = struct.Struct('<IBI')


class WireError(ValueError):
    """What came is no frame of this protocol."""


def text(value):
    """Return a text as bytes."""
    data = value.encode('utf-8')
    return _U32.pack(len(data)) + data


def payload(data):
    """Return bytes with their length before them."""
    return _U32.pack(len(data)) + data


def frame(kind, body=b''):
    """Return a whole frame."""
    return _FRAME.pack(len(body) + 1, kind) + body


def hello(name, uri, rank, rank_declared, incarnation, secret=b''):
    """Return the frame by which a participant presents itself; ``secret`` (bytes) is the run's, if it has one."""
    return frame(HELLO, _U32.pack(PROTOCOL) + text(name) + text(uri)
                 + struct.pack('<iBQ', rank, rank_declared, incarnation) + payload(secret))


def report(round_number, flags, next_ns, open_waits, items):
    """Return a report; ``items`` is a list of bytes, ``next_ns`` [ns] may be NEVER."""
    body = b''.join(items)
    return _REPORT.pack(len(body) + 22, REPORT, round_number, flags, next_ns, open_waits) + body


def advertise(topic, sub, name, type_name, md5, latched, definition):
    """Return the item that says: I publish this."""
    return (struct.pack('<BII', ADVERTISE, topic, sub) + text(name) + text(type_name) + text(md5)
            + struct.pack('<B', latched) + text(definition))


def subscribe(topic, sub, name, md5):
    """Return the item that says: I listen to this."""
    return struct.pack('<BII', SUBSCRIBE, topic, sub) + text(name) + text(md5)


def end_of(kind, number):
    """Return the item UNADVERTISE, UNSUBSCRIBE or UNSERVE."""
    return struct.pack('<BI', kind, number)


def send(topic, sub, target, data):
    """Return the item with a message; ``target`` 0 means all who listen."""
    return _SEND.pack(SEND, topic, sub, target, len(data)) + data


def serve(service, sub, name):
    """Return the item that says: I offer this service."""
    return struct.pack('<BII', SERVE, service, sub) + text(name)


def call(number, sub, service, request):
    """Return the item with a service call."""
    return struct.pack('<BII', CALL, number, sub) + text(service) + payload(request)


def response(caller, number, is_ok, data):
    """Return the item with the answer to a service call."""
    return struct.pack('<BIIB', RESPONSE, caller, number, is_ok) + payload(data)


def log(sub, robot, kind, values):
    """Return the item with a line of the event log; ``values`` is a JSON array."""
    return struct.pack('<BI', LOG, sub) + text(robot) + text(kind) + text(values)


def note(what, value):
    """Return the item NOTE."""
    return struct.pack('<BB', NOTE, what) + text(value)


def watch(service):
    """Return the item that asks to be told when a service is offered."""
    return struct.pack('<B', WATCH) + text(service)


def read_text(body, at):
    """Return (text, position after it)."""
    length, = _U32.unpack_from(body, at)
    at += 4
    return bytes(body[at:at + length]).decode('utf-8'), at + length


def read_grant(body):
    """Return (round, time [ns], microstep, list of items) of a grant; an item is a tuple that begins with its kind.

    :raises WireError: if it is none.
    """
    at = 0
    try:
        round_number, time_ns, microstep = _GRANT.unpack_from(body, 0)
        at, end, items = _GRANT.size, len(body), []
        while at < end:
            item, at = _READERS[body[at]](body, at)
            items.append(item)
    except (struct.error, IndexError, KeyError, UnicodeDecodeError) as error:
        raise WireError('a grant of {} bytes has something else at byte {}: {!r}'.format(
            len(body), at, error)) from None
    if at != end:
        raise WireError('a grant of {} bytes ends within an item'.format(end))
    return round_number, time_ns, microstep, items


# Each reads the item at ``at``, its kind included, and returns it and the position after it.

def _read_publisher(body, at):
    topic, sender = _TWO.unpack_from(body, at + 1)
    type_name, at = read_text(body, at + 9)
    md5, at = read_text(body, at)
    latched = body[at]
    definition, at = read_text(body, at + 1)
    return (PUBLISHER, topic, sender, type_name, md5, bool(latched), definition), at


def _read_two(body, at):
    return (body[at],) + _TWO.unpack_from(body, at + 1), at + 9


def _read_deliver(body, at):
    topic, sender, length = _DELIVER.unpack_from(body, at + 1)
    at += 13 + length
    return (DELIVER, topic, sender, bytes(body[at - length:at])), at


def _read_called(body, at):
    service, caller, number, length = _CALLED.unpack_from(body, at + 1)
    at += 17 + length
    return (CALLED, service, caller, number, bytes(body[at - length:at])), at


def _read_answered(body, at):
    number, status, length = _ANSWERED.unpack_from(body, at + 1)
    at += 10 + length
    return (ANSWERED, number, status, bytes(body[at - length:at])), at


def _read_found(body, at):
    name, at = read_text(body, at + 1)
    return (FOUND, name), at


_READERS = {PUBLISHER: _read_publisher, NO_PUBLISHER: _read_two, SUBSCRIBER: _read_two, NO_SUBSCRIBER: _read_two,
            DELIVER: _read_deliver, CALLED: _read_called, ANSWERED: _read_answered, FOUND: _read_found}
