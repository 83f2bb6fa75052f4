"""Make a participant of lockstep of an unmodified program.

    lockstep [--rank N] [--sleep wall|simulated] [--seed S] PROGRAM [ARGUMENTS]
    lockstep [...] -m MODULE [ARGUMENTS]
    <node launch-prefix="rosrun move_base_abstract lockstep" .../>

A Python script runs in this process, behind hooks that join when it calls rospy.init_node; a binary gets a library
preloaded. Where the time master does not work in lockstep the program runs as if this were not here.
"""
import argparse
import os
import shutil
import sys

from ..lockstep import program

_PYTHON = 'python'


def main():
    """Run the program; its exit code is this one's."""
    options, command = _parse(sys.argv[1:])
    _with_fixed_hashes()
    try:
        kind, path, arguments = find(command)
    except ValueError as error:
        sys.exit('lockstep: {}'.format(error))
    if kind == 'binary':
        from ..lockstep import binary
        binary.execute(path, arguments, options)
    else:
        program.run(kind, path, arguments, options)


def _parse(words):
    parser = argparse.ArgumentParser(prog='lockstep', usage='%(prog)s [options] PROGRAM [ARGUMENTS] | -m MODULE [...]',
                                     description='Make a participant of lockstep of an unmodified program.')
    parser.add_argument('--rank', type=int, metavar='N', help='place among equal events; lower is earlier '
                        '(default: the private parameter lockstep_rank, else after the robots, by name)')
    parser.add_argument('--sleep', choices=('wall', 'simulated'), default='wall',
                        help='what time.sleep waits for (default: %(default)s, while simulated time stands)')
    parser.add_argument('--seed', type=int, default=0, metavar='S',
                        help="seed of Python's and numpy's global generators, with the node's name (default: 0)")
    parser.add_argument('command', nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    split = _own_words(words)
    options = parser.parse_args(words[:split])
    if split == len(words):
        parser.error('no program was given')
    return options, words[split:]


def _own_words(words):
    """Return how many words are options of the launcher: those before the program or its -m."""
    at = 0
    while at < len(words) and words[at].startswith('-') and words[at] != '-m':
        with_value = words[at] in ('--rank', '--sleep', '--seed')
        at += 2 if with_value else 1
    return min(at, len(words))


def _with_fixed_hashes():
    """Start again with one order of sets for all runs, if the user has not chosen one."""
    if 'PYTHONHASHSEED' not in os.environ:
        os.environ['PYTHONHASHSEED'] = '0'
        os.execv(sys.executable, [sys.executable] + sys.argv)


def find(command):
    """Return ('module' | 'script' | 'binary', name or path, arguments) of a command line.

    :raises ValueError: if there is no such program, or it is of another kind.
    """
    if command[0] == '-m':
        if len(command) < 2:
            raise ValueError('-m needs the name of a module')
        return 'module', command[1], command[2:]
    path = command[0] if os.path.isfile(command[0]) else shutil.which(command[0])
    if path is None or not os.path.isfile(path):
        raise ValueError("there is no program '{}'".format(command[0]))
    if os.path.basename(path).startswith(_PYTHON) and _kind(path) == 'binary':
        return _of_python(command[1:])
    kind = _kind(path)
    if kind is None:
        raise ValueError("'{}' is neither a Python script nor a binary; programs that it starts can be given "
                         'themselves'.format(path))
    return kind, path, command[1:]


def _of_python(words):
    """Return the same for the words after a Python interpreter's name."""
    while words and words[0].startswith('-') and words[0] != '-m':
        words = words[1:]
    if not words:
        raise ValueError('a Python interpreter needs a script or -m MODULE here')
    return find(words) if words[0] == '-m' else ('script', words[0], words[1:])


def _kind(path):
    with open(path, 'rb') as stream:
        begin = stream.read(200)
    if begin.startswith(b'\x7fELF'):
        return 'binary'
    first = begin.split(b'\n', 1)[0]
    if path.endswith('.py') or (first.startswith(b'#!') and b'python' in first):
        return 'script'
    return None
