"""The program's own code, which is compiled with calls that tell lockstep what it must know.

These calls are at its loops, its classes and its sets, and where it asks the machine. Libraries get such calls only
where they may ask for the present date.

A file is the program's own if it lies neither in Python's library nor in a folder of packages (site-packages,
dist-packages), and is not part of a distribution that is installed elsewhere. Files in the folder of packages of a
catkin workspace are its own, too, except ROS's distribution and generated modules. The code that is compiled here is
not kept: Python's own files of compiled modules stay as they are.
"""
from __future__ import annotations
import __future__

import ast
import builtins
import csv
import os
import re
import sys
import sysconfig
import types
import weakref
from functools import lru_cache
from typing import Any, Callable, Dict, FrozenSet, Iterator, Set, Union

import rospy

import move_base_abstract
from move_base_abstract.lockstep.call_rewriting import COMPILING, MOMENTS, TEXT, ask, ask_present
from move_base_abstract.lockstep.instrument import dotted, hand_over_called, instrument
from move_base_abstract.lockstep.object_order import follow_order

from ...replacing.replaced import replace
from . import older
from .turns import LOOKING

_LIBRARIES = tuple({sysconfig.get_path('stdlib'), '/usr/lib/python3', '<frozen'})
_PACKAGES = re.compile(r'/(site|dist)-packages(/|$)')
_GENERATED = re.compile(r'(^|/)(msg|srv|cfg)/')
_SHARED = {'', '.', '..', 'bin'}  # folders that do not belong to one distribution alone
_FUTURES = sum(getattr(__future__, name).compiler_flag for name in __future__.all_feature_names)
#: {code: arguments of compile} of what :func:`_compile` has made
_compiled: Any = weakref.WeakKeyDictionary()
_LARGEST = 16 * 1024 * 1024  # the most bytes that are read of a list of installed files
#: the folders of this package
OWN = (os.path.normpath(os.path.join(os.path.dirname(__file__), *[os.pardir] * 2)) + '/',
       os.path.dirname(move_base_abstract.__file__) + '/')
#: in catkin's scripts in the devel space, which compile the real script by the name ``compile``
_RELAY = b'exec(compile(fh.read(), python_script'


@lru_cache(maxsize=None)
def is_library(filename: str) -> bool:
    """Return whether a file is not the program's own."""
    packages = _PACKAGES.search(filename)
    if filename.startswith(_LIBRARIES + OWN):
        return True
    if packages is not None:
        return not _is_of_workspace(filename, filename[:packages.end()])
    return is_installed(filename)


def _is_of_workspace(filename: str, folder: str) -> bool:
    """Return whether a file in a folder of packages is a user's: installed by catkin, and not generated."""
    prefixes = os.environ.get('CMAKE_PREFIX_PATH', '').split(os.pathsep)
    return not _GENERATED.search(filename[len(folder):]) and not os.path.isdir(os.path.join(folder, 'rospy')) and any(
        prefix and filename.startswith(prefix + os.sep) and os.path.exists(os.path.join(prefix, '.catkin'))
        for prefix in prefixes)


def is_installed(path: str) -> bool:
    """Return whether the file or folder ``path`` was installed as a part of a distribution, in any folder.

    An installer (``pip install --target``) leaves a folder ``NAME.dist-info`` beside the files, with a list (RECORD).
    """
    folder, name = os.path.split(path.rstrip(os.sep))
    while name:
        if name in _tops(folder):
            return True
        folder, name = os.path.split(folder)
    return False


@lru_cache(maxsize=None)
def _tops(folder: str) -> FrozenSet[str]:
    """Return the names of files and folders in ``folder`` that are listed by the distributions in it."""
    try:
        infos = sorted(name for name in os.listdir(folder) if name.endswith('.dist-info'))
    except OSError:
        return frozenset()
    return frozenset(name for info in infos for name in _listed(os.path.join(folder, info, 'RECORD')))


def _listed(path: str) -> Set[str]:
    try:
        with open(path, encoding='utf-8', errors='replace', newline='') as stream:
            rows = csv.reader(stream.read(_LARGEST).splitlines())
            return {row[0].partition('/')[0] for row in rows if row} - _SHARED
    except (OSError, csv.Error):
        return set()


def install(sees_run: Callable[[str], bool]) -> None:
    """Compile the program's own code with the added calls, from now on: modules, and texts that it compiles itself.

    ``sees_run(file)`` says whether the code of a library sees the run's date.
    """
    for module in list(sys.modules.values()):
        path = getattr(module, '__file__', None) or ''
        if path.endswith('.py') and sees_run(path):
            _give_date(module, path)
    replace('importlib.machinery.SourceFileLoader.get_code', lambda get_code: _loading(get_code, sees_run))
    setattr(builtins, COMPILING, _compiling)
    setattr(builtins, TEXT, _text)


