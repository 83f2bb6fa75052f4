"""The only way to open files that users name: they must be regular files of a bounded size.

A program that opens a pipe would wait, for ever if nobody writes to it, and a device may never end. Symbolic links are
followed.
"""
from __future__ import annotations

import contextlib
import hashlib
import io
import os
import stat
from typing import IO, TYPE_CHECKING, Any, Callable, Iterator, Optional

from .arguments import check_path
from .errors import ConfigurationError
from .shown import shown_text

if TYPE_CHECKING:
    from .type_names import StrPath

_PIECE = 1 << 20  # bytes
_KINDS = ((stat.S_ISDIR, 'a folder'), (stat.S_ISFIFO, 'a pipe'), (stat.S_ISSOCK, 'a socket'))


@contextlib.contextmanager
def open_input(path: StrPath, most: Optional[int] = None, error_type: Callable[[str], Exception] = ConfigurationError,
               what: str = 'file') -> Iterator[IO[bytes]]:
    """Open the file ``path``, of at most ``most`` bytes (None: any number), to be read in binary.

    An error of the operating system in the with block becomes an error that names the file, too. ``what`` names the
    kind of file in error texts.

    :raises error_type: if it is not a regular file, is too large, or cannot be read; the text names the path.
    """
    check_path(path, 'path')
    shown_path = shown_text(os.fspath(path))
    try:
        # O_NONBLOCK: do not wait for a pipe's writer; it changes nothing for a regular file.
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except (OSError, ValueError) as error:  # ValueError: a path with a zero byte
        raise error_type('{}: cannot be read: {}'.format(
            shown_path, getattr(error, 'strerror', None) or error)) from None
    with contextlib.ExitStack() as stack:
        stack.callback(os.close, descriptor)
        about = os.fstat(descriptor)
        if not stat.S_ISREG(about.st_mode):
            kind = next((name for is_kind, name in _KINDS if is_kind(about.st_mode)), 'a device')
            raise error_type('{}: is {}; allowed: a {}'.format(shown_path, kind, what))
        if most is not None and about.st_size > most:
            raise error_type('{}: has {} bytes; allowed: a {} of at most {}'.format(
                shown_path, about.st_size, what, most))
        stream = stack.enter_context(open(descriptor, 'rb', closefd=False))
        try:
            yield stream
        except OSError as error:
            if error.errno is None:  # raised by a library, not by the operating system
                raise
            raise error_type('{}: cannot be read: {}'.format(shown_path, error.strerror)) from None


@contextlib.contextmanager
def open_text_input(path: StrPath, most: Optional[int] = None,
                    error_type: Callable[[str], Exception] = ConfigurationError, what: str = 'file',
                    **options: Any) -> Iterator[IO[str]]:
    """Open a text file as :func:`open_input` does; ``options``: encoding, errors and newline of open()."""
    with open_input(path, most, error_type, what) as stream:
        with io.TextIOWrapper(stream, **{'encoding': 'utf-8', **options}) as text:
            yield text


def check_input(path: StrPath, most: Optional[int] = None, error_type: Callable[[str], Exception] = ConfigurationError,
                what: str = 'file') -> None:
    """Check as :func:`open_input` does that ``path`` may be read, for libraries that open it themselves."""
    with open_input(path, most, error_type, what):
        pass


def sha256_of(path: str) -> str:
    """Return the SHA-256 of a regular file's content, in hexadecimal. :raises OSError: if it cannot be read."""
    found = hashlib.sha256()
    with open(path, 'rb') as stream:
        for piece in iter(lambda: stream.read(_PIECE), b''):
            found.update(piece)
    return found.hexdigest()
