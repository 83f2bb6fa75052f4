"""The connection to the time master, which sends and receives whole frames."""
from __future__ import annotations

import _thread
import socket
import struct
import time
from contextlib import suppress
from typing import Any, Callable, Tuple

from move_base_abstract.lockstep import wire
from move_base_abstract.lockstep.own_cores import own_cores

_HEAD = struct.Struct('<IB')
_RECEIVE_BYTES = 1 << 16
_RETRY_SECONDS = 0.05


class Closed(Exception):
    """The connection has ended, because the time master is gone or has closed it."""


class Connection:
    """A blocking connection that keeps the order of frames. Any thread may send; one thread at a time may receive."""

    def __init__(self, host: str, port: int, timeout: float) -> None:
        """Connect to the time master.

        :raises OSError: if there is no time master at that address within ``timeout`` [s, wall].
        """
        own_cores.remember()
        self._socket = _connect_locally(host, port) or _connect(host, port, timeout)
        # Recursive, since a signal may make the main thread leave in the middle of sending.
        self._send_lock = _thread.RLock()  # type: ignore[attr-defined]
        self._buffer = bytearray()
        self.before_close: Callable[[], None] = lambda: None

    def fileno(self) -> int:
        """Return the socket's descriptor."""
        return self._socket.fileno()

    def send(self, data: bytes) -> None:
        """Send whole frames.

        :raises Closed: if the connection has ended.
        """
        try:
            with self._send_lock:
                self._socket.sendall(data)
        except OSError as error:
            raise Closed(str(error)) from None

    def try_to_send(self, data: bytes) -> None:
        """Send whole frames; do nothing if the connection has ended."""
        with suppress(Closed):
            self.send(data)

    def receive(self) -> Tuple[int, bytes]:
        """Wait for a frame and return (type, body).

        :raises Closed: if the connection has ended.
        :raises WireError: if the bytes are not a frame.
        """
        buffer = self._buffer
        while True:
            if len(buffer) >= 5:
                length, kind = _HEAD.unpack_from(buffer, 0)
                if length < 1:
                    raise wire.WireError('a frame of {} bytes'.format(length))
                if len(buffer) >= 4 + length:
                    body = bytes(buffer[5:4 + length])
                    del buffer[:4 + length]
                    return kind, body
            try:
                data = self._socket.recv(_RECEIVE_BYTES)
            except OSError as error:
                raise Closed(str(error)) from None
            if not data:
                raise Closed('the time master has closed the connection')
            if not buffer and len(data) > 5 and _HEAD.unpack_from(data)[0] == len(data) - 4:
                return data[4], data[5:]  # exactly one whole frame, as nearly always
            buffer += data

    def close(self, at_exit: bool = False) -> None:
        """End the connection; a thread that waits in :meth:`receive` gets :class:`Closed`.

        With ``at_exit`` the time master notices the end when this process has ended, not before.
        """
        try:
            self._socket.shutdown(socket.SHUT_RD if at_exit else socket.SHUT_RDWR)
        except OSError:
            pass
        if not at_exit:
            self.forget()

    def forget(self) -> None:
        """Close the connection in this process only, a forked child, whose parent goes on using it."""
        self.before_close()
        self._socket.close()
        own_cores.restore()


def _connect_locally(host: str, port: int) -> Any:
    """Return a Unix socket to the time master, or None if it is on another computer or does not run."""
    connected = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    connected.settimeout(None)  # a wait may be longer than the 60 s that rospy sets for all sockets of the process
    try:
        connected.connect('\0move_base_abstract/{}:{}'.format(host, port))
        return connected
    except OSError:
        connected.close()
        return None


def _connect(host: str, port: int, timeout: float) -> Any:
    deadline = time.monotonic() + timeout
    while True:
        try:
            connected = socket.create_connection((host, port), timeout=max(_RETRY_SECONDS, deadline - time.monotonic()))
            connected.settimeout(None)
            connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return connected
        except OSError:
            if time.monotonic() >= deadline:
                raise
            time.sleep(_RETRY_SECONDS)
