"""Plan the run of a launch file in lockstep: roslaunch's configuration of it, with our launcher and a time master."""
import os
import shlex
from dataclasses import dataclass, field
from typing import NamedTuple

import rosgraph
import roslaunch.config
import roslaunch.core
import rospkg
from roslaunch import substitution_args
from roslaunch.loader import convert_value

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import list_of, string, text
from move_base_abstract.common.options import options_of
from move_base_abstract.common.shown import shown
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract.runs import event_log
from move_base_abstract.runs.ends import TIME_MASTER

from ..adopting.reading import PlacingLoader, Tolerant
from ..lockstep.code import older
from ..lockstep.participation import report_delays
from ..lockstep.programs import binary, recorders
from ..loopback import PACKAGE, find_executable
from . import given, look_ups, programs, roles, start_poses, started

_LATE_TURNS, _LONGEST_STEP_MS, _LATEST_MS = 20, 20, 250  # for a run whose nodes start in another order; wall time
_TEXTS = list_of(text(), 'a list of texts')


@dataclass(frozen=True)
class LaunchOptions(RunOptions):
    """The options of a run, and what its starter adds; :func:`launch_options` makes them.

    ``parameters``: of the time master; they take precedence over the launch file's.
    """

    parameters: dict = field(default_factory=dict)
    environment: tuple = ()  # (name, value) for each node that takes part; the launch file's take precedence
    own_environment: tuple = ()  # (name, value) for this package's own nodes
    is_reversed: bool = False  # whether nodes start one after another, the last of the launch file first
    parts: int = 0  # number of processes into which a fleet is split; 0: as the file says
    deputy: tuple = ()  # (name, address) of the node that takes part for a script, with which the run ends
    is_told: bool = False  # whether the user has been told what is added and where robots start
    no_displays: str = 'experiments, verify, chaos and tests start none'  # why; '': RViz and the like are started

    @property
    def kept(self):
        """The names of the nodes of which the user says whether they take part."""
        return (*self.participant, *self.onlooker)


def launch_options(run, parameters=None, **others):
    """Return RunOptions as LaunchOptions. ``parameters``: of the time master; ``others``: other fields."""
    fields = {one.field: getattr(run, one.field) for one in options_of(RunOptions).values()}
    return LaunchOptions(**{**fields, **others}, parameters=parameters or {})


class Plan(NamedTuple):
    """A configuration to be launched.

    ``roles``: a Role of each node; ``left_out``: the names of nodes that are not started; ``notes``: lines about all
    other changes, for the user.
    """

    config: object
    roles: list
    left_out: list
    notes: list
    fleets: list  # names of fleets that are one process, and could be split
    is_reversed: bool = False  # nodes start one after another

    @property
    def event_log(self):
        """Path of the run's event log; '' if there is none."""
        return _value(self.config, TIME_MASTER + '/event_log', '')

    @property
    def participants(self):
        """Names of the participants."""
        return [role.name for role in self.roles if role.takes_part]


def make_plan(files, options):
    """Read launch files and plan their run. ``files``: as roslaunch takes them, [path or (path, arguments)].

    :raises ConfigurationError: if the files cannot be run like this.
    :raises roslaunch.core.RLException: if roslaunch cannot read them.
    """
    return plan_of(read(files, options.tolerant), options)


def read(files, is_tolerant=False):
    """Return roslaunch's configuration of launch files.

    is_tolerant: leave out what the files name and is not here. The configuration's ``missing`` lists it.

    :raises roslaunch.core.RLException: if roslaunch cannot read them.
    """
    if is_tolerant:
        look_ups.tolerate()
    loader = _TolerantLoader() if is_tolerant else _Loader()
    config = roslaunch.config.load_config_default(files, None, loader=loader, verbose=False)
    if is_tolerant and config.taken:
        look_ups.packages.cache_clear()
    return config


