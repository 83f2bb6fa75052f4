"""The link between a script that starts runs and its deputy, the node that takes part in each run for the script.

Requests and answers are pickled, on a Unix socket in a folder that only this user can enter. Only one of the two speaks
at a time. The deputy answers a request by ANSWER or ERROR. Before that it may send any number of CALLBACKs. The script
answers each of them by DONE, with the result of the function, and may send requests of its own before that.
"""
import pickle
import socket
import struct

REQUEST, ANSWER, ERROR, CALLBACK, DONE = range(5)
_LENGTH = struct.Struct('<Q')


class LinkClosed(Exception):
    """The other side has gone."""


class Link:
    """Whole messages, one after the other, over a connected socket."""

    def __init__(self, connected):
        self._socket = connected
        connected.settimeout(None)  # a script may have set a time limit for all its new sockets

    def send(self, *words):
        """Send a message of ``words``, which can be anything that can be pickled.

        :raises LinkClosed: if the other side has gone.
        """
        body = pickle.dumps(words)
        try:
            self._socket.sendall(_LENGTH.pack(len(body)) + body)
        except OSError as error:
            raise LinkClosed(str(error)) from None

    def receive(self):
        """Wait for a message, and return its words.

        :raises LinkClosed: if the other side has gone.
        """
        return pickle.loads(self._read(_LENGTH.unpack(self._read(_LENGTH.size))[0]))

    def close(self):
        """End the connection."""
        self._socket.close()

    def _read(self, size):
        data = bytearray()
        while len(data) < size:
            try:
                part = self._socket.recv(min(size - len(data), 1 << 20))
            except OSError as error:
                raise LinkClosed(str(error)) from None
            if not part:
                raise LinkClosed('the other side has gone')
            data += part
        return bytes(data)


def connect(address):
    """Return the Link to the script, which listens at ``address``, the path of a Unix socket."""
    connected = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    connected.connect(address)
    return Link(connected)


class Function:
    """Stands for the ``number``-th function of the script in messages to the deputy."""

    def __init__(self, number):
        self.number = number


class Thing:
    """Stands for an object that the deputy has made for the script, such as a subscriber, in messages to the deputy."""

    def __init__(self, number):
        self.number = number
