"""The options of a run: the same, with the same words, for all that start runs.

They are read by lockstep_launch, verify, chaos, experiments' files and commands, and the
pytest plugin. To add an option, add a field here. Then all of them have it, the time master gets its ``parameter``, and
the schema and the tables of the docs have the text that it ``says``.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Dict, Tuple, Union

from ..common.bounded_yaml import REQUEST, load_yaml_text, yaml_line
from ..common.errors import ConfigurationError
from ..common.kinds import (
    COORDINATE,
    FLAG,
    Kind,
    as_number,
    error,
    list_of,
    map_of,
    number,
    one_of,
    pattern,
    short,
    text,
)
from ..common.options import option
from ..common.shown import shown
from ..runs import built_in

OF_NODES = ('launch', 'command')  # the systems of an experiment that have nodes
_OF_FILES = ('launch',)
FAIL, ALLOW = 'fail', 'allow'  # a crash makes the run fail, or it is only reported
LAST_INSTANT_S = 2147483647.0  # simulated
LARGEST_CHAOS_SEED = 2**31 - 1  # a parameter of ROS is no larger
_LARGEST_SEED = 10**18 - 1
_DEEPEST = 8  # lists and mappings in the value of a parameter
NAMES = '/?[A-Za-z][A-Za-z0-9_/]{0,255}'  # of nodes, topics and parameters


def _absolute(name: str) -> str:
    return '/' + name.strip('/')


NODE = pattern(NAMES, 'names of nodes, such as /coordinator', _absolute)
PROGRAM = pattern('[A-Za-z][A-Za-z0-9_.-]*/[A-Za-z0-9_.-]+', 'PACKAGE/TYPE, such as move_base/move_base')


_TOPIC = '/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*'
#: a topic that nodes, or one node, only store; the value has resolved names, so one without a slash is below the root
STORED_TOPIC = pattern(f'{_TOPIC}(={_TOPIC})?', 'TOPIC or NODE=TOPIC, such as /positions or /robot_1/agent=/map',
                       lambda entry: '='.join('/' + part.lstrip('/') for part in entry.split('=')))


_YAW = number()


def _pose(where: str, value: Any) -> Tuple[float, float, float]:
    parts = value.split(',') if isinstance(value, str) else value
    try:
        x, y, yaw = (as_number(part) if isinstance(part, str) else part for part in parts)
        return COORDINATE(x), COORDINATE(y), _YAW(yaw)
    except (TypeError, ValueError, OverflowError):
        pass
    raise error(where, value, 'X,Y,YAW [m, m, rad], such as 5,0,1.57')


POSE = Kind(_pose, {'anyOf': [{'type': 'string'}, {'type': 'array', 'items': {'type': ['number', 'string']},
                                                   'minItems': 3, 'maxItems': 3}]},
            to_word=lambda pose: ','.join(map(short, pose)))


def _ros_value(where: str, value: Any, depth: int = 0) -> Any:
    """Return a value that a parameter of ROS may have."""
    if depth < _DEEPEST and isinstance(value, (list, tuple)):
        return [_ros_value(where, one, depth + 1) for one in value]
    if depth < _DEEPEST and isinstance(value, dict) and all(isinstance(key, str) and key for key in value):
        return {key: _ros_value(f'{where}/{key}', one, depth + 1) for key, one in value.items()}
    if isinstance(value, (bool, str)) or isinstance(value, float) and math.isfinite(value) or (
            isinstance(value, int) and -1 << 31 <= value < 1 << 31):
        return value
    raise error(where, value, 'a text, a number (whole ones of 32 bits), true, false, or lists and mappings of these')


def _of_yaml(word: str) -> Any:
    found = load_yaml_text(word, shown(word), REQUEST)
    return '' if found is None and not word.strip() else found


ROS_VALUE = Kind(_ros_value, {'type': ['string', 'number', 'boolean', 'array', 'object']}, _of_yaml, yaml_line)


#: {full name: value} of parameters
PARAMETERS = map_of(ROS_VALUE, pattern(NAMES, 'the full name of a parameter, such as /robot_0/max_speed', _absolute))


def _added(where: str, value: Any) -> str:
    kind, _, arguments = value.partition(' ') if isinstance(value, str) else ('', '', '')
    if kind.count('/') != 1 or not all(kind.split('/')) or not value.isprintable():
        raise error(where, value, 'PACKAGE/TYPE [ARGUMENTS]')
    return f'{kind} {arguments.strip()}'.rstrip()


ADDED = Kind(_added, {'type': 'string'})
#: `auto` is an old word, which commands for the user do not have
_CORES = replace(one_of('one', 'all', 'auto'), to_word=lambda word: 'one' if word == 'auto' else word)


def _arguments(where: str, value: Any) -> str:
    if not isinstance(value, str) or value and not value.isprintable():
        raise error(where, value, 'a text of one line')
    return value


@dataclass(frozen=True)
class RunOptions:
    """How a system runs in lockstep."""

    participant: Tuple[str, ...] = option(
        list_of(NODE, 'a list of names of nodes'), [], 'nodes that take part, whatever [they look '
        'like](lockstep_launch.md#who-takes-part)', systems=_OF_FILES, in_digest=True, metavar='NODE')
    onlooker: Tuple[str, ...] = option(
        list_of(NODE, 'a list of names of nodes'), [], 'nodes that look on, whatever they look like',
        systems=_OF_FILES, in_digest=True, metavar='NODE')
    leave_out: Tuple[str, ...] = option(
        list_of(NODE, 'a list of names of nodes'), [], 'nodes that are not started', systems=_OF_FILES, metavar='NODE')
    replace: Dict[str, str] = option(
        map_of(PROGRAM, PROGRAM), {}, 'programs that are started in the place of others, with the same names, '
        'parameters and remaps: `move_base/move_base=move_base_abstract/move_base`', systems=_OF_FILES,
        metavar='PACKAGE/TYPE=PACKAGE/TYPE')
    adopt: bool = option(
        FLAG, False, 'adapts a launch file of others [by rule](adopt.md): replaces `move_base`, leaves out simulators, '
        'takes start poses from the file', systems=_OF_FILES, in_digest=True)
    real_navigation: bool = option(
        FLAG, False, "with `adopt`: the file's own `amcl` and `move_base` stay, and only the simulator is "
        '[replaced](adopt.md#robots-that-are-driven-by-velocities)', systems=_OF_FILES, in_digest=True)
    tolerant: bool = option(
        FLAG, False, 'leaves out what the file names and is not installed (programs, files that it includes or loads, '
        'parameters from a program, environment variables), uses packages that lie beside the file, and runs the '
        'nodes of all machines here', systems=_OF_FILES, in_digest=True)
    python2: Tuple[str, ...] = option(
        list_of(pattern('[A-Za-z][A-Za-z0-9_.-]*', 'names of packages'), 'a list of names of packages'), [], 'packages '
        'whose programs are written for [Python 2](adopt.md#programs-for-python-2), and are translated when loaded',
        systems=_OF_FILES, in_digest=True, metavar='PACKAGE')
    start: Dict[str, Tuple[float, float, float]] = option(
        map_of(POSE, NODE), {}, "where a robot's node starts [m, m, rad, map frame]: its `start_x`, `start_y`, "
        '`start_yaw`', systems=_OF_FILES, in_digest=True, metavar='NODE=X,Y,YAW')
    param: Dict[str, Any] = option(
        PARAMETERS, {}, "parameters by their full names, which take precedence over the file's; on "
        'a command line the value is YAML', systems=OF_NODES, in_digest=True, metavar='NAME=VALUE')
    add: Dict[str, str] = option(
        map_of(ADDED, NODE), {}, 'nodes that are started too, each as `PACKAGE/TYPE [ARGUMENTS]`',
        systems=_OF_FILES, in_digest=True, metavar="'NODE=PACKAGE/TYPE [ARGUMENTS]'")
    node_args: Dict[str, str] = option(
        map_of(Kind(_arguments, {'type': 'string'}), NODE), {}, "arguments of nodes, in the place of the file's",
        systems=_OF_FILES, in_digest=True, was='args', metavar="'NODE=ARGUMENTS'")
    no_respawn: bool = option(
        FLAG, False, 'nodes with `respawn` are started once, and take part', systems=_OF_FILES, in_digest=True)
    until: Any = option(  # a float [s]; in an experiment all that ends a trial, in a test also the test itself
        number(1e-9, LAST_INSTANT_S, or_zero=True, unit='s, simulated'), 0, 'the run ends at this instant of simulated '
        'time [s], which begins at 1; 0: no such end', systems=OF_NODES, parameter='end_at', metavar='S')
    seed: int = option(
        number(-_LARGEST_SEED, _LARGEST_SEED, whole=True), 0, "the seed of the programs' global random generators",
        metavar='S')
    sleep: str = option(
        one_of('wall', 'simulated'), 'wall', 'which time `time.sleep` takes in [programs](lockstep_launcher.md): '
        '`wall`, while simulated time stands still, or `simulated`')
    stored_topics: Tuple[str, ...] = option(
        list_of(STORED_TOPIC), [], 'topics (`NODE=TOPIC`: of one node) whose messages nodes [only '
        'store](lockstep.md#topics-that-nodes-only-store), and get together with the next thing that they do',
        systems=OF_NODES, in_digest=True, parameter='stored_topics', flag='stored_topic', metavar='[NODE=]TOPIC')
    lookahead: Union[float, str] = option(
        number(1e-6, 1000, or_zero=True, unit='s, simulated', or_word='network'), 0, 'messages between nodes take '
        'this time [s, simulated], and the nodes work at once ([windows](lockstep_windows.md)); `network`: it is '
        'the least delay of the links of the `network`; 0: no time', systems=OF_NODES, in_digest=True,
        parameter='lookahead', metavar='S')
    network: str = option(
        text(), None, 'messages between nodes of different hosts go over the [radio](radio.md) that a file '
        'describes, `FILE [NAME:=VALUE ...]`; the values replace its `$(arg NAME)`', systems=OF_NODES,
        in_digest=True, parameter='network', metavar="'FILE [NAME:=VALUE ...]'")
    chaos_seed: int = option(
        number(0, LARGEST_CHAOS_SEED, whole=True), 0, 'the seed of [another legal order](chaos.md) of equal '
        'events; 0: the stated order', systems=OF_NODES, in_digest=True, parameter='chaos_seed', metavar='N')
    chaos_delay: float = option(
        number(1e-9, 1000, or_zero=True, unit='s, simulated'), 0, 'with a `chaos_seed`, messages take up to '
        'this time [s, simulated]; 0: no time', systems=OF_NODES, in_digest=True, parameter='chaos_delay', metavar='S')
    chaos_starts: float = option(
        number(1e-8, 1000, or_zero=True, unit='s, simulated'), 0, 'with a `chaos_seed`, nodes start up to this time '
        '[s, simulated] late, and their connections are up to a tenth of it late; 0: all start together',
        systems=OF_NODES, in_digest=True, parameter='chaos_starts', metavar='S')
    chaos_only: Tuple[str, ...] = option(
        list_of(pattern('[0-9a-f]{12}|none', 'names of decisions, 12 hexadecimal digits each, or none')), [],
        'the decisions of `chaos_seed` that apply, by the names that `chaos` prints; `none`: none, `[]`: all',
        systems=OF_NODES, in_digest=True, parameter='chaos_only', metavar='NAME')
    cores: str = option(
        _CORES, None, 'the [cores](time_master.md#cores) on which nodes run: `one` (also the '
        'default if the launch file sets nothing), or `all`, as always with a lookahead; `auto` is an old word for '
        '`one`. The events are the same in each case', systems=OF_NODES, parameter='cores')
    crashes: str = option(
        one_of(FAIL, ALLOW), FAIL, 'what happens if a node [crashes](lockstep_launch.md#crashes): the run fails '
        '(`fail`), or the crash is reported and the run counts if it comes to its end (`allow`)')
    properties: Tuple[str, ...] = option(
        list_of(built_in.KIND), [], 'the [properties](properties.md) that are checked when a run is over: `all`, or '
        'names', systems=OF_NODES, flag='property', was='properties', metavar='NAME')

    def __post_init__(self) -> None:
        """Check what depends on several options. :raises ConfigurationError: naming them, and what is allowed."""
        if not self.chaos_seed and (self.chaos_delay or self.chaos_starts or self.chaos_only):
            raise ConfigurationError("'chaos_delay', 'chaos_starts' and 'chaos_only' need a 'chaos_seed' of 1 or more")
        if self.lookahead and self.chaos_seed:
            raise ConfigurationError("'chaos_seed' must be 0 with a 'lookahead', because then no events are equal")
        if self.lookahead and self.stored_topics:
            raise ConfigurationError("'stored_topics' must be [] with a 'lookahead', because then all takes time")
        if self.lookahead == 'network' and not self.network:
            raise ConfigurationError("'lookahead' must be a number [s] without a 'network' that has delays")