def _give_date(module: Any, path: str) -> None:
    """Give the functions of a module that was loaded before the code that asks for the run's date."""
    functions = [one for one in vars(module).values() if type(one) is types.FunctionType
                 and one.__module__ == module.__name__ and MOMENTS.intersection(one.__code__.co_names)]
    if functions:
        with open(path, 'rb') as stream:
            codes = {(code.co_name, code.co_firstlineno): code for code in _codes(_asking_present(stream.read(), path))}
        for one in functions:
            one.__code__ = codes.get((one.__code__.co_name, one.__code__.co_firstlineno), one.__code__)


def _codes(code: types.CodeType) -> Iterator[types.CodeType]:
    """Yield a module's code, and that of all that is in it."""
    yield code
    for one in code.co_consts:
        if isinstance(one, types.CodeType):
            yield from _codes(one)


def _asking_present(source: bytes, path: str) -> Any:
    return compile(ask_present(ast.parse(source, path)), path, 'exec', dont_inherit=True)


def _loading(get_code: Callable[..., Any], sees_run: Callable[[str], bool]) -> Callable[..., Any]:
    """Return ``get_code`` of the loader of modules that are files, however the program finds them."""
    def load(self: Any, fullname: str) -> Any:
        path = self.get_filename(fullname)
        if not is_library(path):
            return compile_own(self.get_data(path), path)
        code = get_code(self, fullname)
        asks = sees_run(path) and any(MOMENTS.intersection(one.co_names) for one in _codes(code))
        return _asking_present(self.get_data(path), path) if asks else code
    return load


def _compiling(function: Any) -> Any:
    """Return what the program's own code gets for ``compile``: the same for texts of its own."""
    return _compile if function is compile else function


def _compile(source: Any, filename: Any, mode: str, flags: int = 0, dont_inherit: bool = False,
             optimize: int = -1, **others: Any) -> Any:
    """Stand in for ``compile``."""
    inherited = 0 if dont_inherit else sys._getframe(1).f_code.co_flags & _FUTURES
    if flags & ~_FUTURES or mode == 'single' or not isinstance(source, (str, bytes)) or not isinstance(filename, str):
        return compile(source, filename, mode, flags | inherited, True, optimize, **others)
    code = compile_own(source, filename, mode, flags | inherited)
    _compiled[code] = source, filename, mode, flags | inherited
    return code


def _text(mode: str, source: Any, *others: Any) -> Any:
    """Return the arguments of ``exec`` or ``eval``, a text as code if the names that it gets have Python's builtins."""
    frame = sys._getframe(1)
    is_shadowed = mode in frame.f_globals or mode in frame.f_locals
    names = others[0] if others else None
    if isinstance(names, dict) and names.get('__builtins__', builtins) not in (builtins, builtins.__dict__):
        if isinstance(source, types.CodeType) and source in _compiled:
            source = compile(*_compiled[source], dont_inherit=True)  # what is added calls builtins that are not there
        return (source, *others)
    if is_shadowed or not isinstance(source, (str, bytes)):
        return (source, *others)
    blanks: Any = ' \t' if isinstance(source, str) else b' \t'
    return (compile_own(source.lstrip(blanks) if mode == 'eval' else source, '<string>', mode,
                        frame.f_code.co_flags & _FUTURES), *others)


@lru_cache(maxsize=256)
def compile_own(source: Union[bytes, str], path: str, mode: str = 'exec', flags: int = 0) -> Any:
    """Return the code of a file or text of the program, compiled with the added calls.

    :raises SyntaxError: as compile does.
    """
    is_older = mode == 'exec' and older.is_older(path)
    tree: Any = older.tree_of(source if isinstance(source, bytes) else source.encode(), path) if is_older else compile(
        source, path, mode, ast.PyCF_ONLY_AST | flags, dont_inherit=True)
    try:
        tree, looking = instrument(tree)
        code = compile(hand_over_called(ask(follow_order(tree))), path, mode, flags, dont_inherit=True)
        LOOKING.update(((path, *place), may_look) for place, may_look in looking.items())
        return code
    except RecursionError:  # at some hundreds of branches of one `if`
        rospy.logwarn('lockstep: %s is nested too deeply for its waiting loops and its sets to be followed', path)
        return compile(source, path, mode, flags, dont_inherit=True)


def names_of_script(source: bytes) -> Dict[str, Any]:
    """Return {name: value} to be added to a script's names: ``compile``, if it is catkin's relay to the real script."""
    return {'compile': lambda text, path, mode: compile_own(text, path)} if _RELAY in source else {}


def name_of_node(path: str) -> str:
    """Return the name that a script gives to its node, or ''.

    It is '' unless the script has exactly one call of init_node, with a text as name, and not anonymous.
    """
    try:
        with open(path, 'rb') as stream:
            tree = older.tree_of(stream.read(), path) if older.is_older(path) else ast.parse(stream.read())
    except (OSError, SyntaxError, ValueError):
        return ''
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call) and dotted(node.func)[-1:] == ('init_node',)]
    if len(calls) != 1 or not calls[0].args or len(calls[0].args) > 1:
        return ''
    if any(keyword.arg in (None, 'anonymous', 'argv') for keyword in calls[0].keywords):
        return ''
    name = getattr(calls[0].args[0], 'value', None)
    return name if isinstance(name, str) and '/' not in name else ''
