"""The link between a script that starts runs and its deputy, the node that takes part in each run for the script.

Requests and answers are pickled, on a Unix socket in a folder that only this user can enter. Only one of the two speaks
at a time. The deputy answers a request by ANSWER or ERROR. Before that it may send any number of CALLBACKs. The script
answers each of them by DONE, with the result of the function, and may send requests of its own before that.
"""
from multiprocessing.connection import Client

REQUEST, ANSWER, ERROR, CALLBACK, DONE = range(5)


class LinkClosed(Exception):
    """The other side has gone."""


class Link:
    """Whole messages, one after the other, over a multiprocessing.connection.Connection."""

    def __init__(self, connection):
        self._connection = connection
        self.close = connection.close

    def send(self, *words):
        """Send a message of ``words``, which can be anything that can be pickled.

        :raises LinkClosed: if the other side has gone.
        """
        try:
            self._connection.send(words)
        except OSError as error:
            raise LinkClosed(str(error)) from None

    def receive(self):
        """Wait for a message, and return its words.

        :raises LinkClosed: if the other side has gone.
        """
        try:
            return self._connection.recv()
        except (EOFError, OSError) as error:
            raise LinkClosed(str(error)) from None


def connect(address):
    """Return the Link to the script, which listens at ``address``, the path of a Unix socket."""
    return Link(Client(address, 'AF_UNIX'))


class Function:
    """Stands for the ``number``-th function of the script in messages to the deputy."""

    def __init__(self, number):
        self.number = number


class Thing:
    """Stands for an object that the deputy has made for the script, such as a subscriber, in messages to the deputy."""

    def __init__(self, number):
        self.number = number
