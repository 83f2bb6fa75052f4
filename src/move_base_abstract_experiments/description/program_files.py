"""The files of a program: the program itself, the Python modules that it imports, the libraries that it links.

They are found by reading; only ldd is run. A file in the system's own folders counts only if it is the program itself,
because an update of the system is not a change of the program by its user. Of packages that pip has installed
(``site-packages``), those count that the program and its own modules import. The packages that these import in turn
are thousands of files, and do not count. A module or library that a program loads by a computed name (a plugin) is not
found, except if the program imports another module of the same Python package.
"""
from __future__ import annotations

import ast
import contextlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from functools import lru_cache
from typing import Collection, List, Sequence, Set, Tuple

from move_base_abstract.common.processes import interpreter_of

OWN_FOLDERS = ('move_base_abstract', 'move_base_abstract_ros', 'move_base_abstract_experiments')
_SYSTEM = ('/usr/', '/lib/', '/lib64/', '/opt/ros/', '/bin/', '/sbin/', os.path.dirname(os.__file__) + os.sep)
_RELAY = re.compile(rb"^python_script = '([^'\n]+)'", re.MULTILINE)  # catkin's relay to a script, in a devel space
# Catkin's relay to a package. The kind of quotes depends on catkin's version.
_EXTENDED = re.compile(r'^__extended_path = ["\']([^"\'\n]+)["\']\.split', re.MULTILINE)
_LINKED = re.compile(r'=> (/\S+) \(0x')
_IMPORTERS = ('import_module', '__import__')
_MOST_FILES = 5000
_MOST_BYTES = 4 << 20  # of a source file that are read
_LDD_S = 20.0  # wall
_BY_PIP = f'{os.sep}site-packages{os.sep}'
#: the errors for files that cannot be read or found, or are not Python source
_NO_SOURCE = OSError, ValueError, SyntaxError, RecursionError, MemoryError, ImportError


def is_of_system(path: str) -> bool:
    """Return whether a file belongs to the system, the ROS distribution or Python's standard library."""
    return os.path.realpath(path).startswith(_SYSTEM) and '/usr/local/' not in path


def is_by_pip(path: str) -> bool:
    """Return whether pip has installed a file."""
    return _BY_PIP in path


def files_of(path: str, folders: Sequence[str] = ()) -> Set[str]:
    """Return the real paths of the files of the program at a path. folders: where its modules may be."""
    found = {os.path.realpath(path)}
    with contextlib.suppress(*_NO_SOURCE), open(path, 'rb') as stream:
        begin = stream.read(_MOST_BYTES)
        relay = _RELAY.search(begin)
        if relay:
            path = os.fsdecode(relay.group(1))
            found.add(os.path.realpath(path))
        if begin.startswith(b'\x7fELF'):
            return found | linked_libraries((path,))
        if path.endswith('.py') or interpreter_of(path) or begin.startswith(b'#!') and b'python' in begin[:200]:
            return found | modules_of(path, folders)
    return found


def linked_libraries(paths: Collection[str]) -> Set[str]:
    """Return the libraries that binaries load when they start, except those of the system."""
    ldd = shutil.which('ldd')
    if not ldd or not paths:
        return set()
    try:
        said = subprocess.run([ldd, *paths], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, check=False, timeout=_LDD_S).stdout
    except (OSError, subprocess.TimeoutExpired):
        return set()
    return {os.path.realpath(one) for one in _LINKED.findall(said.decode('utf-8', 'replace')) if not is_of_system(one)}


def modules_of(path: str, folders: Sequence[str] = ()) -> Set[str]:
    """Return the files of the modules that a script or module imports, and of what these import in turn."""
    found: Set[str] = set()
    waiting = [os.path.realpath(path)]
    places = [os.path.dirname(os.path.realpath(path)), *folders, *python_path()]
    while waiting and len(found) < _MOST_FILES:
        here = waiting.pop()
        if here in found:
            continue
        found.add(here)
        beside = os.path.dirname(here)
        for name in () if is_by_pip(here) else _imported(here):
            if name in OWN_FOLDERS:  # these count as a whole
                continue
            for place in (beside, *places) if beside not in places else places:
                files = files_of_module(place, name)
                if files:
                    break
            else:
                files = _elsewhere(name)
            waiting += [one for one in files if one not in found]
    return found


