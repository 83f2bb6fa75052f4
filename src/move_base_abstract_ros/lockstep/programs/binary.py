"""Make an unmodified roscpp binary a participant, by preloading the library that stands in front of roscpp.

docs/lockstep_roscpp.md says what is exact then.
"""
from __future__ import annotations

import os
import shutil
import stat
import struct
import subprocess
import sys
from typing import Any, List, Mapping, Sequence, Tuple

from . import recorders

SHIM = 'libmove_base_abstract_roscpp_shim.so'
_LOOPBACK_ONLY = 'libmove_base_abstract_loopback_only.so'
_ROSCPP = 'libroscpp.so'
_RANK = 'MOVE_BASE_ABSTRACT_LOCKSTEP_RANK'
_SLEEP = 'MOVE_BASE_ABSTRACT_LOCKSTEP_SLEEP'
_CHANCE = 'MOVE_BASE_ABSTRACT_LOCKSTEP_CHANCE'
_STRICT = 'MOVE_BASE_ABSTRACT_LOCKSTEP_STRICT'
#: (name, value) of the variable by which a program that is linked to the library looks on all the same
LOOKS_ON = ('MOVE_BASE_ABSTRACT_LOOKS_ON', '1')
PRELOAD = 'LD_PRELOAD'
_NAME, _NAMESPACE = '__name:=', '__ns:='
# Of the ELF format, 64 bits, little endian.
_HEADER = struct.Struct('<16sHHIQQQIHHHHHH')
_SEGMENT = struct.Struct('<IIQQQQQQ')
_ENTRY = struct.Struct('<qQ')
_LOAD, _DYNAMIC = 1, 2
_NEEDED, _STRING_TABLE = 1, 5


def execute(path: str, arguments: Any, options: Any) -> None:
    """Become the program, by exec; this does not return. If the binary cannot take part, exit with a message."""
    try:
        environment = prepare(path, options.rank, options.sleep, os.environ)
    except ValueError as error:
        sys.exit('lockstep: {}'.format(error))
    if _parameter('mode') == 'lockstep':
        if recorders.is_program(path):
            arguments = recorders.without_past_lockstep(arguments, _parameter('excluded_topics') or [])
        environment[_CHANCE] = '{} {}'.format(options.seed, node_name(path, arguments, environment))
    if options.strict:
        environment[_STRICT] = '1'
    os.execve(path, [path] + arguments, environment)


def prepare(path: str, rank: int, sleep: Any, environment: Any) -> Any:
    """Return the environment in which the binary takes part.

    :param path: the path of the binary.
    :param rank: the node's rank, or None.
    :param sleep: the time that a sleep takes: 'wall' or 'simulated'.
    :param environment: the environment without it.
    :raises ValueError: if the binary cannot take part.
    """
    if not links_to_roscpp(path):
        needed = ', '.join(needed_libraries(path)) or 'no library (it is static)'
        raise ValueError("'{}' is not a roscpp program: it needs {}, but not {}. If it starts one, give that program "
                         'instead'.format(path, needed, _ROSCPP))
    if os.stat(path).st_mode & (stat.S_ISUID | stat.S_ISGID):
        raise ValueError("'{}' runs with the rights of another user or group (setuid, setgid): the system does not "
                         'preload a library into it'.format(path))
    result = dict(environment)
    result.pop(LOOKS_ON[0], None)
    result[PRELOAD] = preloaded(SHIM, environment)
    if rank is not None:
        result[_RANK] = str(rank)
    result[_SLEEP] = sleep
    return result


def loopback_only(environment: Any) -> Tuple[str, str]:
    """Return (name, value) of the variable by which a roscpp onlooker listens on 127.0.0.1 only, if that is its ROS_IP.

    :raises ValueError: as :func:`find_shim` does.
    """
    return PRELOAD, preloaded(_LOOPBACK_ONLY, environment)


def preloaded(library: str, environment: Mapping[str, str]) -> str:
    """Return the value of PRELOAD with a library before all others.

    :raises ValueError: as :func:`find_shim` does.
    """
    return ' '.join([find_shim(environment, library), *environment.get(PRELOAD, '').replace(':', ' ').split()])


