"""The program that the launcher's command line runs: its path, its kind, and the Python that runs it."""
from __future__ import annotations

import os
import re
import shutil
import sys
from typing import Any, Optional, Sequence

from . import shell_scripts

PYTHON = re.compile(r'python[0-9.]*$')
_WITH_VALUE = ('-W', '-X', '--check-hash-based-pycs')  # options of Python whose value is the next word


def own_words(words: Sequence[str]) -> int:
    """Return the number of words that are options of the launcher: those before the program or its ``-m``."""
    at = 0
    while at < len(words) and words[at].startswith('-') and words[at] != '-m':
        with_value = words[at] in ('--rank', '--sleep', '--seed')
        at += 2 if with_value else 1
    return min(at, len(words))


def split_interpreter(command: Sequence[str]) -> Any:
    """Return ([Python, its options...], words of the program) of a command line.

    The Python is the one that runs this, unless the command line names another one by its path, or the first line of a
    script names that of a virtual environment.

    :raises ValueError: if a Python interpreter is given without a script or module, or with -c, -i or ``-``.
    """
    if not PYTHON.match(os.path.basename(command[0])):
        path = path_of(command[0])
        return [_of_script(path) if path else sys.executable], command
    at = 1
    while at < len(command) and command[at].startswith('-') and command[at] != '-m':
        if command[at][:2] in ('-c', '-i') or command[at] == '-':
            raise ValueError("'{}' of a Python interpreter is not possible here; allowed: a script or -m MODULE".format(
                command[at]))
        at += 2 if command[at] in _WITH_VALUE else 1
    if at >= len(command):
        raise ValueError('a Python interpreter needs a script or -m MODULE here')
    return [command[0] if '/' in command[0] else sys.executable, *command[1:at]], command[at:]


def _of_script(path: str) -> str:
    """Return the Python in a script's first line if it is that of a virtual environment; otherwise this Python."""
    with open(path, 'rb') as stream:
        first = stream.readline(500)
    words = first[2:].split() if first.startswith(b'#!') else []
    python = os.fsdecode(words[0]) if words else ''
    is_other = PYTHON.match(os.path.basename(python)) and os.access(python, os.X_OK) and os.path.isfile(
        os.path.join(os.path.dirname(os.path.dirname(python)), 'pyvenv.cfg'))
    return python if is_other else sys.executable


def find(command: Sequence[str], is_script: bool = False) -> Any:
    """Return ('module' | 'script' | 'shell' | 'binary', name or path, arguments) of a command line.

    ``is_script``: the command came after a Python interpreter, so any file is taken for a script.

    :raises ValueError: if there is no such program, or it is of another kind.
    """
    if command[0] == '-m':
        if len(command) < 2:
            raise ValueError('-m needs the name of a module')
        return 'module', command[1], command[2:]
    path = command[0] if is_script else path_of(command[0])
    if path is None or not os.path.isfile(path):
        raise ValueError("there is no program '{}'".format(command[0]))
    kind = 'script' if is_script else kind_of(path)
    if kind is None:
        raise ValueError("'{}' is neither a Python or shell script nor a binary. If it starts a program, give that "
                         'program instead'.format(path))
    return kind, path, command[1:]


def script_of(words: Sequence[str]) -> Optional[str]:
    """Return the path of the Python script that the launcher would run with these words, or None."""
    command = words[own_words(words):]
    try:
        kind, path, _ = find(command) if command and command[0] != '-m' else (None, None, None)
    except (ValueError, OSError):
        return None
    return path if kind == 'script' else None


def path_of(word: str) -> Any:
    """Return the path of a program, which is given by its path or its name in PATH; None if there is none."""
    path = word if os.path.isfile(word) else shutil.which(word)
    return path if path is not None and os.path.isfile(path) else None


def kind_of(path: str) -> Optional[str]:
    """Return the kind of the program in a file: 'binary', 'shell' or 'script' (of Python), or None."""
    with open(path, 'rb') as stream:
        begin = stream.read(200)
    if begin.startswith(b'\x7fELF'):
        return 'binary'
    first = begin.split(b'\n', 1)[0]
    if shell_scripts.is_shell(first):
        return 'shell'
    if path.endswith('.py') or (first.startswith(b'#!') and b'python' in first):
        return 'script'
    return None
