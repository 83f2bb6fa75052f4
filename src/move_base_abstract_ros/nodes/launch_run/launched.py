"""A run of a launch file in lockstep, in this process: its command line, the run itself, and what is said of it."""
import argparse
import dataclasses
import json
import os
import re
import signal
import sys
from contextlib import nullcontext
from typing import NamedTuple
from xml.etree import ElementTree

from move_base_abstract.common import guard, processes, temporary
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.options import add_arguments, of_arguments, parameters_of, words_of
from move_base_abstract.common.own_files import whole_file
from move_base_abstract.common.shown import printable, shown_text
from move_base_abstract.lockstep.run_options import FAIL
from move_base_abstract.properties import Judgement, Run, judgement_on
from move_base_abstract.radio import network
from move_base_abstract.runs import debug_command, ends, error_lines, run_file

from ...debugging import MASTER_NOTE, PARAMETERS
from ...launching import command_line, warm_nodes

_GOOD, _BAD, _CANNOT, _CRASHED, _BROKEN = range(5)
#: parts of errors of launch files that were written for something that is not here
_OF_OTHERS = ('publishes /clock', 'programs are not here', 'does not exist', 'unknown machine', 'environment variable')
_OF_ROSLAUNCH = 'No such file'  # in an error of ours, the file is one that the user names


class Launched(NamedTuple):
    """A run that is over. ``code``: the exit code; ``bags``: bags.Bag of each; ``crashes``: in words.

    ``fleets``: [name, why it cannot be split into several processes, or ''] of each fleet that is one process.
    ``lines``: ErrorLines. ``debugged``: the command that leads to before the fault, '' if there is none.
    """

    code: int
    bags: list = []
    crashes: list = []
    fleets: list = []
    judged: Judgement = Judgement()
    lines: list = []
    debugged: str = ''


def launch(parser, options):
    """Run the launch file in this process; return the Launched. Print what is wrong with a file that cannot be run."""
    with warm_nodes.importing():
        from roslaunch.core import RLException
        from rospkg import ResourceNotFound

        from ...loopback import LoopbackError
    series = options.series
    files = list(map(tuple, series['files'])) if series else command_line.files_of(parser, options.command)
    options.deputy = tuple(series['deputy']) if series else ()
    sys.argv[1:] = []  # otherwise roslaunch would read arguments of launch files from there
    try:
        return _run(options, files)
    except (RLException, ResourceNotFound, SimulatorError, LoopbackError) as error:
        print('lockstep_launch: {}'.format(with_next(error, files[0][0], options.adopt)), file=sys.stderr)
        return Launched(_CANNOT)
    finally:
        processes.end_all_children()


def with_next(error, path, adopts):
    """Return an error's text, with what the user can type next.

    ``path``: that of the launch file; ``adopts``: whether --adopt was given.
    """
    from rospkg import ResourceNotFound
    text = str(error)
    asked = re.search("requires the '(\\w+)' arg to be set|arg '(\\w+)' is not defined", text)
    if asked:
        names = dict.fromkeys([asked.group(1) or asked.group(2), *_wanted(path)])
        return '{}. Behind the file: {}'.format(text, ' '.join(name + ':=VALUE' for name in names))
    if path.endswith('.py'):
        return '{}. It is a launch file of ROS 2; this is ROS 1, whose launch files are XML'.format(text)
    if isinstance(error, ResourceNotFound):
        name = text.partition('\nROS path')[0].rpartition(': ')[2]
        text = 'the package {} is not found here; is its workspace sourced?'.format(name)
    elif not any(words in text for words in _OF_OTHERS) and (
            _OF_ROSLAUNCH not in text or isinstance(error, ConfigurationError)):
        return text
    stop = '' if text.endswith(('.', '?')) else '.'
    return text if adopts else (text + stop + ' If the file was written for Gazebo, Stage or real robots, --adopt '
                                'leaves out what is not here, and says what it does')


def _wanted(path):
    """Return the names of the arguments that a launch file needs, and for which it has no value."""
    root = ElementTree.parse(path).getroot()
    given = {tag.get('name') for tag in root.findall('arg') if {'value', 'default'} & set(tag.attrib)}
    asked = [tag.get('name') for tag in root.findall('arg')]
    asked += [name for tag in root.iter() for text in tag.attrib.values()
              for name in re.findall(r'\$\(arg (\w+)\)', text)]
    return [name for name in dict.fromkeys(asked) if name not in given]


