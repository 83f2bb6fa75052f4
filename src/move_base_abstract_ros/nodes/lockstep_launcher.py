"""Run an unmodified program as a participant of lockstep.

    lockstep [--rank N] [--sleep wall|simulated] [--seed S] [--strict] PROGRAM [ARGUMENTS]
    lockstep [...] -m MODULE [ARGUMENTS]
    <node launch-prefix="rosrun move_base_abstract lockstep" .../>

A Python script runs in this process, behind hooks that join the run when the script calls rospy.init_node. A binary
gets a preloaded library. A shell script is followed to the Python program that it becomes. If the time master does not
work in lockstep, the program runs as if the launcher were not there.
"""
import argparse
import importlib
import os
import re
import sys

from move_base_abstract.common import processes
from move_base_abstract.common.shown import shown
from move_base_abstract.lockstep.wire import MAX_RANK

from ..lockstep.debugging import VARIABLE
from ..lockstep.programs import address_layout, native_library, shell_scripts
from ..lockstep.programs.command_line import PYTHON, find, kind_of, own_words, path_of, split_interpreter

_WHOLE_NUMBER = re.compile(r'[+-]?[0-9]{1,18}\Z', re.ASCII)
_AS_SCRIPT = '--as-script'
#: from our own launch files and runs: main() of the module that follows is a node that takes part by itself
_OWN = '--own'


def main():
    """Run the program, and exit with its exit code."""
    if sys.argv[1:2] == [_OWN] and sys.argv[2:]:
        name = sys.argv[2]
        del sys.argv[1:3]
        importlib.import_module(name).main()
        return
    options, command = _parse(sys.argv[1:])
    try:
        os.environ.update(processes.for_one_thread(os.environ))
        is_new_layout = address_layout.choose(os.environ)
        if not options.as_script and not _is_binary(command[0]):
            _start_again(sys.argv[:len(sys.argv) - len(command)], command, is_new_layout)
        kind, path, arguments = find(command, options.as_script)
        kind, path, arguments = _behind_front_end(kind, path, arguments)
    except ValueError as error:
        sys.exit('lockstep: {}'.format(error))
    # Import only what this kind of program needs. For a binary that is little, and takes a tenth of the time.
    if kind == 'binary':
        from ..lockstep.programs import binary
        if os.environ.get(VARIABLE):
            from ..lockstep.debugging import link
            link.tell_of_binary(os.environ[VARIABLE], binary.node_name(path, arguments, os.environ), path, arguments)
        binary.execute(path, arguments, options)
    elif kind == 'shell':
        shell_scripts.execute(path, arguments, sys.argv[:len(sys.argv) - len(command)])
    else:
        from ..lockstep import program
        program.run(kind, path, arguments, options)


def _is_binary(word):
    """Return whether the program is a binary other than Python: any Python can start such a binary."""
    path = None if word == '-m' or PYTHON.match(os.path.basename(word)) else path_of(word)
    return path is not None and kind_of(path) == 'binary'


def _behind_front_end(kind, path, arguments):
    """Return (kind, path, arguments) of the binary behind a script that is its front end; otherwise those given."""
    if kind != 'script' or os.path.basename(path) != 'rosbag':
        return kind, path, arguments
    from ..lockstep.programs import recorders
    recorder = recorders.behind_front_end(path, arguments)
    return ('binary', *recorder) if recorder else (kind, path, arguments)


def _parse(words):
    parser = argparse.ArgumentParser(prog='lockstep', usage='%(prog)s [options] PROGRAM [ARGUMENTS] | -m MODULE [...]',
                                     description='Run an unmodified program as a participant of lockstep.')
    parser.add_argument('--rank', type=_rank, metavar='N', help='place among events of one instant; lower is earlier '
                        '(default: the private parameter lockstep_rank; without it after the robots, by name)')
    parser.add_argument('--sleep', choices=('wall', 'simulated'), default='wall',
                        help='the time that time.sleep takes (default: %(default)s, while simulated time stands still)')
    parser.add_argument('--seed', type=_whole_number, default=0, metavar='S',
                        help="seed of the program's random numbers, together with the node's name (default: 0)")
    parser.add_argument('--strict', action='store_true',
                        help='end the run with an error at the first reason not to call it repeatable')
    # From this launcher to itself, when it starts again with a Python interpreter: the words after that are a script's.
    parser.add_argument(_AS_SCRIPT, action='store_true', help=argparse.SUPPRESS)
    parser.add_argument('command', nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    split = own_words(words)
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


def _start_again(launcher, command, is_new_layout):
    """Start again, once, with the Python that the program wants, one order of sets and one layout for all runs.

    If the user has chosen an order of sets (PYTHONHASHSEED), it stays. The library that stands in front of libc is
    preloaded, if it can be.
    """
    interpreter, words = split_interpreter(command)
    is_as_wanted = interpreter == [sys.executable] and words == command and 'PYTHONHASHSEED' in os.environ
    if is_as_wanted and not is_new_layout and native_library.is_loaded():
        return
    if not native_library.preload(os.environ) and is_as_wanted and not is_new_layout:
        return
    os.environ.setdefault('PYTHONHASHSEED', '0')
    os.execv(interpreter[0], interpreter + launcher + ([_AS_SCRIPT] if words != command else []) + words)