def names_from_elsewhere(paths: Collection[str]) -> Set[str]:
    """Return the first parts of the names that modules import and that are not among these modules.

    Names of Python's standard library are left out, too; not before Python 3.10, which has no list of them.
    """
    own = [one for one in paths if not is_by_pip(one)]
    here = {part for one in own for part in os.path.splitext(one)[0].split(os.sep)}
    names = {name for one in own for name in _imported(one)}
    return names - here - set(getattr(sys, 'stdlib_module_names', ()))


def python_path() -> List[str]:
    """Return the folders in which programs of users find modules, except those of the system."""
    given = [*os.environ.get('PYTHONPATH', '').split(os.pathsep), *sys.path]
    return [one for one in dict.fromkeys(given) if one and os.path.isdir(one) and not is_of_system(one + os.sep)]


@lru_cache(maxsize=None)
def _elsewhere(name: str) -> Tuple[str, ...]:
    """Return the files of a module that is in no folder of Python's path but has a finder, as by `pip install -e`."""
    spec = None
    with contextlib.suppress(*_NO_SOURCE):
        spec = importlib.util.find_spec(name) if name else None  # the name has no dot, so nothing is imported
    inside = list(spec.submodule_search_locations or ()) if spec else []
    place = inside[0] if inside else os.path.splitext(spec.origin or '')[0] if spec else ''
    return files_of_module(*os.path.split(place)) if os.path.isabs(place) and not is_of_system(place) else ()


@lru_cache(maxsize=None)
def _imported(path: str) -> Tuple[str, ...]:
    """Return the first parts of the names that a module imports; '' for a module of its own package."""
    names = []
    with contextlib.suppress(*_NO_SOURCE), open(path, 'rb') as stream:
        if not path.endswith(('.py', '.pyi')) and b'python' not in stream.readline(200):
            return ()
        stream.seek(0)
        for node in ast.walk(ast.parse(stream.read(_MOST_BYTES))):
            if isinstance(node, ast.Import):
                names += [one.name for one in node.names]
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.append(node.module)
            elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant) and getattr(
                    node.func, 'attr', getattr(node.func, 'id', '')) in _IMPORTERS:
                names.append(str(node.args[0].value))
    return tuple(dict.fromkeys(name.partition('.')[0] for name in names))


@lru_cache(maxsize=None)
def files_of_module(place: str, name: str) -> Tuple[str, ...]:
    """Return the files of a module in a folder. A package counts with all modules: computed names may import some."""
    single, package = os.path.join(place, name + '.py'), os.path.join(place, name)
    if not name or not os.path.isdir(package):
        return (os.path.realpath(single),) if name and os.path.isfile(single) else ()
    folders = [package]
    with contextlib.suppress(*_NO_SOURCE), open(os.path.join(package, '__init__.py'), encoding='utf-8') as stream:
        for extended in _EXTENDED.findall(stream.read(_MOST_BYTES)):
            folders += [os.path.join(one, name) for one in extended.split(';')]
    found = []
    for folder in folders:
        for here, inner, files in os.walk(folder):
            inner[:] = sorted(one for one in inner if one != '__pycache__' and not one.startswith('.'))
            found += [os.path.realpath(os.path.join(here, one)) for one in sorted(files)
                      if one.endswith(('.py', '.so'))]
            if len(found) > _MOST_FILES:
                break
    return tuple(found)


def forget() -> None:
    """Forget all files, so that they are read again; otherwise a process reads each once."""
    _imported.cache_clear()
    _elsewhere.cache_clear()
    files_of_module.cache_clear()
