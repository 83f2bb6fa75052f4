"""ERROR and FATAL lines that participants log in their turns: how many each has logged, and the first one.

Each participant notes its lines in a file of its own in the run's folder: the text of the first line, a zero byte, and
one byte for each line. `roscpp_shim/roscpp/console.cpp` does the same. Lines that come after the end, or from threads
without turns, depend on the machine, and are not noted.
"""
from __future__ import annotations

import contextlib
import os
from typing import Any, Dict, List, NamedTuple

from ..common.ros_names import natural_order
from .ends import plain_line

#: the environment variable that names the folder in which participants note their bags and these lines
VARIABLE = 'MOVE_BASE_ABSTRACT_NOTES'
_PREFIX, _ERROR, _FATAL = 'errors', b'E', b'F'
_open, _LONGEST = os.open, 1000


class ErrorLines(NamedTuple):
    """The numbers of lines of a participant, and the first one, without colours, wall times and addresses."""

    node: str
    errors: int
    fatals: int
    first: str

    @property
    def words(self) -> str:
        """The lines in one line of text."""
        counts = [f'{count} {level} line{"s" * (count != 1)}'
                  for count, level in ((self.errors, 'ERROR'), (self.fatals, 'FATAL')) if count]
        return f'{self.node} logged {" and ".join(counts)}, first: {self.first}'

    @property
    def told(self) -> Dict[str, Any]:
        """The lines as a dictionary of plain values, for trial.json."""
        return self._asdict()


def note(node: str, is_fatal: bool, text: str) -> None:
    """Note that the participant ``node`` has logged a line."""
    folder = os.environ.get(VARIABLE)
    if not folder:
        return
    path, mark = os.path.join(folder, _PREFIX + node.replace('/', '.')), _FATAL if is_fatal else _ERROR
    with contextlib.suppress(OSError):
        try:
            file = _open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC)
            mark = text.replace('\0', ' ')[:_LONGEST].encode('utf-8', 'replace') + b'\0' + mark
        except FileExistsError:
            file = _open(path, os.O_WRONLY | os.O_APPEND | os.O_CLOEXEC)
        os.write(file, mark)
        os.close(file)


def noted(folder: str) -> List[ErrorLines]:
    """Return the ErrorLines of all participants that have noted some in a folder, in the order of their names."""
    found = []
    for name in os.listdir(folder):
        if name.startswith(_PREFIX + '.'):
            with open(os.path.join(folder, name), 'rb') as stream:
                text, _, marks = stream.read().partition(b'\0')
            first = plain_line(next(iter(text.decode('utf-8', 'replace').strip().splitlines()), ''))
            found.append(ErrorLines(name[len(_PREFIX):].replace('.', '/'), marks.count(_ERROR), marks.count(_FATAL),
                                    first))
    return sorted(found, key=lambda one: natural_order(one.node))
