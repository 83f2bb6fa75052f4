"""Output of a program that manages other processes: it goes on when nobody reads its output any more."""
import os
import sys
from typing import Any, TextIO, cast


class _Lasting:
    """A text stream that is thrown away from the moment on at which its reader has gone."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write; what nobody can read any more counts as written."""
        try:
            return self._stream.write(text)
        except BrokenPipeError:
            self._throw_away()
            return len(text)

    def flush(self) -> None:
        """Hand on what was written."""
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._throw_away()

    def _throw_away(self) -> None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)


def outlive_readers() -> None:
    """Have standard output and standard error last when a pipe behind them is closed (``| head``): no BrokenPipeError.

    For a program that has processes to end and files to finish. What it starts from then on writes nowhere, too.
    """
    sys.stdout = cast(TextIO, _Lasting(sys.stdout))
    sys.stderr = cast(TextIO, _Lasting(sys.stderr))
