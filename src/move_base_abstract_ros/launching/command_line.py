"""The command lines of programs that start launch files: the options of a run, and FILE or PACKAGE FILE, ARG:=VALUE."""
import argparse
import os
from dataclasses import dataclass

from move_base_abstract.common.kinds import FLAG, number, pattern
from move_base_abstract.common.options import add_arguments, of_arguments, option, words_of
from move_base_abstract.common.shown import pasted, shown
from move_base_abstract.lockstep.run_options import RunOptions

USAGE = '%(prog)s [options] [PACKAGE] FILE [ARG:=VALUE ...], or several FILEs'


@dataclass(frozen=True)
class OneRun:
    """The options of lockstep_launch that are about one run: its log, its speed, its end and its ROS master."""

    event_log: str = option(pattern(r'.+\.(jsonl|csv)', 'a path that ends in .jsonl or .csv'), None, "the file of the "
                            "run's [events](time_master.md#event-log)", parameter='event_log', metavar='PATH')
    log_messages: bool = option(FLAG, False, 'the events have messages and calls, too', parameter='log_messages')
    speed_limit: float = option(number(0.01, 1e6, or_zero=True, unit='simulated s per wall s'), None, 'the run has at '
                                'most F simulated seconds per wall second; 0: no limit', parameter='speed_limit',
                                metavar='F', absent=None)
    end_when_idle: bool = option(FLAG, False, 'the run ends when no participant has anything left to do',
                                 parameter='end_when_idle')
    check: bool = option(FLAG, False, 'all [properties](properties.md) are checked when the run is over; implies '
                         '`--end-when-idle`')
    use_master: bool = option(FLAG, False, 'the run uses the ROS master of `ROS_MASTER_URI`, in the place of one of '
                              'its own')


def add_run(parser, cls=RunOptions, refused=None, nargs='*'):
    """Add the options of a run, and the words FILE or PACKAGE FILE, ARG:=VALUE, to ``parser``.

    ``cls``: RunOptions, or a class of these with other words; ``refused``: as add_arguments() has it; ``nargs``: of the
    words. Options may stand among them if parse_intermixed_args() is called, in the place of parse_args().
    """
    add_arguments(parser, cls, refused)
    parser.add_argument('command', nargs=nargs, help=argparse.SUPPRESS)


def run_of(parser, options):
    """Return the RunOptions among the options that ``parser`` has parsed; see of_arguments()."""
    return of_arguments(RunOptions, parser, options)


def files_of(parser, words):
    """Return [(path, arguments)] of the words FILE ... or PACKAGE FILE, and ARG:=VALUE, which all files get.

    If they are anything else, ``parser`` ends the program with an error.
    """
    from roslaunch import rlutil
    from roslaunch.core import RLException
    arguments = [word for word in words if ':=' in word]
    names = [word for word in words if ':=' not in word]
    if not names:
        parser.error('a launch file must be given: FILE, or PACKAGE FILE; got nothing')
    are_files = len(names) > 1 and all(map(os.path.isfile, names))
    try:
        found = names if are_files else rlutil.resolve_launch_arguments(names)
    except RLException as error:
        parser.error(str(error))
    if not are_files and len(found) != 1 or found[0] == '-':
        parser.error('launch files must be given as FILE ..., or one as PACKAGE FILE; got {}'.format(
            shown(' '.join(names))))
    return [(os.path.abspath(path), arguments) for path in found]


def of_adopted(run, command):
    """Return a line that says how to see what `--adopt` makes of a launch file. ``command``: the file's words."""
    return 'what is made of the launch file, and what of it has no effect: ' + typed(
        'lockstep_launch', ['--list'], run, command)


def typed(program, *parts):
    """Return a command that can be typed: ``program`` of this package, with records of options, or words, in turn."""
    words = [word for part in parts for word in (part if isinstance(part, (list, tuple)) else words_of(part))]
    return 'rosrun move_base_abstract {}'.format(pasted(program, *words))
