"""The program's own code, which is compiled with what lockstep must be told.

That is about its loops, its classes and its sets, and what it asks the machine.
Its own is what lies neither in Python's library nor in a folder of packages (site-packages, dist-packages), and is no
part of an installed distribution elsewhere; and what lies in the folder of packages of a catkin workspace, ROS's
distribution and generated modules excepted. Nothing is kept of what is
compiled here: Python's own files of compiled modules stay as they are.
"""
import ast
import os
import re
import sys
import sysconfig
from functools import lru_cache
from importlib import machinery

import rospy

import move_base_abstract
from move_base_abstract.lockstep.call_rewriting import ask
from move_base_abstract.lockstep.installed import is_installed
from move_base_abstract.lockstep.instrument import dotted, instrument
from move_base_abstract.lockstep.object_order import follow_order

_LIBRARIES = tuple({sysconfig.get_path('stdlib'), '/usr/lib/python3', '<frozen'})
_PACKAGES = re.compile(r'/(site|dist)-packages(/|$)')
_GENERATED = re.compile(r'(^|/)(msg|srv|cfg)/')
#: the folders of this package
OWN = (os.path.normpath(os.path.join(os.path.dirname(__file__), *[os.pardir] * 2)) + '/',
       os.path.dirname(move_base_abstract.__file__) + '/')
#: catkin's scripts in the devel space: they compile the source, by the name of `compile`
_RELAY = b'exec(compile(fh.read(), python_script'


@lru_cache(maxsize=None)
def is_library(filename):
    """Return whether a file is none of the program's."""
    packages = _PACKAGES.search(filename)
    if filename.startswith(_LIBRARIES + OWN):
        return True
    if packages is not None:
        return not _is_of_workspace(filename, filename[:packages.end()])
    return is_installed(filename)


def _is_of_workspace(filename, folder):
    """Return whether a file in a folder of packages is a user's: installed by catkin, and not generated."""
    prefixes = os.environ.get('CMAKE_PREFIX_PATH', '').split(os.pathsep)
    return not _GENERATED.search(filename[len(folder):]) and not os.path.isdir(os.path.join(folder, 'rospy')) and any(
        prefix and filename.startswith(prefix + os.sep) and os.path.exists(os.path.join(prefix, '.catkin'))
        for prefix in prefixes)


def install():
    """Compile modules of the program with what is added, from now on."""
    sys.path_hooks.insert(0, _finder)
    sys.path_importer_cache.clear()


def _finder(path):
    if not os.path.isdir(path or '.') or is_library(os.path.abspath(path) + '/'):
        raise ImportError('only folders of the program', path=path)
    return machinery.FileFinder(path, (machinery.ExtensionFileLoader, machinery.EXTENSION_SUFFIXES),
                                (SourceFileLoader, machinery.SOURCE_SUFFIXES),
                                (machinery.SourcelessFileLoader, machinery.BYTECODE_SUFFIXES))


class SourceFileLoader(machinery.SourceFileLoader):
    """Loads modules of the program from their source; named as the one that would do it elsewhere."""

    def get_code(self, fullname):
        """Return the code of a module."""
        path = self.get_filename(fullname)
        if is_library(path):
            return super().get_code(fullname)
        return compile_own(self.get_data(path), path)


def compile_own(source, path):
    """Return the code of a file of the program.

    :raises SyntaxError: as compile.
    """
    tree = compile(source, path, 'exec', ast.PyCF_ONLY_AST, dont_inherit=True)
    try:
        return compile(ask(follow_order(instrument(tree))), path, 'exec', dont_inherit=True)
    except RecursionError:  # some hundreds of branches of one `if`
        rospy.logwarn('lockstep: %s is nested too deeply for its waiting loops and its sets to be followed', path)
        return compile(source, path, 'exec', dont_inherit=True)


def names_of_script(source):
    """Return the names to be added to those of a script: of a relay of catkin's, which compiles the script itself."""
    return {'compile': lambda text, path, mode: compile_own(text, path)} if _RELAY in source else {}


def name_of_node(path):
    """Return the name that a script gives to its node, '' if that is not plain: in one call, and not anonymous."""
    try:
        with open(path, 'rb') as stream:
            tree = ast.parse(stream.read())
    except (OSError, SyntaxError, ValueError):
        return ''
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call) and dotted(node.func)[-1:] == ('init_node',)]
    if len(calls) != 1 or not calls[0].args or len(calls[0].args) > 1:
        return ''
    if any(keyword.arg in (None, 'anonymous', 'argv') for keyword in calls[0].keywords):
        return ''
    name = getattr(calls[0].args[0], 'value', None)
    return name if isinstance(name, str) and '/' not in name else ''
