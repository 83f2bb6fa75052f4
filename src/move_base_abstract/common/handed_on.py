"""The public names of a room, each imported when somebody asks for it: who uses one of them does not wait for all."""
import importlib


def handed_on(package, names):
    """Return the ``__getattr__`` (PEP 562) of a package that hands names of its modules on.

    :param names: {module, below the package: the names of it, with blanks between}.
    """
    homes = {name: module for module, own in names.items() for name in own.split()}

    def get(name):
        if name not in homes:
            raise AttributeError('module {!r} has no attribute {!r}'.format(package, name))
        return getattr(importlib.import_module('.' + homes[name], package), name)
    return get