class _Loader(PlacingLoader):
    """A loader that knows what `rosversion` prints for the file of ROS's core, and does not run it."""

    def param_value(self, verbose, name, ptype, value, textfile, binfile, command):
        """Return the value of a parameter, as roslaunch's loader does."""
        known = _answer(command) if value is None and textfile is None and binfile is None else ''
        if known:
            return convert_value(known + '\n', ptype)
        return super().param_value(verbose, name, ptype, value, textfile, binfile, command)


class _TolerantLoader(Tolerant, _Loader):
    """The same loader for launch files of others, which may name packages and files that are not here."""


def _answer(command):
    """Return what a command of the file of ROS's core prints, or '' if that is not known."""
    if command == 'rosversion -d':
        return os.environ.get('ROS_DISTRO', '')
    if command == 'rosversion roslaunch':
        try:
            return look_ups.packages().get_manifest('roslaunch').version or ''
        except (rospkg.ResourceNotFound, rospkg.InvalidManifest):
            return ''
    return ''


def plan_of(config, options):
    """Change a roslaunch configuration into that of a run in lockstep, and return it as a Plan.

    :raises ConfigurationError: if it cannot be run like this.
    """
    if options.deputy:
        _add_deputy(config, *options.deputy)
    said = start_poses.said_by(config)
    given.add_to(config, options)
    notes = [] if options.is_told else given.told(options)
    left_out, more = started.take_away(config, options)
    notes += more
    _refuse_other_clocks(config, options.kept)
    started.refuse_missing(config, options, more)
    fleets = _fleets(config)
    notes += _split(config, fleets, options.parts)
    notes += start_poses.notes_of(config, said, not options.is_told)
    launcher = [find_executable('lockstep'), '--sleep', options.sleep, '--seed', str(options.seed)]
    found = []
    for node in _others(config):
        role = roles.role_of(node, options.participant, options.onlooker, options.no_respawn)
        found.append(role)
        _prepare(node, role, launcher, options)
        notes += [*filter(None, [roles.choice_of_program(node)]), *_look_at_recorder(config, node, role)]
    if not any(role.takes_part for role in found) and not _named(config):
        raise ConfigurationError('no node of this launch file can take part in lockstep: {}'.format(
            '; '.join(['{}: {}'.format(role.name, role.why) for role in found] + more) or 'there is none'))
    _keep_local([*config.nodes_core, *(node for node, role in zip(_others(config), found) if not role.takes_part)])
    notes += _add_time_master(config, found, options)
    if options.is_reversed:
        _reverse(config, [role.name for role in found if role.takes_part])
    return Plan(config, found, left_out, notes, [roles.name_of(node) for node in fleets], options.is_reversed)


def scripts_of(plan):
    """Return the paths of the participants' Python programs, sorted."""
    scripts = {role.name for role in plan.roles if role.kind in ('rospy', 'itself')}
    found = {roles.program_of(node) for node in plan.config.nodes if roles.name_of(node) in scripts}
    return sorted(found - {None})


def programs_of(plan):
    """Return the paths of all programs that are found, sorted."""
    return sorted({roles.program_of(node) for node in plan.config.nodes} - {None})


def log_of_run(plan, folder, is_whole=False):
    """Return the path of the event log of a Plan's run.

    If the user wants none, it is in ``folder``, and has only the ends of nodes, or all events if ``is_whole``.
    """
    asked = _given(plan.config, 'event_log', string('the path of a file, or nothing'), '')
    if asked:
        return os.path.join(rospkg.get_ros_home(), asked)
    path = os.path.join(folder, 'ends.jsonl')
    given.put(plan.config, TIME_MASTER + '/event_log', path)
    given.put(plan.config, TIME_MASTER + '/event_log_of_ends', not is_whole)
    return path


def keep_to_this_user(plan, folder):
    """Give a Plan's run a secret that only this user can read, in ``folder``, unless its launch file gives one."""
    keys = [TIME_MASTER + '/lockstep_secret', TIME_MASTER + '/lockstep_secret_file']
    if any(_value(plan.config, key, '') for key in keys):
        return
    path = os.path.join(folder, 'secret')
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600), 'w') as stream:
        stream.write(os.urandom(24).hex())
    given.put(plan.config, keys[1], path)


