"""Run an unchanged launch file in lockstep: with the launcher before each rospy and roscpp node, and a time master.

    rosrun move_base_abstract lockstep_launch [options] FILE [ARG:=VALUE ...]
    rosrun move_base_abstract lockstep_launch [options] PACKAGE FILE [ARG:=VALUE ...]

The first lines name the nodes that cannot take part and look on. The run has a ROS master of its own on 127.0.0.1,
unless --use-master is given.

Exit codes: 0 the run came to its end, or was ended by a signal; 1 it did not come to its end; 2 the file cannot be run
like this; 3 the run came to its end, but a node crashed; 4 a property is broken (--check, --property).
"""
import argparse
import atexit
import json
import os
import sys
from contextlib import contextmanager, nullcontext

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.json_files import load_json_mapping
from move_base_abstract.common.lasting_output import outlive_readers
from move_base_abstract.common.options import add_arguments, of_arguments, parameters_of
from move_base_abstract.common.shown import shown_text
from move_base_abstract.common.temporary_folder import temporary_folder
from move_base_abstract.lockstep.run_options import FAIL
from move_base_abstract.properties import Judgement, Run, judgement_on
from move_base_abstract.radio import network

from ..adopting import next_step
from ..launching import command_line, light_imports, warm_client
from ..launching.scripted import rostest_case
from ..process.process_end import leave

_CANNOT, _CRASHED, _BROKEN = 2, 3, 4


def main(words=None):
    """Run the launch file and exit with the code."""
    outlive_readers()
    words = sys.argv[1:] if words is None else words
    if rostest_case.is_asked(words):
        rostest_case.run(words)
    parser, options = read_words(words)
    warm = None if options.list else warm_client.WarmClient(
        os.path.dirname(os.path.abspath(sys.argv[0])), not options.use_master)
    # Only now, while the warm process works beside this one: these imports take a while.
    with light_imports.light():
        from ..launching import runner  # noqa: F401 - it imports all other modules that are needed
        from ..loopback import LoopbackError
    from roslaunch.core import RLException
    from rospkg import ResourceNotFound
    series = options.series and load_json_mapping(options.series)
    files = list(map(tuple, series['files'])) if series else command_line.files_of(parser, options.command)
    options.deputy = (series['deputy'], series['address']) if series else ()
    sys.argv[1:] = []  # otherwise roslaunch would read arguments of launch files from there
    try:
        with _ros_master(options.use_master, warm):
            code = _run(options, files, warm)
    except (RLException, ResourceNotFound, SimulatorError, LoopbackError) as error:
        print('lockstep_launch: {}'.format(next_step.with_next(error, files[0][0], options.adopt)), file=sys.stderr)
        code = _CANNOT
    _end_as_python(warm)
    leave(code)  # Python's own end, with all its destructors, would take a while


def _end_as_python(warm):
    if warm is not None:
        warm.close()
    core = sys.modules.get('rospy.core')
    if core is not None and not core.is_initialized():
        atexit.unregister(core._ros_atexit)  # this process is not a node, so that it has no use; it would take 0.1 s
    atexit._run_exitfuncs()


def read_words(words):
    """Return (parser, options) of a command line.

    ``options.run``: the RunOptions among them; ``options.one``: the OneRun; ``options.command``: the words after them.
    """
    parser = argparse.ArgumentParser(
        prog='lockstep_launch', description='Run an unmodified launch file in lockstep. First steps: '
        '--list FILE says which nodes take part. --adopt --list FILE says what is done with a file for Gazebo, Stage '
        'or real robots. `verify FILE` checks that its runs are the same. `why` says, while it runs, what time waits '
        'for.', usage=command_line.USAGE,
        epilog='exit codes: 0 the run came to its end, 1 it did not, 2 the file cannot be run like this, 3 a node '
               'crashed, '
               '4 a property is broken')
    add_arguments(parser, command_line.OneRun)
    command_line.add_run(parser)
    # From `verify`: a file for the outcome, which programs read, and conditions that must not change the run.
    parser.add_argument('--outcome', default=None, help=argparse.SUPPRESS)
    parser.add_argument('--own-hash-seed', type=int, default=None, help=argparse.SUPPRESS)
    parser.add_argument('--message-bytes', default=None, help=argparse.SUPPRESS)
    # A folder for the time master's notes `start` and `end`: for programs that look for them (tests, measurements).
    parser.add_argument('--notes', default=None, help=argparse.SUPPRESS)
    parser.add_argument('--start-order', choices=('file', 'reversed'), default='file', help=argparse.SUPPRESS)
    parser.add_argument('--series', default=None, help=argparse.SUPPRESS)  # from `lockstep_series`
    parser.add_argument('--parts', type=int, default=0, help=argparse.SUPPRESS)
    parser.add_argument('--list', action='store_true', help='list the nodes that take part, and start nothing')
    options = parser.parse_args(words)
    options.run, options.one = command_line.run_of(options), of_arguments(command_line.OneRun, options)
    return parser, options


