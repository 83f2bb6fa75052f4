"""Does something when a program imports a module for the first time, and nothing before."""
import sys
from importlib.machinery import PathFinder


def when_imported(name, then):
    """Call ``then()`` as soon as the module ``name`` is there: now, or when it has been loaded."""
    if name in sys.modules:
        then()
    else:
        sys.meta_path.insert(0, _WhenImported(name, then))


class _WhenImported:
    """Finds a module as Python does."""

    def __init__(self, name, then):
        self._name, self._then = name, then

    def find_spec(self, name, path=None, _target=None):
        """As of importlib.abc.MetaPathFinder."""
        if name != self._name:
            return None
        sys.meta_path.remove(self)
        spec = PathFinder.find_spec(name, path)
        if spec is not None:
            execute = spec.loader.exec_module
            spec.loader.exec_module = lambda module: (execute(module), self._then())
        return spec
