"""The public names of a package. Each is imported when it is first used, so that using one does not import all.

A package's ``__init__`` imports its public names below ``if TYPE_CHECKING``, where type checkers and editors find them
(``from .alarm import Alarm as Alarm``). In the ``else`` stands ``__getattr__ = lazy_exports(__name__)``.
"""
from __future__ import annotations

import ast
import importlib
import sys
from pathlib import Path
from typing import Any, Callable, Dict


def exports_of(text: str) -> Dict[str, str]:
    """Return {public name: its module, relative to the package} of the text of a package's ``__init__``."""
    return {alias.name: '.' * node.level + (node.module or '')
            for branch in ast.parse(text).body
            if isinstance(branch, ast.If) and getattr(branch.test, 'id', '') == 'TYPE_CHECKING'
            for node in branch.body if isinstance(node, ast.ImportFrom)
            for alias in node.names if alias.asname == alias.name}


def lazy_exports(package: str) -> Callable[[str], Any]:
    """Return a ``__getattr__`` (PEP 562) for ``package``, which makes names of its modules its own."""
    homes: Dict[str, str] = {}
    for folder in reversed(list(sys.modules[package].__path__)):  # catkin's devel space has a second one, found first
        path = Path(folder, '__init__.py')
        if path.is_file():
            homes.update(exports_of(path.read_text(encoding='utf-8')))

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError('module {!r} has no attribute {!r}'.format(package, name))
        return getattr(importlib.import_module(homes[name], package), name)
    return get
