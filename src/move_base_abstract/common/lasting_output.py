"""Output of a program that manages other processes and so must go on when nobody reads its output any more."""
import os
import select
import sys
from typing import Any, TextIO, cast

_poll = select.poll  # taken before it is replaced in programs that take part


class _Lasting:
    """A text stream whose text is thrown away as soon as its reader has gone."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write ``text``; if there is no reader any more, it counts as written."""
        try:
            return self._stream.write(text)
        except BrokenPipeError:
            self._throw_away()
            return len(text)

    def flush(self) -> None:
        """Flush the stream, if there is still a reader."""
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._throw_away()

    def _throw_away(self) -> None:
        _throw_away(self._stream.fileno())


def _throw_away(descriptor: int) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def drop_unread_outputs() -> None:
    """Throw away, from now on, what this process prints to a pipe whose reader has gone: its end must not fail of it.

    This holds for all that print: handlers of logging, libraries, programs that it starts.
    """
    looks = _poll()
    for descriptor in (1, 2):
        looks.register(descriptor, 0)
    for descriptor, events in looks.poll(0):
        if events & select.POLLERR:
            _throw_away(descriptor)


def outlive_readers() -> None:
    """Make standard output and standard error raise no BrokenPipeError when their pipe is closed (``| head``).

    This is for a program that has processes to end and files to finish. The output of programs that it starts after the
    pipe was closed is thrown away, too.
    """
    sys.stdout = cast(TextIO, _Lasting(sys.stdout))
    sys.stderr = cast(TextIO, _Lasting(sys.stderr))
