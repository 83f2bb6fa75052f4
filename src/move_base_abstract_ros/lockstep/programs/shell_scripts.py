"""Shell scripts that become a Python program, or start one: the launcher then runs that program.

A shell script itself is run without changes. Python imports :mod:`sitecustomize` whenever it starts, and finds the one
in FOLDER. That has the launcher run the program if this Python is the node: if it is the script's own process
(``exec python3 ...``), or has the node's ``__name:=`` on its command line. Binaries that a shell script starts are not
followed.
"""
from __future__ import annotations

import json
import os
import re
import sys
from typing import Any, Iterator

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'follow')
FOLLOW = 'MOVE_BASE_ABSTRACT_LOCKSTEP_FOLLOW'
_SHELL = re.compile(rb'^#![ \t]*(\S*/)?(env[ \t]+(-\S+[ \t]+)*)?(sh|bash|dash|ksh|zsh)([ \t]|$)')
_WORD = re.compile(r'[\w./-]+')
_FOUND = re.compile(r'\brospack\s+find\s+([\w-]+)')
_RUN = re.compile(r'\brosrun\s+([\w-]+)\s+([\w./-]+)')
_NAME = '__name:='


def is_shell(first_line: bytes) -> bool:
    """Return whether the first line of a file (bytes) says that a shell runs it."""
    return _SHELL.match(first_line) is not None


def is_shell_word(word: str) -> bool:
    """Return whether ``word``, the first one of a command line, is a shell."""
    return is_shell(b'#!' + os.fsencode(word))


def execute(path: str, arguments: Any, launcher: Any) -> None:
    """Become the shell script, by exec. ``launcher`` are the launcher's words, to precede the Python program later."""
    names = [word for word in arguments if word.startswith(_NAME)]
    environment = dict(os.environ)
    environment[FOLLOW] = json.dumps([os.getpid(), names, [sys.executable, *launcher], FOLDER])
    environment['PYTHONPATH'] = os.pathsep.join([FOLDER, *filter(None, [environment.get('PYTHONPATH')])])
    os.execve(path, [path, *arguments], environment)


def programs_in(path: str, text: str, find_package: Any, find_node: Any) -> Iterator[Any]:
    """Yield the paths of the files that a shell script's ``text`` names, as far as the text can be understood.

    They are looked for in the script's own folder, and in those of packages that it names.

    :param find_package: function of a package's name that returns its folder, or None.
    :param find_node: function of a package and a type that returns a list of paths.
    """
    folders = [os.path.dirname(os.path.realpath(path)), *filter(None, map(find_package, _FOUND.findall(text)))]
    for package, kind in _RUN.findall(text):
        yield from find_node(package, kind)
    for word in _WORD.findall(text):
        for candidate in [word, *(os.path.join(folder, word.lstrip('/')) for folder in folders)]:
            if os.path.isabs(candidate) and os.path.isfile(candidate) and not os.path.samefile(candidate, path):
                yield candidate
