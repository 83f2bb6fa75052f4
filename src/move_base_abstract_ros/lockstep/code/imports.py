"""Call a function when a program first imports a module."""
from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from typing import Any, Callable, Optional, Sequence


def when_imported(name: str, then: Callable[..., Any]) -> None:
    """Call ``then()`` as soon as the module ``name`` is loaded: now, or right after the program imports it."""
    if name in sys.modules:
        then()
    else:
        sys.meta_path.insert(0, _WhenImported(name, then))


class _WhenImported:
    """Finds a module as Python does, and calls a function when it has been loaded."""

    def __init__(self, name: str, then: Callable[..., Any]) -> None:
        self._name, self._then = name, then

    def find_spec(self, name: str, path: Optional[Sequence[str]] = None, _target: Any = None) -> Any:
        """Find the module, as importlib.abc.MetaPathFinder does."""
        if name != self._name:
            return None
        sys.meta_path.remove(self)
        spec: Any = PathFinder.find_spec(name, path)
        if spec is not None:
            execute = spec.loader.exec_module
            spec.loader.exec_module = lambda module: (execute(module), self._then())
        return spec