def node_name(path: str, arguments: Sequence[str], environment: Any) -> str:
    """Return a node's name as its command line has it, without a name that the program may choose later itself."""
    name, namespace = os.path.basename(path), environment.get('ROS_NAMESPACE', '')
    for word in arguments:
        if word.startswith(_NAME):
            name = word[len(_NAME):]
        elif word.startswith(_NAMESPACE):
            namespace = word[len(_NAMESPACE):]
    return '/{}/{}'.format(namespace.strip('/'), name) if namespace.strip('/') else '/' + name


def _parameter(name: str) -> Any:
    """Return a parameter of the time master, or None if it is not set or the ROS master cannot be asked."""
    try:
        from xmlrpc.client import ServerProxy  # only now: it takes a while
        code, _, value = ServerProxy(os.environ['ROS_MASTER_URI']).getParam('/lockstep', '/time_master/' + name)
        return value if code == 1 else None
    except Exception:
        return None  # the program itself will find out, or fail


def find_shim(environment: Mapping[str, str], library: str = SHIM) -> str:
    """Return the path of a library to preload, in catkin's devel or install space.

    :raises ValueError: if it is in none of the folders.
    """
    prefixes = environment.get('CMAKE_PREFIX_PATH', '').split(os.pathsep)
    folders = [os.path.join(prefix, 'lib') for prefix in prefixes if prefix]
    folders += [folder for folder in environment.get('LD_LIBRARY_PATH', '').split(os.pathsep) if folder]
    # Without an environment: PREFIX/lib/python3/dist-packages/move_base_abstract_ros/lockstep/programs/binary.py
    folders.append(os.path.normpath(os.path.join(os.path.dirname(__file__), *[os.pardir] * 5)))
    for folder in folders:
        path = os.path.join(folder, library)
        if os.path.isfile(path):
            return path
    raise ValueError('{} is in none of {}; source the setup.sh of the workspace that has move_base_abstract'.format(
        library, ', '.join(folders)))


def links_to_roscpp(path: str) -> bool:
    """Return whether a program needs roscpp, directly or through the libraries that it needs.

    :raises ValueError: as :func:`needed_libraries` does.
    """
    needed = needed_libraries(path)
    loader = shutil.which('ldd')
    if needed and loader and not any(name.startswith(_ROSCPP) for name in needed):
        listed = subprocess.run([loader, path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
        needed = [line.strip() for line in listed.stdout.decode('utf-8', 'replace').splitlines()]
    return any(name.startswith(_ROSCPP) for name in needed)


def needed_libraries(path: str) -> List[str]:
    """Return the names of the shared libraries that an ELF file needs.

    :raises ValueError: if it is not a 64-bit little-endian ELF file, or is damaged.
    """
    with open(path, 'rb') as stream:
        data = stream.read()
    if len(data) < _HEADER.size or data[:6] != b'\x7fELF\x02\x01':
        raise ValueError("'{}' is not a 64-bit little-endian ELF program".format(path))
    try:
        return _needed(data)
    except (struct.error, IndexError, UnicodeDecodeError):
        raise ValueError("'{}' is a damaged ELF program".format(path)) from None


def _needed(data: bytes) -> List[str]:
    header = _HEADER.unpack_from(data)
    at, size, count = header[5], header[9], header[10]
    segments = [_SEGMENT.unpack_from(data, at + size * k) for k in range(count)]
    entries = []
    for kind, _flags, offset, _address, _physical, length, _memory, _align in segments:
        if kind == _DYNAMIC:
            entries = [_ENTRY.unpack_from(data, offset + k) for k in range(0, length, _ENTRY.size)]
    tables = [value for tag, value in entries if tag == _STRING_TABLE]
    if not tables:
        return []
    begin = _offset(tables[0], segments)
    return [_text(data, begin + value) for tag, value in entries if tag == _NEEDED]


def _offset(address: int, segments: Sequence[Tuple[int, ...]]) -> int:
    """Return the offset in the file of a memory address."""
    for kind, _flags, offset, virtual, _physical, length, _memory, _align in segments:
        if kind == _LOAD and virtual <= address < virtual + length:
            return offset + address - virtual
    raise IndexError(address)


def _text(data: bytes, begin: int) -> str:
    return data[begin:data.index(b'\0', begin)].decode('utf-8')