def read_words(words, program='lockstep_launch'):
    """Return (parser, options) of the command line of ``program``.

    ``options.run``: the RunOptions among them; ``options.one``: the OneRun; ``options.command``: the words after them.
    """
    parser = argparse.ArgumentParser(
        prog=program, description='Run an unmodified launch file in lockstep. First steps: '
        '--list FILE says which nodes take part. --adopt --list FILE says what is done with a file for Gazebo, Stage '
        'or real robots. `verify FILE` checks that its runs are the same. `why` says, while it runs, what time waits '
        'for.', usage=command_line.USAGE,
        epilog='exit codes: 0 the run came to its end, 1 it did not, 2 the file cannot be run like this, 3 a node '
               'crashed, '
               '4 a property is broken')
    add_arguments(parser, command_line.OneRun)
    command_line.add_run(parser)
    # From `verify`: conditions that must not change the run.
    parser.add_argument('--own-hash-seed', type=int, default=None, help=argparse.SUPPRESS)
    parser.add_argument('--message-bytes', default=None, help=argparse.SUPPRESS)
    # A folder for the time master's notes `start` and `end`: for programs that look for them (tests, measurements).
    parser.add_argument('--notes', default=None, help=argparse.SUPPRESS)
    parser.add_argument('--no-displays', action='store_true', help=argparse.SUPPRESS)  # from `verify` and rostest
    parser.add_argument('--start-order', choices=('file', 'reversed'), default='file', help=argparse.SUPPRESS)
    parser.add_argument('--series', type=json.loads, help=argparse.SUPPRESS)  # from `--script`
    parser.add_argument('--parts', type=int, default=0, help=argparse.SUPPRESS)
    # From `debug`: time stops at its start, messages are kept, and the notes have the address of the ROS master.
    parser.add_argument('--debugged', action='store_true', help=argparse.SUPPRESS)
    parser.add_argument('--list', action='store_true', help='list the nodes that take part, and start nothing')
    parser.add_argument('--script', action='store_true', help='as the first word: run an unchanged script that starts '
                        'launch files, each of them in lockstep')
    options = parser.parse_intermixed_args(words)
    if options.script:
        parser.error('--script must be the first word')
    options.run, options.one = command_line.run_of(parser, options), of_arguments(command_line.OneRun, parser, options)
    return parser, options


def _run(options, files):
    """Run ``files`` [(path, arguments)], with a folder for what only this run needs; return the Launched."""
    own = temporary.make('notes_')  # no TemporaryDirectory: forks would remove that, too
    try:
        with nullcontext() if options.list else temporary.temporary_folder(say) as folder:
            return _run_in(own, folder, options, files)
    finally:
        temporary.remove(own)


def _run_in(own, folder, options, files):
    from roslaunch.core import Param, generate_run_id
    from roslaunch.rlutil import get_or_generate_uuid

    from ...launching import look_ups, plan
    look_ups.remember()
    environment = dict(os.environ)
    if not options.use_master:
        os.environ.update(ROS_IP='127.0.0.1')
        os.environ.pop('ROS_HOSTNAME', None)
        plan.name_anonymous_ones_alike()
    asked_run, options.notes = options.run, os.path.abspath(options.notes or own)
    asked = plan.launch_options(
        asked_run, _parameters_of(options), deputy=options.deputy, parts=options.parts,
        environment=((error_lines.VARIABLE, own), *((('TMPDIR', folder),) if folder else ())),
        own_environment=() if options.own_hash_seed is None else (('PYTHONHASHSEED', str(options.own_hash_seed)),),
        is_reversed=options.start_order == 'reversed',
        **({} if options.no_displays else {'no_displays': _why_no_displays()}))
    config = plan.read(files, asked_run.tolerant or asked_run.adopt)
    if asked_run.adopt:
        asked = _adopted(config, asked, options)
    made = plan.plan_of(config, asked)
    for line in _lines(made._replace(left_out=[]) if options.adopt else made):
        say(line)
    if options.list:
        say('next: this run: ' + _typed(options))
        return Launched(0)
    run_id = get_or_generate_uuid(None, False) if options.use_master else generate_run_id()
    config.params['/run_id'] = Param('/run_id', run_id)
    is_asked = bool(made.event_log)
    log = plan.log_of_run(made, own, options.check or asked_run.properties)
    if is_asked and not options.series:
        run_file.write(log, _start_of(options, files, made, environment))
    code, found = _carry_out(made, log, own, run_id, options)
    launched = Launched(code, _bags(own, log), lines=error_lines.noted(own))
    return _conclude(made, launched, ends.judge(found, ends.read_log(log)), log, options)


