"""Lets Python find only modules that the file ``hidden`` beside this one does not name; see bare.py.

Python imports it at its start from the user's folder of packages, whether PYTHONPATH counts or not (python3 -E).
"""
from importlib.machinery import PathFinder
from pathlib import Path

HIDDEN = frozenset(Path(__file__).with_name('hidden').read_text(encoding='utf-8').splitlines())
_find_spec, _find_distributions = PathFinder.find_spec, PathFinder.find_distributions


def is_hidden(path):
    """Return whether a file or folder is hidden, or in a folder that is."""
    return path in HIDDEN or any(str(parent) in HIDDEN for parent in Path(path).parents)


def find_spec(cls, name, path=None, target=None):
    """Find a module, as PathFinder does, unless its file (or each folder of a package without one) is hidden."""
    spec = _find_spec(name, path, target)
    places = ([spec.origin] if spec.has_location else spec.submodule_search_locations) if spec else None
    return None if places and all(map(is_hidden, places)) else spec


def find_distributions(cls, *words, **options):
    """Find the metadata of packages, as PathFinder does; pytest looks there for plugins."""
    return (found for found in _find_distributions(*words, **options) if not is_hidden(str(found._path)))


PathFinder.find_spec = classmethod(find_spec)  # in its place: programs also ask PathFinder itself
PathFinder.find_distributions = classmethod(find_distributions)