def name_anonymous_ones_alike():
    """Make $(anon NAME) give the same names in each run. On a ROS master of its own the run needs no others."""
    counts = {}

    def anonymous_name(name):
        counts[name] = counts.get(name, 0) + 1
        return '{}_anonymous_{}'.format(name, counts[name])

    # roslaunch looks the function up in this module, and nothing else in this process uses it.
    substitution_args.rosgraph.names.anonymous_name = anonymous_name


def _refuse_other_clocks(config, kept):
    for node in config.nodes:
        if roles.has_clock(node, kept):
            name = roles.name_of(node)
            raise ConfigurationError(
                "'{}' ({}/{}) publishes /clock itself, as a simulator does; in lockstep only the time master may: "
                'leave it out (--leave-out {}), with the nodes that only it needs; if it is a script that only could '
                'publish /clock, --participant {} or --onlooker {} keeps it'.format(
                    name, node.package, node.type, name, name, name))


def _prepare(node, role, launcher, options):
    if role.takes_part:
        node.env_args = [*options.environment, *node.env_args]
        if role.kind == 'itself':
            node.env_args = [*node.env_args, *options.own_environment]
        else:
            node.launch_prefix = roles.prefix_of(node, launcher)
            if node.package in options.python2 and not programs.wants_python3(roles.program_of(node)):
                folders = [look_ups.packages().get_path(name) for name in options.python2]
                node.env_args = [(older.VARIABLE, os.pathsep.join(folders)), *node.env_args]
            node.respawn = False


def _others(config):
    return [node for node in config.nodes if not roles.is_time_master(node)]


def _keep_local(nodes):
    """Make roscpp programs that take no part, such as rosout, do so, and listen on 127.0.0.1 if ROS_IP is that."""
    try:
        name, value = binary.loopback_only(os.environ)
    except ValueError as error:
        raise ConfigurationError(str(error)) from None
    for node in nodes:
        if name not in dict(node.env_args):
            node.env_args = [*node.env_args, (name, value)]
        node.env_args = [*node.env_args, binary.LOOKS_ON]


def _look_at_recorder(config, node, role):
    """Label the run if the bag of a recorder is not covered. Return lines about it for the user."""
    why, notes = '' if role.takes_part else 'it looks on: {}'.format(role.why), []
    if role.takes_part and recorders.is_recorder(node):
        left_out, named = recorders.past_lockstep(shlex.split(node.args or ''), node.namespace,
                                                  _given(config, 'excluded_topics'))
        why = 'it records {}, which goes past lockstep'.format(', '.join(named)) if named else ''
        notes += ['{} records no {}: they go past lockstep'.format(role.name, ', '.join(left_out))] if left_out else []
    if role.records and why:
        label = event_log.uncovered_bag(role.name, why)
        _label(config, [label])
        notes.append(label)
    return notes


def _label(config, reasons):
    if reasons:
        given.put(config, TIME_MASTER + '/not_covered', [*_given(config, 'not_covered'), *reasons])


def _fleets(config):
    return [node for node in config.nodes if (node.package, node.type) == (PACKAGE, 'fleet')
            and _value(config, roles.name_of(node) + '/parts', 1) == 1]


def _split(config, fleets, parts):
    """Split each of ``fleets`` into ``parts`` processes. Return lines about it for the user."""
    notes = []
    for node in fleets if parts > 1 else ():
        name = roles.name_of(node)
        config.nodes.remove(node)
        below = {key: param.value for key, param in config.params.items() if key.startswith(name + '/')}
        for part in range(parts):
            twin = _copy(node, '{}_part_{}'.format(node.name, part))
            config.nodes.append(twin)
            for key, value in dict(below, **{name + '/part': part, name + '/parts': parts}).items():
                own = roles.name_of(twin) + key[len(name):]
                config.params[own] = roslaunch.core.Param(own, value)
        notes.append('{} in {} processes'.format(name, parts))
    return notes