def words_again(options):
    """Return the words of a command line that start the same run, with another event log, or none."""
    words = [word for flag, value in (('--own-hash-seed', options.own_hash_seed), ('--parts', options.parts or None),
                                      ('--start-order', None if options.start_order == 'file' else 'reversed'))
             if value is not None for word in (flag, str(value))]
    words += ['--no-displays'] if options.no_displays else []
    return words + words_of(dataclasses.replace(options.one, event_log='')) + words_of(options.run) + options.command


def _start_of(options, files, made, environment):
    """Return the Start of a run of ``files``; ``environment``: that of this command."""
    from ...launching import plan
    return run_file.of_run(words_again(options), os.getcwd(), environment, [
        *(path for path, _ in files), *made.config.roslaunch_files, *plan.programs_of(made)])


def _why_no_displays():
    has_screen = any(os.environ.get(name) for name in ('DISPLAY', 'WAYLAND_DISPLAY'))
    return '' if has_screen else 'there is no screen here (DISPLAY is not set)'


def _parameters_of(options):
    """Return the time master's parameters."""
    given = (*(PARAMETERS.items() if options.debugged else ()),
             ('event_log', options.event_log and os.path.abspath(options.event_log)),
             ('message_bytes', options.message_bytes), ('end_when_idle', options.check),
             *((f'note_of_{one}', os.path.join(options.notes, one)) for one in ('start', 'end')))
    return {**network.resolve(parameters_of(options.run)), **parameters_of(options.one),
            **{key: value for key, value in given if value}}


def _carry_out(made, log, own, run_id, options):
    """Run a Plan to its end; return (exit code, ends.Processes). ``own``: the run's own folder."""
    import rosgraph
    import rospkg

    from ...launching import outputs, plan, run
    from ...loopback import find_executable
    is_warm = not warm_nodes.wants_start(os.environ)  # not if `verify` asks for other addresses
    if is_warm:
        warm_nodes.be_ready(plan.scripts_of(made), os.path.dirname(find_executable('lockstep')))
    this = run.Run(made, log, outputs.Screen(os.path.join(rospkg.get_log_dir(), run_id)), run.Patience(2.0, 15.0), own,
                   os.path.join(options.notes, 'start'), is_warm, is_quick=False)
    asked = []
    for each in guard.signals():
        signal.signal(each, lambda number, _frame: (asked.append(number), this.stop()))
    this.start(rosgraph.get_master_uri() if options.use_master else '')
    if options.debugged:
        with whole_file(os.path.join(options.notes, MASTER_NOTE)) as stream:
            stream.write(this.uri)
    problem = this.wait()
    is_bad = problem is not None and problem.kind != run.REQUIRED
    if is_bad:
        _complain(problem, this.printed(problem.name) if problem.code else (), problem.kind == run.ABSENT)
    found = this.end(run.Patience(1.0, 1.0) if guard.has_lost() else None)
    if asked:
        say(guard.why(asked[0]))
    return _BAD if is_bad or this.has_failed else _GOOD, found


def _complain(problem, printed, is_absent):
    """Print why the run does not come to its end: if a participant is absent, with its last lines, or what to do."""
    print('lockstep_launch: {}'.format('{} ended ({}) before it took part, so that time never starts.{}'.format(
        problem.name, ends.described(problem.code), ' It said last:' if problem.code else
        ' If it is a node that does not go on running, make it an onlooker: --onlooker {}'.format(problem.name))
        if is_absent else problem.text), file=sys.stderr)
    for line in printed:
        print('    ' + line, file=sys.stderr)


