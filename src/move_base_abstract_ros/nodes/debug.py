"""Debug a run in lockstep: stop it anywhere, look into it, go on and go back.

    rosrun move_base_abstract debug [options of lockstep_launch] [PACKAGE] FILE [ARG:=VALUE ...]
    rosrun move_base_abstract debug --log A.jsonl [--at S | --row N]

The first form starts a run as lockstep_launch does, whose time stands at its start, and asks for commands; help lists
them. The second one starts the run of an event log again, goes to an instant or a row, and holds the run to that log.
Commands may also come from a file or a pipe, and answers may be JSON. What the run prints goes to the standard error
output.

Exit codes: 0 all commands were done, or they came from a terminal; 1 one could not be done, or the run did not come to
its end; 2 the run cannot be started like this; 3 a node crashed; 4 a property is broken; 5 it is not repeatable.
"""
import argparse
import os
import signal
import sys

from move_base_abstract.common import guard, temporary
from move_base_abstract.common.errors import telling
from move_base_abstract.common.input_files import open_text_input
from move_base_abstract.common.kinds import number
from move_base_abstract.common.options import POSITIVE, word_of
from move_base_abstract.runs import run_file

from ..loopback import LoopbackError, find_executable
from .launch_run import launched

_BAD, _CANNOT, _OTHER = 1, 2, 5
#: options of lockstep_launch that mean nothing here, and why
_REFUSED = (('list', 'nothing is started, so that there is nothing to debug'),
            ('script', 'a script starts several runs; debug one of its launch files'),
            ('use_master', 'a debugged run has a ROS master of its own, so that it can start again'))


def main():
    """Debug, and exit with the code."""
    options, run = _parse(sys.argv[1:])
    with telling('debug', LoopbackError, code=_CANNOT), temporary.folder('debug_') as folder:
        sys.exit(_debug(options, run, folder))


def _parse(words):
    """Return (own options, those of lockstep_launch, or None if a log says them)."""
    parser = argparse.ArgumentParser(
        prog='debug', description='Debug a run in lockstep: stop it anywhere, look into it, go on and go back. Its '
        'other options are those of lockstep_launch.', allow_abbrev=False,
        usage='%(prog)s [options] [options of lockstep_launch] [PACKAGE] FILE [ARG:=VALUE ...]\n'
        '       %(prog)s [options] --log A.jsonl [--at S | --row N]',
        epilog='exit codes: 0 all commands were done, 1 one could not be done, or the run did not come to its end, '
        '2 the run cannot be started like this, 3 a node crashed, 4 a property is broken, 5 it is not repeatable')
    parser.add_argument('--log', metavar='PATH', help='start the run of this event log again, by the file PATH.run '
                        'beside it, and hold it to the log')
    where = parser.add_mutually_exclusive_group()
    where.add_argument('--at', type=POSITIVE, metavar='S', help='go to this instant first [s, simulated]')
    where.add_argument('--row', type=word_of(number(1, 2 ** 53, whole=True)), metavar='N', help='go to the round after '
                       'which the log has N rows first')
    parser.add_argument('--commands', metavar='FILE', help='read commands from this file, and then end')
    parser.add_argument('--json', action='store_true', help='answer with one JSON object a line')
    options, rest = parser.parse_known_args(words)
    if options.log is not None:
        if rest:
            parser.error('--log: the file beside the log says what is run; got {} besides'.format(' '.join(rest)))
        return options, None
    run_parser, run = launched.read_words(rest, 'debug')  # refuses what lockstep_launch refuses
    for name, why in _REFUSED:
        if getattr(run, name, False) or getattr(run.one, name, False):
            parser.error('--{} means nothing here: {}'.format(name.replace('_', '-'), why))
    if not run.command:
        run_parser.error('a launch file must be given, FILE or PACKAGE FILE: debug starts a run of its own, in '
                         'lockstep; a run on the scaled clock is held by rosservice call /time_master/pause')
    return options, run


def _debug(options, run, folder):
    """Debug in a temporary folder; return the exit code. ``run``: options of lockstep_launch, None: a log says them."""
    from ..debugging.prompt import is_terminal
    is_typed = options.commands is None and is_terminal()
    for each in guard.signals():
        if not is_typed or each != signal.SIGINT:  # at a prompt, Ctrl-C gives the prompt again
            signal.signal(each, lambda number, _frame: sys.exit(128 + number))
    session = _session(options, run, folder)
    try:
        code, has_refused = _obey(options, session, is_typed)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the run ends in its own time
        ended = session.run.end()
    return code or (0 if session.is_repeatable else _OTHER) or ended or (_BAD if has_refused and not is_typed else 0)


def _session(options, run, folder):
    from ..debugging.debugged_run import DebuggedRun
    from ..debugging.log_so_far import LogSoFar
    from ..debugging.session import Session
    program, log, known = [find_executable('lockstep_launch')], '', None
    if run is not None:
        words, cwd, environment = launched.words_again(run), os.getcwd(), dict(os.environ)
        log = os.path.abspath(run.one.event_log) if run.one.event_log else ''
    else:
        start, known = run_file.read(options.log), LogSoFar(os.path.abspath(options.log))
        words, cwd, environment = start.words, start.folder, start.environment_again(os.environ)
        program = start.program or program
        known.read()
        for line in start.changes():
            print('debug: ' + line, file=sys.stderr)
    return Session(lambda own, path, places: DebuggedRun(program, words, own, cwd, environment, path, places), folder,
                   log, known)


def _obey(options, session, is_typed):
    """Wait until the run stands at its start, and do what is commanded.

    Return (exit code of a run that did not start, whether a command could not be done).
    """
    from ..debugging.prompt import Prompt
    prompt = Prompt(session, options.json)
    try:
        if not session.run.await_start():
            return session.run.await_end() or _BAD, False
        prompt.start(options.at, options.row)
        if options.commands is not None:
            with open_text_input(options.commands, what='file of commands') as stream:
                prompt.obey(stream)
        elif is_typed:
            prompt.ask()
        else:
            prompt.obey(sys.stdin)
    except KeyboardInterrupt:
        print('debug: ended while the run started', file=sys.stderr)
        return 130, False
    return 0, prompt.has_refused
