"""Output of a program that manages other processes and so must go on when nobody reads its output any more."""
import os
import sys
from typing import Any, TextIO, cast


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
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)


def outlive_readers() -> None:
    """Make standard output and standard error raise no BrokenPipeError when their pipe is closed (``| head``).

    This is for a program that has processes to end and files to finish. The output of programs that it starts after the
    pipe was closed is thrown away, too.
    """
    sys.stdout = cast(TextIO, _Lasting(sys.stdout))
    sys.stderr = cast(TextIO, _Lasting(sys.stderr))
