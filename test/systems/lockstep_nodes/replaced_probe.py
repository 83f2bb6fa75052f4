"""Notes the functions and classes of rospy and Python's library, launches a program, and prints the changes.

usage: replaced_probe.py NAME_OF_THE_NODE. It prints a JSON line: the changed names, and those of the product's table.
"""
import _imp  # noqa: F401 - imported so that it is compared, as those below
import _posixsubprocess  # noqa: F401
import asyncio  # noqa: F401
import concurrent.futures  # noqa: F401
import gc  # noqa: F401
import getpass  # noqa: F401
import json
import os
import platform  # noqa: F401
import resource  # noqa: F401
import select  # noqa: F401
import shutil  # noqa: F401
import signal  # noqa: F401
import socket  # noqa: F401
import sys
import tempfile  # noqa: F401
import traceback  # noqa: F401
import types
from importlib.machinery import SourceFileLoader

import actionlib  # noqa: F401
import numpy
import rosgraph
import rospy

from move_base_abstract_ros.lockstep import program
from move_base_abstract_ros.replacing import replaced

WATCHED = ('rospy', 'actionlib', 'rosgraph', 'roslib', 'threading', 'time', 'queue', 'uuid', 'logging', 'random',
           'os', '_thread', 'tempfile', 'select', 'signal', 'resource', 'concurrent', '_posixsubprocess', 'gc',
           'asyncio', 'xmlrpc', 'getpass', '_imp', 'platform', 'shutil', 'selectors', 'socket',
           'traceback')
FUNCTIONS = (types.FunctionType, types.BuiltinFunctionType, type, classmethod, staticmethod, property)


def contents():
    """Return {dotted name: identity} for all functions and classes of the watched modules."""
    found = {}
    for name, module in sorted(sys.modules.items()):
        if name in WATCHED or name.split('.')[0] in WATCHED:
            for key, value in list(vars(module).items()):
                add(found, '{}.{}'.format(name, key), value, name)
    for name in ('excepthook', 'unraisablehook'):
        found['sys.' + name] = identity(getattr(sys, name))
    for name in ('empty', 'empty_like'):
        found['numpy.' + name] = identity(getattr(numpy, name))
    for name in ('exec_module', 'get_code'):
        found['importlib.machinery.SourceFileLoader.' + name] = identity(getattr(SourceFileLoader, name))
    return found


def add(found, name, value, module):
    if isinstance(value, FUNCTIONS) or callable(value):
        found[name] = identity(value)
    if isinstance(value, type) and value.__module__ == module and name.endswith('.' + value.__name__):  # no alias
        for key, member in list(vars(value).items()):
            if isinstance(member, FUNCTIONS):
                found['{}.{}'.format(name, key)] = identity(member)


def identity(value):
    code = getattr(value, '__code__', None)
    # A function whose code was replaced is listed under its own name, not under the names of its imports.
    return (value, None) if code is None else (value, code)


def changes(before, after):
    """Return the names whose identity has changed."""
    found = set()
    for name, (value, code) in after.items():
        old, old_code = before.get(name, (None, None))
        if old is None and name.rsplit('.', 1)[0] in sys.modules:
            continue  # a name that a module has got in the meantime
        if old is not value:
            found.add(name)
        elif old_code is not code:
            found.add(replaced.name_of(value))
    return sorted(name for name in found if name.rsplit('.', 1)[0] not in found)  # a class counts once


def main():
    """Note the contents, launch the program, and compare."""
    name = sys.argv[1]
    before = contents()

    class Options:
        rank, sleep, seed, strict = None, 'wall', 0, False

    inner = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'replaced_probe_program.py')
    sys.modules['replaced_probe'] = types.SimpleNamespace(tell=lambda: print(json.dumps(
        {'changed': changes(before, contents()), 'done': replaced.done(), 'unknown': replaced.unknown()}), flush=True))
    program.run('script', inner, ['__name:=' + name], Options)


if __name__ == '__main__':
    assert rosgraph and rospy
    main()
