"""The command line: rosrun move_base_abstract experiment run|status|rerun|report."""
from __future__ import annotations

import argparse
import os
import sys
from typing import Optional, Sequence

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.kinds import number
from move_base_abstract.common.options import add_arguments, given, word_of
from move_base_abstract.lockstep.run_options import RunOptions

from . import ending
from .ending import CANNOT, INTERRUPTED

GOOD, BAD = 0, 1
_COUNT = word_of(number(1, 1024, whole=True))
_AMOUNT = word_of(number(above=0.0, high=1e9))


def main(words: Optional[Sequence[str]] = None) -> int:
    """Run the command with these arguments; return the exit code, which the epilog of --help explains."""
    options = _parse(words)
    return ending.exit_code('experiment', lambda: options.act(options))


def _parse(words: Optional[Sequence[str]]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog='experiment', description='Run any system many times, on all cores, and report the results.',
        epilog='exit codes: 0 all trials are complete, 1 some failed, have an error or differ, 2 the experiment cannot '
        'be run like this, 3 a trial that was run again differs, and so do its inputs, 130 interrupted (Ctrl-C, '
        'SIGTERM, SIGHUP). Complete trials stay, and the same command goes on')
    verbs = parser.add_subparsers(dest='verb', metavar='run|status|rerun|report', required=True)
    run = verbs.add_parser('run', help='run the trials that are not complete')
    run.add_argument('file', metavar='FILE', help='the experiment, a YAML file')
    run.add_argument('-o', '--output', required=True, metavar='OUT', help='folder of the experiment: new, empty, or '
                     'made by this program')
    where = run.add_mutually_exclusive_group()
    where.add_argument('--workers', type=_COUNT, default=None, metavar='N', help='worker processes on this computer '
                       '(default: one per core)')
    where.add_argument('--scheduler', metavar='ADDRESS', help='use a running Dask scheduler, tcp://HOST:PORT')
    run.add_argument('--dashboard', action='store_true', help="serve Dask's dashboard on 127.0.0.1")
    run.add_argument('--keep-old', action='store_true', help='keep complete trials whose program has changed since, '
                     'with a label; without this option they run again')
    add_arguments(run.add_argument_group(
        "options of the trials' runs",
        "they take precedence over the file's keys; values of lists and mappings are added to the file's"), RunOptions)
    run.set_defaults(act=_run)
    status = verbs.add_parser('status', help='print how far the experiment has come')
    status.add_argument('output', metavar='OUT')
    status.set_defaults(act=_status)
    rerun = verbs.add_parser('rerun', help='run one trial again on this computer, and say whether it is the same')
    rerun.add_argument('output', metavar='OUT')
    rerun.add_argument('trial', metavar='TRIAL', help='the trial, by its id or the number that the id begins with')
    rerun.add_argument('--rviz', action='store_true', help='show the trial in RViz')
    rerun.add_argument('--until', type=_AMOUNT, default=0.0, metavar='S', help='end at this simulated time [s]')
    rerun.add_argument('--speed', type=_AMOUNT, default=0.0, metavar='F', help='run at most F times as fast as '
                       'real time')
    rerun.add_argument('--logs', metavar='FOLDER', help='keep the logs of this run in this new folder')
    rerun.set_defaults(act=_rerun)
    report = verbs.add_parser('report', help='write report.html and tables of the results')
    report.add_argument('output', metavar='OUT')
    report.add_argument('--without-own-sections', action='store_true', help="do not run the functions that the "
                        "experiment names under 'report'; for folders that somebody else made")
    report.set_defaults(act=_report)
    return parser.parse_args(words)


def _run(options: argparse.Namespace) -> int:
    from . import sweep
    try:
        bad = sweep.run(options.file, options.output, options.workers or os.cpu_count() or 1, options.scheduler,
                        keep_old=options.keep_old, has_dashboard=options.dashboard, given=given(RunOptions, options))
        try:
            _write_report(options.output)
        except SimulatorError as error:  # the trials are complete nevertheless
            print(f'experiment: no report: {error}', file=sys.stderr)
    except KeyboardInterrupt:
        print('experiment: interrupted; complete trials stay, and the same command goes on', file=sys.stderr)
        return INTERRUPTED
    return BAD if bad else GOOD


def _status(options: argparse.Namespace) -> int:
    from .results import state
    for line in state.lines(options.output):
        print(line)
    return GOOD


def _report(options: argparse.Namespace) -> int:
    return GOOD if _write_report(options.output, not options.without_own_sections) else CANNOT


def _write_report(output: str, with_own: bool = True) -> bool:
    """Write the report; print its path, and what could not be made.

    Return False if a Python package that it needs is not installed, otherwise True.
    """
    try:
        from .report import command
    except ModuleNotFoundError as error:
        print(f'experiment: no report: {error.name} is not installed; on Debian: apt install python3-jinja2 '
              'python3-pandas python3-scipy', file=sys.stderr)
        return False
    path, problems = command.write(output, with_own)
    for problem in problems:
        print(f'experiment: {problem}', file=sys.stderr)
    print(f'report: {os.path.abspath(path)}')
    return True


def _rerun(options: argparse.Namespace) -> int:
    from . import rerun
    return rerun.rerun(options.output, options.trial, until=options.until, speed=options.speed, rviz=options.rviz,
                       logs=options.logs)
