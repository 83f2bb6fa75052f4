"""The public names of a package. Each is imported when it is first used, so that using one does not import all."""
from __future__ import annotations

import importlib
from typing import Any, Callable, Dict


def handed_on(package: str, names: Dict[str, str]) -> Callable[[str], Any]:
    """Return a ``__getattr__`` (PEP 562) for ``package``, which makes names of its modules its own.

    :param names: {module, relative to the package: its names, separated by blanks}.
    """
    homes = {name: module for module, own in names.items() for name in own.split()}

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError('module {!r} has no attribute {!r}'.format(package, name))
        return getattr(importlib.import_module('.' + homes[name], package), name)
    return get
