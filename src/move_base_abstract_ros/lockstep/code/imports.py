"""Call a function when a program first imports a module."""
from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from types import SimpleNamespace
from typing import Any, Callable, Optional, Sequence


def when_imported(name: str, then: Callable[[], object]) -> None:
    """Call ``then()`` as soon as the module ``name`` is loaded: now, or right after the program imports it."""
    if name in sys.modules:
        then()
        return

    def find_spec(wanted: str, path: Optional[Sequence[str]] = None, _target: Any = None) -> Any:
        if wanted != name:
            return None
        sys.meta_path.remove(finder)
        spec: Any = PathFinder.find_spec(name, path)
        if spec is not None:
            execute = spec.loader.exec_module
            spec.loader.exec_module = lambda module: (execute(module), then())
        return spec
    finder: Any = SimpleNamespace(find_spec=find_spec)  # finds the module as Python does
    sys.meta_path.insert(0, finder)
