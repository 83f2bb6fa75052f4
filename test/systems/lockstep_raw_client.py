"""A participant without any library, which speaks the protocol of docs/lockstep_protocol.md byte by byte.

    client = RawClient(address)        # 'host:port', the parameter /time_master/lockstep_address
    client.hello('/a')
    grant = client.grant()             # waits; Grant(round, time_ns, microstep, items)
    client.report(grant, next_ns=grant.time_ns + 10 ** 9, items=send(1, b'payload'))

Every wait ends with an AssertionError after GUARD [s, wall].
"""

import socket
import struct
import time
from typing import NamedTuple

import rosgraph
from waiting import GUARD, wait_for

ADDRESS = '/time_master/lockstep_address'
PROTOCOL = 12
NEVER = 2 ** 63 - 1

HELLO, REPORT, KNOCK, LEAVE, STOPPING = 1, 2, 3, 4, 5
WELCOME, MEMBER, GONE, GRANT, END = 16, 17, 18, 19, 20


class Closed(Exception):
    """The time master has closed the connection."""


class Grant(NamedTuple):
    """A GRANT frame; items are tuples that begin with their name."""

    round: int
    time_ns: int
    microstep: int
    items: list


class Reader:
    """The fields of a frame, one after the other."""

    def __init__(self, data):
        self._data = data
        self._at = 0

    def more(self):
        return self._at < len(self._data)

    def number(self, code):
        size = struct.calcsize('<' + code)
        value = struct.unpack_from('<' + code, self._data, self._at)[0]
        self._at += size
        return value

    def data(self):
        size = self.number('I')
        value = self._data[self._at:self._at + size]
        assert len(value) == size
        self._at += size
        return value

    def text(self):
        return self.data().decode()

    def fields(self, codes):
        """Read the fields of ``codes``: letters of struct, s for a text, b for bytes."""
        plain = {'s': self.text, 'b': self.data}
        return tuple(plain[code]() if code in plain else self.number(code) for code in codes)


GRANT_ITEMS = {1: ('publisher', 'IIssBs'), 2: ('no_publisher', 'II'), 3: ('subscriber', 'II'),
               4: ('no_subscriber', 'II'), 5: ('deliver', 'IIb'), 6: ('call', 'IIIb'), 7: ('response', 'IBb'),
               8: ('found', 's'), 11: ('window', 'qq')}


def text(value):
    data = value.encode() if isinstance(value, str) else value
    return struct.pack('<I', len(data)) + data


def frame(kind, body=b''):
    return struct.pack('<IB', len(body) + 1, kind) + body


def advertise(topic, name, type_name='std_msgs/String', md5='m', latched=False, sub=0):
    return (struct.pack('<BII', 1, topic, sub) + text(name) + text(type_name) + text(md5) + struct.pack('<B', latched)
            + text('string data'))


def subscribe(topic, name, md5='*', sub=0):
    return struct.pack('<BII', 3, topic, sub) + text(name) + text(md5)


def send(topic, payload, sub=0, target=0):
    return struct.pack('<BIII', 5, topic, sub, target) + text(payload)


def serve(service, name, sub=0):
    return struct.pack('<BII', 6, service, sub) + text(name)


def call(number, name, request=b'', sub=0):
    return struct.pack('<BII', 8, number, sub) + text(name) + text(request)


def respond(caller, number, payload, good=True):
    return struct.pack('<BIIB', 9, caller, number, good) + text(payload)


def log(robot, kind, values, sub=0):
    return struct.pack('<BI', 10, sub) + text(robot) + text(kind) + text(values)


def note(what, value):
    return struct.pack('<BB', 11, what) + text(value)


class RawClient:
    """One connection to a time master in lockstep."""

    def __init__(self, address):
        host, port = address.rsplit(':', 1)
        self.socket = socket.create_connection((host, int(port)), timeout=GUARD)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._buffer = b''
        self.own_id = None
        self.rank = None
        self.members = {}  # id: name

    def close(self):
        self.socket.close()

    def hello(self, name, rank=0, rank_declared=False, uri='http://127.0.0.1:1/', protocol=PROTOCOL, incarnation=1,
              secret=b''):
        """Say hello, wait for the answer, and return the client."""
        self.socket.sendall(frame(HELLO, struct.pack('<I', protocol) + text(name) + text(uri)
                                  + struct.pack('<iBQ', rank, rank_declared, incarnation) + text(secret)))
        kind, reader = self.receive()
        assert kind == WELCOME, (kind, reader.text() if kind == END else None)
        self.own_id, self.rank, self.leave_limit_ns = reader.fields('Iiq')
        self.busy_limit_ns, = reader.fields('q')
        self.excluded_topics = [reader.text() for _ in range(reader.number('I'))]
        return self

    def receive(self, timeout=GUARD):
        """Return (kind, Reader) of the next frame. Raises Closed, or socket.timeout after timeout [s, wall]."""
        self.socket.settimeout(timeout)
        while len(self._buffer) < 4 or len(self._buffer) < 4 + struct.unpack_from('<I', self._buffer)[0]:
            try:
                data = self.socket.recv(1 << 16)
            except ConnectionResetError:
                data = b''
            if not data:
                raise Closed
            self._buffer += data
        size = struct.unpack_from('<I', self._buffer)[0]
        body, self._buffer = self._buffer[4:4 + size], self._buffer[4 + size:]
        return body[0], Reader(body[1:])

    def grant(self, timeout=GUARD):
        """Wait for the next grant, and keep track of the members meanwhile. Raises Closed at the end."""
        deadline = time.monotonic() + timeout
        while True:
            kind, reader = self.receive(max(0.001, deadline - time.monotonic()))
            if kind == GRANT:
                head = reader.fields('QqI')
                items = []
                while reader.more():
                    name, codes = GRANT_ITEMS[reader.number('B')]
                    items.append((name, *reader.fields(codes)))
                return Grant(*head, items)
            if kind == MEMBER:
                self.members.update([reader.fields('Is')])
            elif kind == GONE:
                self.members.pop(reader.number('I'))
            else:
                assert kind == END, kind
                raise Closed(reader.text())

    def end(self, timeout=GUARD):
        """Wait for END and return its reason."""
        try:
            while True:
                self.grant(timeout)
        except Closed as closed:
            return str(closed)

    def report(self, grant, next_ns=NEVER, items=b'', waiting=0, leaving=False):
        """Report on a grant; waiting: the number of threads that wait without end."""
        self.socket.sendall(frame(REPORT, struct.pack('<QBqI', grant.round, leaving, next_ns, waiting) + items))

    def turn(self, **report):
        """Wait for a grant, report on it with these arguments, and return it."""
        grant = self.grant()
        self.report(grant, **report)
        return grant

    def knock(self):
        self.socket.sendall(frame(KNOCK))

    def leave(self, reason='done'):
        self.socket.sendall(frame(LEAVE, text(reason)))


def address_at(uri):
    """Wait until the ROS master at ``uri`` has the address of a time master; return it."""
    master = rosgraph.Master('/test', master_uri=uri)
    return wait_for('the address', lambda: master.hasParam(ADDRESS) and master.getParam(ADDRESS))