def _run(options, files, warm):
    from roslaunch import configure_logging, rlutil

    from ..launching import bags, look_ups, plan, runner
    look_ups.remember()
    if not options.use_master:
        plan.name_anonymous_ones_alike()
    run = options.run
    parameters = {**network.resolve(parameters_of(run)), **parameters_of(options.one), **{key: value for key, value in (
        ('event_log', options.event_log and os.path.abspath(options.event_log)),
        ('message_bytes', options.message_bytes), ('end_when_idle', options.check),
        *((f'note_of_{one}', options.notes and os.path.join(os.path.abspath(options.notes), one))
          for one in ('start', 'end'))) if value}}
    seed = () if options.own_hash_seed is None else (('PYTHONHASHSEED', str(options.own_hash_seed)),)
    with nullcontext() if options.list else temporary_folder(_say) as folder, bags.notes() as notes:
        environment = ((bags.VARIABLE, notes), *((('TMPDIR', folder),) if folder else ()))
        asked = plan.launch_options(
            run, parameters, environment=environment, own_environment=seed, deputy=options.deputy,
            is_reversed=options.start_order == 'reversed', parts=options.parts)
        config = plan.read(files, run.tolerant or run.adopt)
        if run.adopt:
            asked = _adopted(config, asked, options)
        made = plan.plan_of(config, asked)
        for line in _lines(made._replace(left_out=[]) if options.adopt else made):
            _say(line)
        if options.list:
            _say('next: this run: ' + _typed(options))
            return 0
        if warm is not None:
            warm.prepare(plan.scripts_of(made))
        run_id = rlutil.get_or_generate_uuid(None, False)
        configure_logging(run_id)
        with plan.log_of_run(made, options.check or run.properties) as log:
            parent = runner.Parent(run_id, made, log, warm, show_summary=False)
            parent.start()
            parent.spin()
            return _conclude(parent, made, bags.written(notes), log, options)


def _adopted(config, asked, options):
    """Print what --adopt does with the file, and return the options that do it.

    :raises ConfigurationError: if something in the file cannot work.
    """
    from move_base_abstract.config.settings import read_settings

    from ..launching import adoption
    found = adoption.adopt(config, asked, read_settings)
    for line in found.done:
        _say(_printable(line))
    for line in found.remarks:
        _say('note: ' + _printable(line))
    _say('the same by options: ' + _typed(options, found.options))
    if found.problems:
        raise ConfigurationError('\nlockstep_launch: '.join('cannot work: ' + _printable(line)
                                                            for line in found.problems))
    return found.options


def _typed(options, run=None):
    """Return this command line as a command, with its own RunOptions or ``run``."""
    return command_line.typed('lockstep_launch', options.one, run or options.run, options.command)


def _printable(line):
    return ''.join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in line)


def _conclude(parent, made, found, log, options):
    """Report bags, crashes and broken properties; return the exit code. ``found``: the bags; ``log``: the event log."""
    _tell_bags(made, found)
    ends = parent.ends()
    crashed = [end for end in ends if end.crash is not None]
    names = ('all',) if options.check else options.run.properties
    judged = judgement_on(Run(log, ends, names)) if names else Judgement()
    if options.outcome:
        with open(options.outcome, 'x', encoding='utf-8') as stream:
            json.dump({'bags': [[bag.node, bag.path] for bag in found], 'fleets': _fleets(made),
                       'crashes': [shown_text(end.words) for end in crashed], 'properties': judged.told()}, stream)
    for end in crashed:
        print('lockstep_launch: crash: ' + shown_text(end.words), file=sys.stderr)
        for line in end.last_lines:
            print('    ' + shown_text(line), file=sys.stderr)
    for one in judged.broken:
        print('lockstep_launch: broken: ' + shown_text(one.words()), file=sys.stderr)
    for node, text in judged.never_held() if names else ():
        print('lockstep_launch: never held in this run: sometimes: {}: {}'.format(*map(shown_text, (node, text))))
    sys.stdout.flush()
    sys.stderr.flush()
    if judged.broken:
        return _BROKEN
    if crashed and options.run.crashes == FAIL and not parent.code:
        return _CRASHED
    if not (parent.code or options.outcome or options.deputy):
        _say('next: whether its runs are the same: ' + command_line.typed('verify', options.run, options.command))
    return parent.code


def _fleets(made):
    """Return [name, why] for each fleet that is one process; why it cannot be split into several, '' if it can."""
    from ..fleet.fleet_scenario import why_one_process
    params = {key: param.value for key, param in made.config.params.items()}
    return [[shown_text(name), shown_text(why_one_process(params, name))] for name in made.fleets]


def _tell_bags(made, found):
    """Print the bags of the run, and write them into the event log."""
    from ..launching import bags
    for line in bags.lines(found):
        _say(line)
    bags.add_to_log(made.event_log, found)


def _say(line):
    print('lockstep_launch: {}'.format(line), flush=True)


def _lines(made):
    taking = [role for role in made.roles if role.takes_part]
    yield '{} of {} nodes take part: {}'.format(
        len(taking), len(made.roles), ', '.join(shown_text(role.name) for role in taking))
    for role in made.roles:
        if not role.takes_part:
            yield '{} looks on: {}'.format(shown_text(role.name), shown_text(role.why))
    if any(role.why.startswith('there is no program') for role in made.roles if not role.takes_part):
        yield 'if a program is not here: --leave-out NODE; if the file was written for Gazebo, Stage or real ' \
              'robots, --adopt --list says what else it needs'
    for name in made.left_out:
        yield '{} is not started'.format(shown_text(name))
    if made.fleets:
        yield 'fleets: {}'.format(', '.join(shown_text(name) for name in made.fleets))
    for note in made.notes:
        yield _printable(note)


@contextmanager
def _ros_master(is_given, warm):
    """Make this process, and all that it starts, use a ROS master of its own on 127.0.0.1, unless one is given."""
    if is_given:
        yield
        return
    from ..launching.warm_master import WarmMaster
    with WarmMaster(warm) as ros:
        os.environ.update(ROS_MASTER_URI=ros.uri, ROS_IP='127.0.0.1')
        os.environ.pop('ROS_HOSTNAME', None)
        yield
