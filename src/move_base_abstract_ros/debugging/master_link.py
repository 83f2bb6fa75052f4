"""A connection to the time master of a run that changes nothing in it: it is no node, and no ROS master knows it.

A node that registers would be seen by programs that ask the ROS master who is there.
"""
from __future__ import annotations

import http.client
import io
import select
import socket
import struct
import xmlrpc.client
from typing import Any, Dict, Optional, Tuple, Type

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.msg import TimeState
from move_base_abstract.runs.ends import TIME_MASTER

from ..process.ros_master_watch import proxy_of

_CALLER = '/debug'
_ANSWER_S = 20.0  # wall
_LENGTH = struct.Struct('<I')


class LinkError(SimulatorError):
    """The time master has gone, does not answer, or refuses. The text is for the user."""


class MasterLink:
    """The state of the time master of the run whose ROS master is at ``uri``, and its services.

    :raises LinkError: if it does not answer.
    """

    def __init__(self, uri: str) -> None:
        self._master = proxy_of(uri, _ANSWER_S)
        node = _ask(self._master.lookupNode, TIME_MASTER)
        answer = _ask(proxy_of(node, _ANSWER_S).requestTopic, TIME_MASTER + '/state', [['TCPROS']])
        self._states = _connected((answer[1], answer[2]), {
            'topic': TIME_MASTER + '/state', 'type': TimeState._type, 'md5sum': TimeState._md5sum})
        self._read = b''
        self.state: Any = None  # the latest TimeState

    def close(self) -> None:
        """Close the connection."""
        self._states.close()

    def fileno(self) -> int:
        """Return the descriptor on which states come, for select()."""
        return self._states.fileno()

    def take(self) -> bool:
        """Take the states that have come; return whether there is one.

        :raises LinkError: if the time master has closed the connection, as it does at its end.
        """
        is_newer = False
        while select.select([self._states], [], [], 0.0)[0]:
            try:
                piece = self._states.recv(1 << 16)
            except OSError as error:
                raise LinkError('the time master has gone: {}'.format(error.strerror)) from None
            if not piece:
                raise LinkError('the time master has ended')
            self._read += piece
            is_newer = self._take_last() or is_newer
        return is_newer

    def _take_last(self) -> bool:
        """Take the last whole state of what was read; return whether there is one."""
        last: Optional[bytes] = None
        while len(self._read) >= _LENGTH.size:
            end = _LENGTH.size + _LENGTH.unpack_from(self._read)[0]
            if len(self._read) < end:
                break
            last, self._read = self._read[_LENGTH.size:end], self._read[end:]
        if last is not None:
            self.state = TimeState().deserialize(last)
        return last is not None

    def call(self, name: str, kind: Type[Any], *values: Any) -> Any:
        """Call the time master's service ``name`` of this kind; return its answer.

        :raises LinkError: if it refuses, with its own text, or does not answer.
        """
        host, port = _ask(self._master.lookupService, '{}/{}'.format(TIME_MASTER, name)).rpartition('//')[2].split(':')
        with _connected((host, int(port.strip('/'))), {
                'service': '{}/{}'.format(TIME_MASTER, name), 'md5sum': kind._md5sum}) as stream:
            request, buffer = kind._request_class(*values), io.BytesIO()
            request.serialize(buffer)
            stream.sendall(_LENGTH.pack(len(buffer.getvalue())) + buffer.getvalue())
            is_well, body = _received(stream, 1), _received(stream)
        if is_well != b'\1':
            raise LinkError('{}: {}'.format(name, body.decode('utf-8', 'replace')))
        answer = kind._response_class().deserialize(body)
        if not answer.success:
            raise LinkError(answer.message)
        return answer


def _ask(function: Any, *words: Any) -> Any:
    """Return the value of a call of the ROS master or of a node."""
    try:
        code, text, value = function(_CALLER, *words)
    except (OSError, http.client.HTTPException, xmlrpc.client.Error, ValueError) as error:
        raise LinkError('the run does not answer: {}'.format(error)) from None
    if code != 1:
        raise LinkError('the run does not answer: {}'.format(text))
    return value


def _connected(address: Tuple[str, int], header: Dict[str, str]) -> socket.socket:
    """Return a connection of TCPROS with this header."""
    fields = ['{}={}'.format(*one).encode() for one in {'callerid': _CALLER, 'tcp_nodelay': '1', **header}.items()]
    text = b''.join(_LENGTH.pack(len(field)) + field for field in fields)
    try:
        stream = socket.create_connection(address, _ANSWER_S)
    except OSError as error:
        raise LinkError('the time master does not answer: {}'.format(error)) from None
    stream.sendall(_LENGTH.pack(len(text)) + text)
    answer = _received(stream)
    if b'error=' in answer:
        stream.close()
        raise LinkError('the time master refuses the connection: {}'.format(
            answer.partition(b'error=')[2].decode('utf-8', 'replace')))
    return stream


def _received(stream: socket.socket, size: int = 0) -> bytes:
    """Return so many bytes; 0: as many as a length before them says."""
    if not size:
        size = _LENGTH.unpack(_received(stream, _LENGTH.size))[0]
    found = b''
    while len(found) < size:
        try:
            piece = stream.recv(size - len(found))
        except OSError as error:
            raise LinkError('the time master does not answer: {}'.format(error)) from None
        if not piece:
            raise LinkError('the time master has closed the connection')
        found += piece
    return found
