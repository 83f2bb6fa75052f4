"""Check the includes of C++ files against the borders of their folders (docs/architecture.md).

usage: check_includes.py    (in any folder; exit code 1 if a file includes a header that it must not include)

A pure folder may include its own headers, and those of the C++ standard library without threads, files and clocks. Its
sources are also checked with the compiler, which finds indirect includes. On Debian, ROS's headers are in the folder of
the system's headers, so any file could include them unnoticed.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

#: the standard library without threads, files, randomness and clocks
PURE = frozenset((
    'algorithm', 'array', 'cctype', 'cmath', 'cstddef', 'cstdint', 'cstdio', 'cstdlib', 'cstring', 'deque',
    'exception', 'functional', 'initializer_list', 'iterator', 'limits', 'list', 'map', 'memory', 'new',
    'numeric', 'optional', 'set', 'sstream', 'stdexcept', 'string', 'string_view', 'tuple', 'type_traits',
    'unordered_map', 'unordered_set', 'utility', 'variant', 'vector'))

#: {folder: (our other headers that it may include, whether it is pure)}
ROOMS = {
    'src/clock': ((), True),
    'src/motion': (('clock/',), True),
    'src/lockstep/wire': (('clock/',), True),
    'src/lockstep/rounds': (('clock/', 'lockstep/wire/'), True),
    'src/lockstep/radio': (('clock/', 'motion/'), True),
    'src/lockstep/routing': (('clock/', 'lockstep/wire/', 'lockstep/rounds/'), True),
    'src/lockstep/chaos': (('clock/', 'lockstep/wire/', 'lockstep/rounds/', 'lockstep/routing/'), True),
    'src/lockstep': (('clock/', 'motion/', 'lockstep/chaos/', 'lockstep/wire/', 'lockstep/rounds/', 'lockstep/routing/',
                      'lockstep/radio/'), True),
    'src/common': (('libc/ask_kernel.h',), False),
    'src/libc': ((), False),
    'src/roscpp_shim/membership': (('clock/', 'common/', 'libc/crashes.h', 'lockstep/wire/wire.h',
                                    'roscpp_shim/machine/kernel.h'),
                                   False),
    'src/roscpp_shim': (('clock/json_text.h', 'clock/number_text.h', 'common/shared_channel.h', 'libc/',
                         'lockstep/wire/utf8.h', 'lockstep/wire/wire.h', 'roscpp_shim/machine/',
                         'roscpp_shim/membership/membership.h'), False),
    'src/roscpp_shim/machine': (('libc/',), False),
    'src/roscpp_shim/libc': (('libc/', 'lockstep/wire/utf8.h', 'roscpp_shim/machine/', 'roscpp_shim/clocks.h',
                              'roscpp_shim/followed.h', 'roscpp_shim/node.h', 'roscpp_shim/parameters.h',
                              'roscpp_shim/recorder.h', 'roscpp_shim/turn.h', 'roscpp_shim/waits.h'), False),
    'src/roscpp_shim/roscpp': (('roscpp_shim/machine/', 'roscpp_shim/clocks.h', 'roscpp_shim/followed.h',
                                'roscpp_shim/delivery.h',
                                'roscpp_shim/node.h', 'roscpp_shim/parameters.h', 'roscpp_shim/recorder.h',
                                'roscpp_shim/registrations.h',
                                'roscpp_shim/topics.h', 'roscpp_shim/turn.h', 'roscpp_shim/waits.h'), False),
    'src/roscpp_shim/tf2': (('roscpp_shim/machine/', 'roscpp_shim/delivery.h', 'roscpp_shim/followed.h',
                             'roscpp_shim/waits.h'), False),
    'src/python_shim': (('libc/',), False),
    'src/time_master': (('cores/', 'parameters/', 'clock/', 'common/', 'lockstep/'), False),
    'src/time_master/cores': (('clock/', 'time_master/descriptor.h', 'time_master/wall_now.h',
                               'time_master/whole_file.h'), False),
    'include/move_base_abstract': ((), False),
}

#: headers that the build makes: {header: (program that makes it, table)}
MADE = {'lockstep/wire/wire_format.h': ('src/lockstep/wire/make_wire_format.py',
                                        'src/move_base_abstract/lockstep/wire_format.py')}

#: headers of the compiler and libc, below /usr/include
_LIBC = re.compile(r'(?:[\w.-]+-linux-gnu[\w.-]*/)?(?:[\w.-]+\.h|(?:bits|sys|gnu|asm|asm-generic|linux)/.+)$')
_INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
_NO_ROS = re.compile(r'\A(?://[^\n]*\n)*//[^\n]*\bNo ROS\b')
_ROS = re.compile(r'(?:ros|rosgraph_msgs|std_msgs|std_srvs|xmlrpcpp|move_base_abstract)/|XmlRpc')


def crossings(root, room):
    """Return a line for each #include below root/room that its border forbids."""
    others, is_pure = ROOMS[room]
    found = []
    for path in sorted((root / room).glob('*.*')):
        if path.suffix not in ('.h', '.cpp'):
            continue
        text = path.read_text(encoding='utf-8')
        without_ros = is_pure or _NO_ROS.match(text)
        for bracket, name in _INCLUDE.findall(text):
            if bracket == '"':
                own = '/' not in name and (path.parent / name).exists()
                good = own or name.startswith(others or ('\0',)) or name in MADE and room == f'src/{Path(name).parent}'
            else:
                good = name in PURE if is_pure else not (without_ros and _ROS.match(name))
            if not good:
                found.append(f'{path.relative_to(root)}: must not include {name}')
    return found


def comes_in(root, room):
    """Return a line for each header that the compiler reads for a pure folder and that is none of the system's."""
    found = []
    with tempfile.TemporaryDirectory() as made:
        for name, (maker, table) in MADE.items():
            subprocess.run([sys.executable, str(root / maker), str(root / table), f'{made}/{name}'], check=True)
        for path in sorted((root / room).glob('*.cpp')):
            done = subprocess.run(['g++', '-std=c++17', f'-I{root / "src"}', f'-I{made}', '-M', str(path)], check=False,
                                  text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            if done.returncode:
                found.append(f'{path.relative_to(root)}: {done.stderr.strip()}')
            for name in done.stdout.replace('\\\n', ' ').split()[1:]:
                if not _is_allowed(root, room, name, made):
                    found.append(f'{path.relative_to(root)}: {name} comes in')
    return found


def _is_allowed(root, room, name, made):
    path = Path(name).resolve()
    if Path(made) in path.parents:
        return True
    for folder in (room, *(f'src/{other}'.rstrip('/') for other in ROOMS[room][0])):
        if (root / folder) in path.parents:
            return True
    if any(part in name for part in ('/gcc/', '/c++/')):
        return True
    return name.startswith('/usr/include/') and bool(_LIBC.match(name[len('/usr/include/'):]))


def main():
    """Check all folders; return the exit code."""
    found = []
    for room, (_, is_pure) in ROOMS.items():
        found += crossings(ROOT, room) + (comes_in(ROOT, room) if is_pure else [])
    print('\n'.join(found))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
