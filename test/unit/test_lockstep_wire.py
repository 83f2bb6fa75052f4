"""What a participant writes is what the page of the protocol says, and what comes is read or refused."""

import struct

import pytest

from move_base_abstract.lockstep import wire


def u32(value):
    return struct.pack('<I', value)


def grant(*items, number=7, time_ns=1_500_000_000, microstep=3):
    return struct.pack('<QqI', number, time_ns, microstep) + b''.join(items)


def test_a_frame_is_its_length_its_type_and_its_body():
    assert wire.frame(wire.KNOCK) == b'\x01\0\0\0\x03'
    assert wire.leave('ab') == b'\x07\0\0\0\x04\x02\0\0\0ab'
    assert wire.busy(3, 'ab') == b'\x0f\0\0\0\x06\x03\0\0\0\0\0\0\0\x02\0\0\0ab'
    assert wire.stopping('ab') == b'\x07\0\0\0\x05\x02\0\0\0ab'


def test_texts_are_utf_8_and_counted_in_bytes():
    assert wire.text('Zürich') == u32(7) + 'Zürich'.encode()
    assert wire.read_text(b'xx' + wire.text('Zürich') + b'yy', 2) == ('Zürich', 13)


def test_hello():
    body = (u32(wire.PROTOCOL) + wire.text('/a') + wire.text('http://h:1/') + struct.pack('<i', -2) + b'\x01'
            + struct.pack('<Q', 2 ** 64 - 1) + wire.payload(b'\xff'))
    assert wire.hello('/a', 'http://h:1/', -2, True, 2 ** 64 - 1, b'\xff') == u32(len(body) + 1) + b'\x01' + body


def test_a_report_has_round_flags_next_and_open_waits_before_its_items():
    items = [wire.send(1, 2, 3, b'abc'), wire.watch('/s')]
    body = struct.pack('<QBqI', 9, True, wire.NEVER, 4) + b''.join(items)
    assert wire.report(9, True, wire.NEVER, 4, items) == u32(len(body) + 1) + b'\x02' + body


def test_never_is_the_largest_time():
    assert struct.pack('<q', wire.NEVER) == b'\xff' * 7 + b'\x7f'


ITEMS = [
    (b'\x01' + u32(1) + u32(2) + wire.text('a/B') + wire.text('md5') + b'\x01' + wire.text('def'),
     (wire.PUBLISHER, 1, 2, 'a/B', 'md5', True, 'def')),
    (b'\x02' + u32(1) + u32(2), (wire.NO_PUBLISHER, 1, 2)),
    (b'\x03' + u32(1) + u32(2), (wire.SUBSCRIBER, 1, 2)),
    (b'\x04' + u32(1) + u32(2), (wire.NO_SUBSCRIBER, 1, 2)),
    (b'\x05' + u32(1) + u32(2) + u32(3) + b'xyz', (wire.DELIVER, 1, 2, b'xyz')),
    (b'\x06' + u32(1) + u32(2) + u32(3) + u32(1) + b'q', (wire.CALL_IN, 1, 2, 3, b'q')),
    (b'\x07' + u32(3) + b'\x02' + u32(0), (wire.ANSWER, 3, wire.CallStatus.NO_SERVER, b'')),
    (b'\x08' + wire.text('/s'), (wire.FOUND, '/s')),
]
IDS = ['publisher', 'no_publisher', 'subscriber', 'no_subscriber', 'deliver', 'call_in', 'answer', 'found']


@pytest.mark.parametrize('data, expected', ITEMS, ids=IDS)
def test_items_of_a_grant(data, expected):
    assert wire.read_grant(grant(data)) == (7, 1_500_000_000, 3, [expected])


def test_a_grant_keeps_its_items_in_order():
    data, expected = zip(*ITEMS)
    assert wire.read_grant(grant(*reversed(data)))[3] == list(reversed(expected))
    assert wire.read_grant(grant())[3] == []


@pytest.mark.parametrize('data', [data for data, _ in ITEMS], ids=IDS)
def test_a_grant_that_is_cut_off_is_refused_wherever_the_cut_is(data):
    for length in range(1, len(data)):
        with pytest.raises(wire.WireError):
            wire.read_grant(grant(data[:length]))


@pytest.mark.parametrize('length', [0, 8, 19])
def test_a_grant_without_its_head_is_refused(length):
    with pytest.raises(wire.WireError):
        wire.read_grant(grant()[:length])


@pytest.mark.parametrize('kind', [0, 15, 255])
def test_an_unknown_item_is_refused_and_named(kind):
    with pytest.raises(wire.WireError, match=str(kind)):
        wire.read_grant(grant(bytes([kind])))


def test_a_text_that_is_not_utf_8_is_refused():
    with pytest.raises(wire.WireError):
        wire.read_grant(grant(b'\x08' + u32(1) + b'\xff'))
