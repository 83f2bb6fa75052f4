"""Requests to the warm process of `lockstep_launch` to become a node, and its answers, on a pair of sockets."""
import array
import json
import socket
import struct
from typing import NamedTuple

_LENGTH = struct.Struct('<I')


class Request(NamedTuple):
    """A request to start a node.

    ``words``: the command line; ``cwd``: the working folder; ``outputs``: descriptors of the standard output and the
    standard error output. Only the first request is different: its words are the paths of scripts to come.
    """

    words: list
    environment: dict
    cwd: str
    outputs: list


def send(sock, asked):
    """Send a Request."""
    body = json.dumps(asked[:-1]).encode()
    rights = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array('i', asked.outputs))] if asked.outputs else []
    sock.sendmsg([_LENGTH.pack(len(body))], rights)
    sock.sendall(body)


def receive(sock):
    """Return the next Request, or None if the other end is closed."""
    outputs = array.array('i')
    head, ancillary, _, _ = sock.recvmsg(_LENGTH.size, socket.CMSG_SPACE(2 * outputs.itemsize))
    for level, kind, data in ancillary:
        if (level, kind) == (socket.SOL_SOCKET, socket.SCM_RIGHTS):
            outputs.frombytes(data[:len(data) - len(data) % outputs.itemsize])
    body = _read(sock, _LENGTH.unpack(head)[0]) if len(head) == _LENGTH.size else None
    return None if body is None else Request(*json.loads(body), list(outputs))


def answer(sock, value):
    """Send an answer: a number or a list."""
    body = json.dumps(value).encode()
    sock.sendall(_LENGTH.pack(len(body)) + body)


def receive_answer(sock):
    """Return the next answer. :raises OSError: if the warm process does not answer any more."""
    head = _read(sock, _LENGTH.size)
    body = None if head is None else _read(sock, _LENGTH.unpack(head)[0])
    if body is None:
        raise ConnectionResetError('the warm process has ended')
    return json.loads(body)


def _read(sock, size):
    """Return ``size`` bytes, or None if the other end is closed."""
    found = b''
    while len(found) < size:
        part = sock.recv(size - len(found))
        if not part:
            return None
        found += part
    return found
