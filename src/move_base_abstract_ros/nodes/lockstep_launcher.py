"""Make a participant of lockstep of an unmodified program.

    lockstep [--rank N] [--sleep wall|simulated] [--seed S] [--strict] PROGRAM [ARGUMENTS]
    lockstep [...] -m MODULE [ARGUMENTS]
    <node launch-prefix="rosrun move_base_abstract lockstep" .../>

A Python script runs in this process, behind hooks that join when it calls rospy.init_node; a binary gets a library
preloaded; a shell script is followed to the Python program that it becomes. Where the time master does not work in
lockstep the program runs as if this were not here.
"""
import argparse
import os
import re
import shutil
import sys

from move_base_abstract.common.shown import shown
from move_base_abstract.lockstep.wire import MAX_RANK

from ..lockstep import address_layout, native_library, shell_scripts

_PYTHON = re.compile(r'python[0-9.]*$')
_WHOLE_NUMBER = re.compile(r'[+-]?[0-9]{1,18}\Z', re.ASCII)
_AS_SCRIPT = '--as-script'
_WITH_VALUE = ('-W', '-X', '--check-hash-based-pycs')  # options of Python whose value is a word of its own


def main():
    """Run the program; its exit code is this one's."""
    options, command = _parse(sys.argv[1:])
    try:
        is_new_layout = address_layout.choose(os.environ)
        if not options.as_script and not _is_binary(command[0]):
            _start_again(sys.argv[:len(sys.argv) - len(command)], command, is_new_layout)
        kind, path, arguments = find(command, options.as_script)
        kind, path, arguments = _behind_front_end(kind, path, arguments)
    except ValueError as error:
        sys.exit('lockstep: {}'.format(error))
    # Only what this kind of program needs is imported: for a binary that is little, and takes a tenth of the time.
    if kind == 'binary':
        from ..lockstep import binary
        binary.execute(path, arguments, options)
    elif kind == 'shell':
        shell_scripts.execute(path, arguments, sys.argv[:len(sys.argv) - len(command)])
    else:
        from ..lockstep import program
        program.run(kind, path, arguments, options)


def _is_binary(word):
    """Whether the program is a binary that is no Python: it does not matter to it with which Python this one runs."""
    path = None if word == '-m' or _PYTHON.match(os.path.basename(word)) else _path(word)
    return path is not None and kind_of(path) == 'binary'


def _behind_front_end(kind, path, arguments):
    """Return (kind, path, arguments) of the binary that a script is a front end of, or those of the script."""
    if kind != 'script' or os.path.basename(path) != 'rosbag':
        return kind, path, arguments
    from ..lockstep import recorders
    recorder = recorders.behind_front_end(path, arguments)
    return ('binary', *recorder) if recorder else (kind, path, arguments)


