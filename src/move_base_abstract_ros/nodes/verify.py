"""Verify that a launch file runs the same whatever the machine does.

    rosrun move_base_abstract verify [options] FILE [ARG:=VALUE ...]
    rosrun move_base_abstract verify [options] PACKAGE FILE [ARG:=VALUE ...]
    rosrun move_base_abstract verify [options] --chaos FILE

Runs the file in lockstep, as lockstep_launch does: twice as it is, then with every core busy, at a limited speed, with
random delays, other hash seeds, other addresses, and the fleet in two processes. Prints `identical`, or the first
difference.

Exit codes: 0 identical, and called repeatable; 1 different; 2 the file cannot be run like this; 3 a run did not come to
its end; 4 identical, but labelled (not called repeatable, or degraded), or nothing to compare; 5 a node crashed; 6
identical, but a property is broken (--property).
"""
import argparse
import os
import sys

from move_base_abstract.common import guard, processes, temporary
from move_base_abstract.common.errors import SimulatorError, telling
from move_base_abstract.common.kinds import number
from move_base_abstract.common.lasting_output import outlive_readers
from move_base_abstract.common.options import POSITIVE, word_of, words_of
from move_base_abstract.common.own_files import FolderKind
from move_base_abstract.common.shown import shown

from ..launching import command_line, conditions, warm_nodes
from ..loopback import LoopbackError
from .launch_run import launched

with warm_nodes.importing():
    from ..launching import verification

_FOLDER = FolderKind('verification')


def main(words=None):
    """Verify and exit with the code."""
    outlive_readers()
    words = sys.argv[1:] if words is None else words
    warm_nodes.start_again()
    guard.stand('verify')
    processes.adopt_orphans()
    with warm_nodes.importing():
        options, launch_words = _parse(words)
        warm_nodes.import_all()  # once for all runs
    with telling('verify', LoopbackError, code=verification.CANNOT):
        try:
            sys.exit(_verify(options, launch_words))
        except verification.Unfinished as error:
            print('verify: {}'.format(error), file=sys.stderr)
            sys.exit(error.code)


def _verify(options, launch_words):
    """Verify, and return the exit code.

    Without --output the folder is temporary. It is removed if all runs are identical, and none is labelled.
    """
    folder = options.output
    if folder is None:
        folder = temporary.make('verify_')
    else:
        folder = os.path.abspath(folder)  # because nodes run in another working folder
        if os.path.isdir(folder) and os.listdir(folder):
            parser_error = "{}: is not empty (it holds '{}'); name a new folder, or an empty one"
            raise verification.Unfinished(parser_error.format(folder, sorted(os.listdir(folder))[0]),
                                          verification.CANNOT)
        os.close(_FOLDER.make(folder))
    code = None
    if options.run.adopt:
        _say(command_line.of_adopted(options.run, options.command))
    try:
        run = verification.Verification(_start, launch_words, _next_steps(options), folder, options.time_limit, _say)
        code = run.verify(_names(options))
        return code
    finally:
        if options.output is None and code in (verification.IDENTICAL, verification.CANNOT):
            temporary.remove(folder)
        else:
            if options.output is None:
                temporary.keep(folder)
            print('verify: logs and outputs are in {}'.format(folder), flush=True)


def _start(words):
    """Run lockstep_launch in this process, and return the Launched."""
    try:
        return launched.launch(*launched.read_words(words))
    except SystemExit as error:  # its words are wrong; it has said why
        return launched.Launched(error.code)


def _say(line):
    print('verify: {}'.format(line) if not line.startswith('  ') else line, flush=True)


def _names(options):
    if options.conditions is not None:
        return options.conditions
    # The decisions of chaos follow from the names of nodes, and a fleet in two processes has other names.
    left_out = ('split',) if options.chaos is not None or options.run.chaos_seed else ()
    return [name for k, name in enumerate(conditions.NAMES)
            if (options.runs is None or k < options.runs) and name not in left_out]


def _parse(words):
    """Return (options, words for lockstep_launch)."""
    parser = argparse.ArgumentParser(
        prog='verify', description='Check that a launch file runs the same, whatever the machine does.',
        usage=command_line.USAGE + '\n       %(prog)s [options] --chaos FILE',
        epilog='exit codes: 0 identical, 1 different, 2 the file cannot be run like this, 3 a run did not come to its '
        'end, 4 identical but labelled (or nothing to compare), 5 a node crashed, 6 a property is broken')
    command_line.add_run(parser)
    which = parser.add_mutually_exclusive_group()
    count = word_of(number(2, len(conditions.NAMES), whole=True))
    which.add_argument('--runs', type=count, metavar='N', help='run only the first N conditions, 2 to {} (default: '
                       'all)'
                       .format(len(conditions.NAMES)))
    which.add_argument('--conditions', type=_conditions, metavar='A,B', help='run only these conditions: {}'.format(
        ', '.join(conditions.NAMES)))
    parser.add_argument('--time-limit', type=POSITIVE, default=600.0, metavar='S',
                        help='time that a run may take [s, wall] (default: %(default)g)')
    parser.add_argument('--output', metavar='FOLDER', help='new or empty folder for logs and outputs '
                        '(default: a temporary one, which is kept if something is wrong)')
    parser.add_argument('--chaos', metavar='FILE', help='verify the run that a file from `chaos` describes')
    options = parser.parse_intermixed_args(words)
    options.run = command_line.run_of(parser, options)
    if options.chaos is not None:
        _read_chaos(parser, options)
    command_line.files_of(parser, options.command)
    return options, words_of(options.run) + options.command


def _read_chaos(parser, options):
    """Take the run from a file of `chaos`, which holds all of it."""
    from move_base_abstract.lockstep import replay_file
    besides = words_of(options.run) + options.command
    if besides:
        parser.error('--chaos: the file says what is run; got {} besides'.format(shown(' '.join(besides))))
    try:
        made = replay_file.read(options.chaos)
        if made.test:
            parser.error('--chaos: {} is of a test, which runs alone: {}'.format(
                options.chaos, command_line.typed('chaos', ['--replay', options.chaos])))
        options.run, options.command = made.run, list(made.launch)
    except SimulatorError as error:
        parser.error(str(error))


def _next_steps(options):
    """Return what to type next, for Verification."""
    run, command = options.run, options.command
    steps = {verification.LABELLED: 'which nodes take part, and which look on: ' + (
        command_line.typed('lockstep_launch', ['--list'], run, command))}
    if options.chaos is not None:
        steps[verification.IDENTICAL] = 'the failure again: ' + command_line.typed('chaos', ['--replay', options.chaos])
    elif run.chaos_seed or run.lookahead:
        steps[verification.IDENTICAL] = 'one run, with its events: ' + command_line.typed(
            'lockstep_launch', ['--event-log', 'events.jsonl'], run, command)
    else:
        steps[verification.IDENTICAL] = 'the search for another order of equal events that breaks it: ' + (
            command_line.typed('chaos', run, command))
    return steps


def _conditions(text):
    names = text.split(',')
    for name in names:
        if name not in conditions.NAMES:
            raise argparse.ArgumentTypeError('must be of {}, got {}'.format(', '.join(conditions.NAMES), shown(name)))
    if len(set(names)) < 2:
        raise argparse.ArgumentTypeError('must be two conditions at least, got {}'.format(shown(text)))
    return names
