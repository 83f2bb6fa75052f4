"""Run an unchanged Python script that starts launch files by ROSLaunchParent: each of them becomes a run in lockstep.

    rosrun move_base_abstract lockstep_launch --script [--logs FOLDER] [options] SCRIPT [ARGUMENTS]

A node takes part in each run for the script, and does what the script asks rospy for. What the script computes takes no
simulated time. When the script calls shutdown(), the run ends at that instant. Each run has a ROS master and an event
log of its own. The event logs are written to FOLDER (default: lockstep_series_logs).

Exit codes: that of the script; if that is 0, the worst one of lockstep_launch. 2: the script cannot be run like this.
"""
import functools
import itertools
import os
import re
import runpy
import sys
import types

from move_base_abstract.common import guard
from move_base_abstract.common.errors import SimulatorError

from ...loopback import LoopbackError, find_executable

_FOLDER = 'lockstep_series_logs'
_NO_MASTER = 'http://127.0.0.1:1/'  # no program listens there: a script must not reach a system that runs elsewhere
_CANNOT = 2


def main(words):
    """Run the script that the words of the command line after `--script` name, and exit with the code."""
    try:
        folder, options, words = _parse(words)
        _hash_alike()
        guard.stand('lockstep_launch')
        again = _again(folder, options, words)
        code = _run(os.path.abspath(folder), options, words)
        if code == 0:
            print('lockstep_launch: next: the same runs again, to compare their logs: ' + again)
    except (SimulatorError, LoopbackError) as error:
        print('lockstep_launch: {}'.format(error), file=sys.stderr)
        code = _CANNOT
    sys.exit(code)


def _parse(words):
    """Return (folder, options of lockstep_launch, [script, arguments])."""
    import argparse

    from move_base_abstract.common.options import add_arguments, of_arguments, words_of

    from ...launching import command_line
    about, _, rest = __doc__.partition('\n\n')
    parser = argparse.ArgumentParser(prog='lockstep_launch --script', usage='%(prog)s [options] SCRIPT [ARGUMENTS]',
                                     description=about, epilog=rest.partition('\n\n')[2].replace('\n', ' '))
    parser.add_argument('--logs', default=_FOLDER, metavar='FOLDER', help='folder of the event logs '
                        '(default: %(default)s)')
    add_arguments(parser, command_line.OneRun, {
        'event_log': '--logs names the folder of the event logs', 'use_master': 'each run has a ROS master of its own'})
    command_line.add_run(parser, nargs=argparse.REMAINDER)
    options = parser.parse_args(words)
    if not options.command or not os.path.isfile(options.command[0]):
        raise SimulatorError('a Python script must follow the options, got {}'.format(
            ' '.join(options.command) or 'nothing'))
    given = [word for one in (of_arguments(command_line.OneRun, parser, options), command_line.run_of(parser, options))
             for word in words_of(one)]
    return options.logs, given, options.command


def _again(folder, options, words):
    """Return a command that runs the script again, with its logs in a folder that does not exist yet."""
    from ...launching import command_line
    names = ('{}_{}'.format(folder.rstrip('/'), number) for number in itertools.count(2))
    new = next(name for name in names if not os.path.lexists(name))
    return command_line.typed('lockstep_launch', ['--script', '--logs', new, *options, *words])


def _hash_alike():
    """Start again with a fixed hash seed, if hashes would differ in each run: a script may iterate over a set."""
    if os.environ.get('PYTHONHASHSEED', 'random') == 'random':
        os.environ['PYTHONHASHSEED'] = '0'
        os.execv(sys.executable, [sys.executable, *sys.argv])


def _run(folder, options, words):
    import roslaunch.parent  # noqa: F401 - before the script's rospy is there
    import roslaunch.scriptapi  # noqa: F401
    from roslaunch.core import RLException

    from ...launching.scripted.series import Parent, Series
    from ...replacing.replaced import replace
    os.environ['ROS_MASTER_URI'] = _NO_MASTER
    series = Series(find_executable('lockstep_launch'), options, folder, _name(words[0]))

    def refuse(*_args, **_kwds):
        raise RLException('roslaunch.scriptapi.ROSLaunch starts nodes one by one, which is not a run in lockstep; '
                          'allowed: ROSLaunchParent')
    replace('roslaunch.parent.ROSLaunchParent', lambda _original: functools.partial(Parent, series))
    replace('roslaunch.scriptapi.ROSLaunch', lambda _original: refuse)
    sys.modules['rospy'] = series.deputised.module()
    sys.modules['time'] = _time(series.deputised)
    return _execute(series, words)


def _execute(series, words):
    sys.argv[:] = words  # in place, as in warm_nodes.become
    sys.path[0] = os.path.dirname(os.path.realpath(words[0]))
    code = 0
    try:
        runpy.run_path(words[0], run_name='__main__')
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
        if isinstance(error.code, str):
            print(error.code, file=sys.stderr)
    finally:
        series.close()
    return code or series.code


def _name(path):
    """Return the name of the node that takes part for a script: the name of its file, made valid."""
    stem = re.sub('[^A-Za-z0-9]', '_', os.path.basename(path).partition('.')[0])
    return stem if stem[:1].isalpha() else 'script_' + stem


def _time(deputised):
    """Return the module time for the script: while a run is under way, its own calls of sleep take simulated time."""
    import time
    made = types.ModuleType('time')
    made.__dict__.update(vars(time))

    def sleep(seconds):
        if deputised.is_under_way and sys._getframe(1).f_globals.get('__name__') == '__main__':
            deputised.ask('sleep', seconds)
        else:
            time.sleep(seconds)
    made.sleep = sleep
    return made
