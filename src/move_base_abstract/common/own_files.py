"""Files that this package writes: they are complete or absent, and never replace files that it did not make.

A folder that this package makes has the file MARKER in it. Only such a folder, or an empty one, is ever replaced, and
only if all files in it are from this package; any other file is an error that names it. Folders are emptied file by
file, never as a tree. Symbolic links are not followed.
"""
from __future__ import annotations

import contextlib
import errno
import fcntl
import fnmatch
import os
import stat
from typing import IO, TYPE_CHECKING, Any, Callable, Iterator, List, Optional, Sequence

from .errors import ConfigurationError, SimulatorError

if TYPE_CHECKING:
    from .type_names import StrPath

MARKER = '.made_by_move_base_abstract'
PART = '.part'
_TEXT = 'This folder was made by move_base_abstract, as a {}. The program replaces it when it is told to write here.\n'


class OutputError(SimulatorError):
    """A file or folder cannot be written, for example because the disk is full. The text names it and says why."""


class FolderKind:
    """One kind of folder that this package makes.

    :param name: its name in the marker and in error texts.
    :param files: patterns (fnmatch) of the names of the files that may be in it, also with PART behind them. None:
        anything may be in it, because the folder is never replaced.
    """

    def __init__(self, name: str, files: Optional[Sequence[str]] = None) -> None:
        self._name = name
        self._files = files
        self._text = _TEXT.format(name)

    def check(self, path: StrPath, beside: Sequence[str] = ()) -> None:
        """Check that at ``path`` there is nothing, an empty folder, or a folder of this kind with only its files in it.

        :param beside: names of folders of other kinds that may be in it, too.
        :raises ConfigurationError: if not; the text names the path and what is in the way.
        """
        kind = _kind_of(path)
        if kind == 'nothing':
            return
        if kind != 'a folder':
            raise ConfigurationError(f'{path}: is there already, and is {kind}; must be a new folder, an empty one, or '
                                     f'a {self._name} that this program made')
        names = _listed(path)
        if not names:
            return
        if MARKER not in names or not self._is_marker(os.path.join(path, MARKER)):
            raise ConfigurationError(f"{path}: is not empty (it holds '{names[0]}'), and this program did not make it "
                                     f'as a {self._name}: no mark in it says so ({MARKER}); name another folder')
        for name in names if self._files is not None else []:
            if name not in beside and not self._is_own(path, name):
                raise ConfigurationError(f"{path}: was made by this program, but '{name}' in it was not; move that "
                                         f'away, or name another folder')

    def make(self, path: StrPath) -> int:
        """Make a folder, or take an empty one or one of this kind; return a descriptor of its marker, which is locked.

        Close the descriptor when nothing more is to be written.

        :raises ConfigurationError: if something is in the way (see check), or another process has locked the folder.
        :raises OutputError: if the folder cannot be made.
        """
        self.check(path)
        with _clear_errors(path, 'cannot be made'):
            os.makedirs(path, exist_ok=True)
            marker = os.open(os.path.join(path, MARKER), os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        try:
            self._lock(path, marker)
            with _clear_errors(path, 'cannot be made'):
                os.ftruncate(marker, 0)
                os.pwrite(marker, self._text.encode(), 0)
        except BaseException:
            os.close(marker)
            raise
        return marker

    def make_new(self, path: StrPath) -> None:
        """Make a new folder of this kind within a folder that this process has locked.

        :raises OutputError: if it cannot be made, also if it exists.
        """
        with _clear_errors(path, 'cannot be made'):
            os.mkdir(path)
            with open(os.path.join(path, MARKER), 'x', encoding='utf-8') as stream:
                stream.write(self._text)

    def remove(self, path: StrPath) -> None:
        """Remove a folder of this kind or an empty one; do nothing if there is none.

        :raises ConfigurationError: if something else is in the way, or another process has locked the folder.
        :raises OutputError: if the folder cannot be removed.
        """
        self.check(path)
        if _kind_of(path) == 'nothing':
            return
        names = _listed(path)
        with _clear_errors(path, 'cannot be removed'), contextlib.ExitStack() as stack:
            if MARKER in names:
                marker = os.open(os.path.join(path, MARKER), os.O_RDONLY | os.O_NOFOLLOW)
                stack.callback(os.close, marker)
                self._lock(path, marker)
            for name in sorted(names, key=lambda name: name == MARKER):  # the marker last
                os.unlink(os.path.join(path, name))
            os.rmdir(path)

    def _lock(self, path: StrPath, marker: int) -> None:
        try:
            fcntl.flock(marker, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ConfigurationError(f'{path}: another process of this program is writing there') from None

    def _is_marker(self, path: StrPath) -> bool:
        if _kind_of(path) != 'a file':
            return False
        with _clear_errors(path, 'cannot be read'), open(path, 'rb') as stream:
            text = stream.read(len(self._text) + 1)
        # An empty marker was being written when its process was killed.
        return text in (b'', self._text.encode())

    def _is_own(self, path: StrPath, name: str) -> bool:
        if _kind_of(os.path.join(path, name)) != 'a file':
            return False
        stem = name[:-len(PART)] if name.endswith(PART) else name
        return name == MARKER or any(fnmatch.fnmatchcase(stem, pattern) for pattern in self._files or ())


@contextlib.contextmanager
def whole_file(path: StrPath, mode: str = 'w', **options: Any) -> Iterator[IO[Any]]:
    """Open a file in a folder of ours for writing; it gets its name only when it is complete and on the disk.

    Until then it is called NAME.part. A file of that name, from an earlier, unfinished run, is replaced.

    :param mode: 'w' or 'wb'.
    :param options: other arguments of open().
    :raises OutputError: if the file cannot be written.
    """
    path = os.fspath(path)
    with _clear_errors(path, 'cannot be written'):
        if _kind_of(path + PART) == 'a file':
            os.unlink(path + PART)
        with open(path + PART, mode.replace('w', 'x'), **options) as stream:  # 'x' follows no link
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(path + PART, path)


@contextlib.contextmanager
def new_file(path: StrPath, mode: str = 'x', **options: Any) -> Iterator[IO[Any]]:
    """Open a new file in a folder of ours that will get its final name later, after :func:`on_disk`.

    :raises OutputError: if the file cannot be written.
    """
    with _clear_errors(path, 'cannot be written'), open(path, mode, **options) as stream:
        yield stream


def on_disk(folder: StrPath) -> None:
    """Wait until all files in a folder of ours, and in its subfolders, are on the disk.

    Markers are left out: an empty marker, as a power cut may leave it, still counts as one.

    :raises OutputError: if a file cannot be written.
    """
    with _clear_errors(folder, 'cannot be written'):
        for path, _, names in os.walk(folder):
            for name in (name for name in names if name != MARKER):
                descriptor = os.open(os.path.join(path, name), os.O_RDONLY | os.O_NOFOLLOW)
                try:
                    os.fsync(descriptor)
                finally:
                    os.close(descriptor)


def check_file(path: StrPath, is_own: Callable[[bytes], bool]) -> None:
    """Check that at ``path`` there is nothing, or a file that is empty or was made by this program.

    :param is_own: returns whether this program made a file, from its first line (bytes).
    :raises ConfigurationError: if not; the text names the path.
    """
    kind = _kind_of(path)
    if kind == 'nothing':
        return
    if kind == 'a file':
        with _clear_errors(path, 'cannot be read'), open(path, 'rb') as stream:
            line = stream.readline(1000)
        if not line or is_own(line):
            return
    raise ConfigurationError(f'{path}: is there already, as {kind}, and this program did not make it; it stays')


def create_file(path: StrPath, is_own: Callable[[bytes], bool]) -> IO[str]:
    """Open a new text file, in place of nothing or of a file that this program made; see :func:`check_file`.

    :raises ConfigurationError: if something else is at ``path``.
    :raises OutputError: if the file cannot be written.
    """
    check_file(path, is_own)
    with _clear_errors(path, 'cannot be written'):
        with contextlib.suppress(FileNotFoundError):
            os.unlink(path)
        return open(path, 'x', encoding='utf-8')
    raise AssertionError  # never reached; mypy thinks that the with statement may swallow an error


def _kind_of(path: StrPath) -> str:
    """Return the kind of what is at ``path``, in words; links are not followed."""
    try:
        mode = os.lstat(path).st_mode
    except FileNotFoundError:
        return 'nothing'
    except OSError as error:
        raise OutputError(f'{path}: cannot be used: {error.strerror}') from None
    if stat.S_ISLNK(mode):
        return 'a symbolic link'
    if stat.S_ISDIR(mode):
        return 'a folder'
    return 'a file' if stat.S_ISREG(mode) else 'a special file'


def _listed(path: StrPath) -> List[str]:
    with _clear_errors(path, 'cannot be read'):
        return sorted(os.listdir(path))


@contextlib.contextmanager
def _clear_errors(path: StrPath, what: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = 'the disk is full' if error.errno in (errno.ENOSPC, errno.EDQUOT) else error.strerror or error
        raise OutputError(f'{path}: {what}: {reason}') from error