def _add_deputy(config, name, address):
    node = roslaunch.core.Node(PACKAGE, 'lockstep', name=name,
                               args='--own {} {}'.format(roles.DEPUTY, shlex.quote(address)),
                               output='screen', required=True)
    node.machine = config.machines['']
    if roles.name_of(node) in [roles.name_of(one) for one in config.nodes]:
        raise ConfigurationError("the launch file has a node '{}', which is the script's name".format(
            roles.name_of(node)))
    config.nodes.append(node)


def _copy(node, name):
    twin = roslaunch.core.Node(
        node.package, node.type, name=name, namespace=node.namespace, machine_name=node.machine_name, args=node.args,
        respawn=node.respawn, respawn_delay=node.respawn_delay, remap_args=node.remap_args, env_args=node.env_args,
        output=node.output, cwd=node.cwd, launch_prefix=node.launch_prefix, required=node.required,
        filename=node.filename)
    twin.machine = node.machine
    return twin


def _add_time_master(config, found, options):
    """Make the configuration have one time master, in lockstep, that waits for all participants.

    Return lines for the user about the changes.
    """
    notes = []
    own = [node for node in config.nodes if roles.is_time_master(node)]
    for node in own:
        if node.type == roles.ORIGINAL_TIME_MASTER:
            node.type, node.name, node.namespace = 'time_master', 'time_master', '/'
    if own and roles.name_of(own[0]) != TIME_MASTER:
        raise ConfigurationError("the time master must be '{}', got '{}'".format(TIME_MASTER, roles.name_of(own[0])))
    if not own:
        node = roslaunch.core.Node(PACKAGE, 'time_master', name='time_master', output='screen')
        node.machine = config.machines['']
        config.nodes.insert(0, node)
    named = _named(config)
    taking = [role.name for role in found if role.takes_part]
    required = [roles.name_of(node) for node in config.nodes if node.required and roles.name_of(node) in taking]
    for key, value in (('/use_sim_time', True), (TIME_MASTER + '/mode', 'lockstep'),
                       (TIME_MASTER + '/end_with', required),
                       (TIME_MASTER + '/onlookers', [role.name for role in found if role.may_provide])):
        said = _value(config, key, value)
        if said not in (value, []):
            notes.append('{} is {}, not {}'.format(key, shown(value), shown(said)))
        given.put(config, key, value)
    for key, value in dict({'participants': taking + [name for name in named if name not in taking]},
                           **options.parameters).items():
        given.put(config, '{}/{}'.format(TIME_MASTER, key), value)
    return notes


def _reverse(config, taking):
    """Make nodes start in the reverse order, and register with the ROS master in that order at one instant, too."""
    config.nodes.reverse()
    config.nodes.sort(key=lambda node: not roles.is_time_master(node))
    started = [node for node in config.nodes if roles.name_of(node) in taking]
    step = min(_LONGEST_STEP_MS, _LATEST_MS // max(1, len(started)))
    for number, node in enumerate(started):
        node.env_args = [*node.env_args, (report_delays.FIRST_VARIABLE, '{}:{}'.format(_LATE_TURNS, number * step))]


def _named(config):
    """Return the full names of the participants that the launch file names. Something else may start them."""
    return [rosgraph.names.ns_join('/', name) for name in _given(config, 'participants')]


def _given(config, name, kind=_TEXTS, default=()):
    """Return a parameter of the time master that the launch file gives and that is read here, as ``kind`` has it."""
    key = '{}/{}'.format(TIME_MASTER, name)
    return kind.check(key, _value(config, key, default))


def _value(config, key, default):
    param = config.params.get(key)
    below = {name[len(key) + 1:]: one.value for name, one in config.params.items() if name.startswith(key + '/')}
    return below or (default if param is None else param.value)  # roslaunch has a row for each key of a mapping