def _parse(words):
    parser = argparse.ArgumentParser(prog='lockstep', usage='%(prog)s [options] PROGRAM [ARGUMENTS] | -m MODULE [...]',
                                     description='Make a participant of lockstep of an unmodified program.')
    parser.add_argument('--rank', type=_rank, metavar='N', help='place among equal events; lower is earlier '
                        '(default: the private parameter lockstep_rank, else after the robots, by name)')
    parser.add_argument('--sleep', choices=('wall', 'simulated'), default='wall',
                        help='what time.sleep waits for (default: %(default)s, while simulated time stands)')
    parser.add_argument('--seed', type=_whole_number, default=0, metavar='S',
                        help="what the program's random numbers start from, with the node's name (default: 0)")
    parser.add_argument('--strict', action='store_true',
                        help='the first reason not to call the run repeatable ends it with an error')
    # From this launcher to itself: the words after a Python interpreter, which it has started again with.
    parser.add_argument(_AS_SCRIPT, action='store_true', help=argparse.SUPPRESS)
    parser.add_argument('command', nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    split = _own_words(words)
    options = parser.parse_args(words[:split])
    if split == len(words):
        parser.error('no program was given')
    return options, words[split:]


def _whole_number(text):
    if not _WHOLE_NUMBER.match(text):
        raise argparse.ArgumentTypeError('must be a whole number of at most 18 digits, got {}'.format(shown(text)))
    return int(text)


def _rank(text):
    value = _whole_number(text)
    if not -MAX_RANK - 1 <= value <= MAX_RANK:
        raise argparse.ArgumentTypeError('must be a whole number in {}..{}, got {}'.format(
            -MAX_RANK - 1, MAX_RANK, shown(text)))
    return value


def _own_words(words):
    """Return how many words are options of the launcher: those before the program or its -m."""
    at = 0
    while at < len(words) and words[at].startswith('-') and words[at] != '-m':
        with_value = words[at] in ('--rank', '--sleep', '--seed')
        at += 2 if with_value else 1
    return min(at, len(words))


def _start_again(launcher, command, is_new_layout):
    """Start again, once, with the Python that the program wants, with one order of sets and one layout for all runs.

    That order is left alone if the user has chosen one. What stands in front of libc is preloaded, if it can be.
    """
    interpreter, words = split_interpreter(command)
    is_as_wanted = interpreter == [sys.executable] and words == command and 'PYTHONHASHSEED' in os.environ
    if is_as_wanted and not is_new_layout and native_library.is_loaded():
        return
    if not native_library.preload(os.environ) and is_as_wanted and not is_new_layout:
        return
    os.environ.setdefault('PYTHONHASHSEED', '0')
    os.execv(interpreter[0], interpreter + launcher + ([_AS_SCRIPT] if words != command else []) + words)


def split_interpreter(command):
    """Return ([Python, its options...], words of the program) of a command line.

    Which Python is this one, unless a path says another: before the program, or in the first line of a script.

    :raises ValueError: if a Python has nothing to run, or cannot be used for this.
    """
    if not _PYTHON.match(os.path.basename(command[0])):
        path = _path(command[0])
        return [_of_script(path) if path else sys.executable], command
    at = 1
    while at < len(command) and command[at].startswith('-') and command[at] != '-m':
        if command[at][:2] in ('-c', '-i') or command[at] == '-':
            raise ValueError("'{}' of a Python interpreter is not possible here; allowed: a script or -m MODULE".format(
                command[at]))
        at += 2 if command[at] in _WITH_VALUE else 1
    if at >= len(command):
        raise ValueError('a Python interpreter needs a script or -m MODULE here')
    return [command[0] if '/' in command[0] else sys.executable] + command[1:at], command[at:]


def _of_script(path):
    """Return the Python of a script's first line if that is a path of its own kind, as of a virtual environment."""
    with open(path, 'rb') as stream:
        first = stream.readline(500)
    words = first[2:].split() if first.startswith(b'#!') else []
    python = os.fsdecode(words[0]) if words else ''
    is_other = _PYTHON.match(os.path.basename(python)) and os.access(python, os.X_OK) and os.path.isfile(
        os.path.join(os.path.dirname(os.path.dirname(python)), 'pyvenv.cfg'))
    return python if is_other else sys.executable


def find(command, is_script=False):
    """Return ('module' | 'script' | 'shell' | 'binary', name or path, arguments) of a command line.

    ``is_script``: it came after a Python interpreter, so that whatever file it is, it is a script.

    :raises ValueError: if there is no such program, or it is of another kind.
    """
    if command[0] == '-m':
        if len(command) < 2:
            raise ValueError('-m needs the name of a module')
        return 'module', command[1], command[2:]
    path = command[0] if is_script else _path(command[0])
    if path is None or not os.path.isfile(path):
        raise ValueError("there is no program '{}'".format(command[0]))
    kind = 'script' if is_script else kind_of(path)
    if kind is None:
        raise ValueError("'{}' is neither a Python or shell script nor a binary; programs that it starts can be given "
                         'themselves'.format(path))
    return kind, path, command[1:]


def script_of(words):
    """Return the path of the Python script that words of a command line have the launcher run, or None."""
    command = words[_own_words(words):]
    try:
        kind, path, _ = find(command) if command and command[0] != '-m' else (None, None, None)
    except (ValueError, OSError):
        return None
    return path if kind == 'script' else None


def _path(word):
    """Return the path of a program, or None."""
    path = word if os.path.isfile(word) else shutil.which(word)
    return path if path is not None and os.path.isfile(path) else None


def kind_of(path):
    """Return 'binary', 'shell' or 'script', or None of a file."""
    with open(path, 'rb') as stream:
        begin = stream.read(200)
    if begin.startswith(b'\x7fELF'):
        return 'binary'
    first = begin.split(b'\n', 1)[0]
    if shell_scripts.is_shell(first):
        return 'shell'
    if path.endswith('.py') or (first.startswith(b'#!') and b'python' in first):
        return 'script'
    return None