def _adopted(config, asked, options):
    """Print what --adopt does with the file, and return the options that do it.

    :raises ConfigurationError: if something in the file cannot work.
    """
    from move_base_abstract.config.settings import read_settings

    from ...launching import adoption
    found = adoption.adopt(config, asked, read_settings)
    for line in found.done:
        say(printable(line))
    for line in found.remarks:
        say('note: ' + printable(line))
    if found.unread:
        say('\n    '.join(['note: of this file these parameters have no effect:', *map(printable, found.unread)]))
    say('the same by options: ' + _typed(options, found.options))
    if found.problems:
        raise ConfigurationError('\nlockstep_launch: '.join('cannot work: ' + printable(line)
                                                            for line in found.problems))
    return found.options


def _typed(options, run=None):
    """Return this command line as a command, with its own RunOptions or ``run``."""
    return command_line.typed('lockstep_launch', options.one, run or options.run, options.command)


def _conclude(made, launched, found, log, options):
    """Report crashes and broken properties; return the Launched. ``found``: how nodes ended; ``log``: the event log."""
    crashed = [end for end in found if end.crash is not None]
    names = ('all',) if options.check else options.run.properties
    judged = judgement_on(Run(log, found, names)) if names else Judgement()
    for end in crashed:
        print('lockstep_launch: crash: ' + shown_text(end.words), file=sys.stderr)
        for line in end.last_lines:
            print('    ' + shown_text(line), file=sys.stderr)
    for one in launched.lines:
        print('lockstep_launch: ' + shown_text(one.words), file=sys.stderr)
    for one in judged.broken:
        print('lockstep_launch: broken: ' + shown_text(one.words()), file=sys.stderr)
    for node, text in judged.never_held() if names else ():
        print('lockstep_launch: never held in this run: sometimes: {}: {}'.format(*map(shown_text, (node, text))))
    sys.stdout.flush()
    sys.stderr.flush()
    code = launched.code
    code = _BROKEN if judged.broken else _CRASHED if crashed and options.run.crashes == FAIL and not code else code
    faults = [*(one.instant_ns for one in judged.broken), *(end.time_ns for end in crashed)]
    debugged = _debugged(options, faults) if code in (_BROKEN, _CRASHED) else ''
    if debugged:
        say('next: before that, in the debugger: ' + debugged)
    return launched._replace(code=code, crashes=[shown_text(end.words) for end in crashed], fleets=_fleets(made),
                             judged=judged, debugged=debugged)


def _debugged(options, faults):
    """Return the command that leads to before the first of the faults [ns], or '' if no such run can be debugged."""
    if options.debugged or options.series or options.use_master:
        return ''
    path = options.one.event_log
    return debug_command.of_log(path, faults) if path else debug_command.of_run(words_again(options), faults)


def _fleets(made):
    """Return [name, why] for each fleet that is one process; why it cannot be split into several, '' if it can."""
    from ...fleet.fleet_scenario import why_one_process
    params = {key: param.value for key, param in made.config.params.items()}
    return [[shown_text(name), shown_text(why_one_process(params, name))] for name in made.fleets]


def _bags(own, log):
    """Return the bags of the run; print them, and write them into the event log."""
    from ...launching import bags
    found = bags.written(os.path.join(own, bags.NOTES))
    for line in bags.lines(found):
        say(line)
    bags.add_to_log(log, found)
    return found


def say(line):
    """Print a line under the name of the program."""
    print('lockstep_launch: {}'.format(line), flush=True)


def _lines(made):
    taking = [role for role in made.roles if role.takes_part]
    yield '{} of {} nodes take part: {}'.format(
        len(taking), len(made.roles), ', '.join(shown_text(role.name) for role in taking))
    for role in made.roles:
        if not role.takes_part:
            yield '{} looks on: {}'.format(shown_text(role.name), shown_text(role.why))
    for name in made.left_out:
        yield '{} is not started'.format(shown_text(name))
    if made.fleets:
        yield 'fleets: {}'.format(', '.join(shown_text(name) for name in made.fleets))
    for note in made.notes:
        yield printable(note)
