"""The class Experiment: the options of an experiment's file. Each option is written here once, with all about it.

From these options follow: how a file is read and checked, its JSON Schema, the table in the docs, which options a trial
depends on, and the parameters of the time master.
"""
from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import Any, Dict, Iterable, List, Optional, Tuple

from move_base_abstract.common.kinds import (
    FLAG,
    NAME,
    SCALAR,
    Kind,
    list_of,
    map_of,
    number,
    one_of,
    one_of_types,
    or_null,
    pattern,
    text,
)
from move_base_abstract.common.options import collected, mapping_of, option
from move_base_abstract.lockstep.run_options import LAST_INSTANT_S, NAMES, NODE, OF_NODES, PARAMETERS, POSE, RunOptions
from move_base_abstract.runs.metrics import USUAL, Metric

SYSTEMS = ('launch', 'command', 'function')  # an experiment runs exactly one of them
_LAUNCH = ('launch',)
ALL = 'all'
MOST_TRIALS = 1_000_000
LONGEST_S = 1e9  # simulated, of a trial
LARGEST_SEED = 10**17
OWN_COLUMNS = ('id', 'replication', 'seed', 'status', 'simulated_seconds', 'wall_seconds', 'times_real_time',
               'repeatable', 'labels', 'events', 'log_sha256', 'verified', 'ended_by', 'error')


def in_words(systems: Iterable[str]) -> str:
    """Return some of SYSTEMS in words: 'a launch file or a command'."""
    return ' or '.join(f'a {each} file' if each == 'launch' else f'a {each}' for each in systems)


_TOPIC = pattern(NAMES, 'the name of a topic, such as /done', lambda name: '/' + name.lstrip('/'))
_ALL_OR_NODES = f'a list of names of nodes, or {ALL}'
_FUNCTION = pattern(r'[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*:[A-Za-z_][A-Za-z0-9_]*',
                    'module:function, such as my_package.metrics:summarise')
_COUNT = number(1, MOST_TRIALS, whole=True)
_INSTANT = number(1e-9, LAST_INSTANT_S, unit='s, simulated')


@dataclass(frozen=True)
class Until:
    """What ends a trial, whichever comes first. The end of a node that the launch file calls required ends it, too."""

    seconds: float = option(number(1e-6, LONGEST_S, unit='s, simulated'), None, 'the trial ends after this time [s, '
                            'simulated]',
                            absent=0.0)
    at: float = option(_INSTANT, None, 'the trial ends at this instant [s, simulated], as with `--until`; `until: 60` '
                       'is short for `until: {at: 60}`', absent=0.0, in_digest=True)
    topic: str = option(_TOPIC, None, 'the trial ends with the first message on this topic')
    idle: bool = option(FLAG, False, 'the trial ends when no participant has anything left to do',
                        parameter='end_when_idle')


@dataclass(frozen=True)
class Record:
    """What is kept of a trial besides its event log."""

    messages: Tuple[str, ...] = option(list_of(_TOPIC, 'names of topics, such as /idleness'), [], 'topics that are '
                                       'written to `messages.jsonl`', systems=OF_NODES)
    files: Tuple[str, ...] = option(
        list_of(pattern(r'[A-Za-z0-9_.*?\[\]-]{1,100}', 'names of files without a folder, with * and ?, as *.csv')), [],
        "patterns (`'*.csv'`) of files that nodes leave in their working folder and that are kept")
    hashes: bool = option(FLAG, False, 'the event log has a hash of each message between participants',
                          parameter='log_messages')
    motion: bool = option(FLAG, True, 'robots log how they drive (`/log_motion`); without it a '
                          '[replay](replay.md) is not exact, and legs count as straight, a first one not at all')


@dataclass(frozen=True)
class Column:
    """The title, unit and better side of a metric of the user."""

    title: str = option(text(100), None, 'its name in the report')
    unit: Any = option(SCALAR, '', 'its unit')
    better: Optional[str] = option(or_null(one_of('lower', 'higher')), None, '`lower` or `higher`', absent=None)


@dataclass(frozen=True)
class Metrics:
    """The metrics of the user: the function that returns them, and how they are called."""

    function: str = option(_FUNCTION, None, '`module:function` that returns them')
    columns: Dict[str, Column] = option(
        map_of(mapping_of(Column)), {}, '`{NAME: {title, unit, better}}`: title and unit of each metric; `better`: '
        '`lower` or `higher`')


@dataclass(frozen=True)
class Replications:
    """The number of replications of each configuration.

    ``fewer``: {factor: {value: the number for configurations with this value}}.
    """

    all: int = 1
    fewer: Dict[str, Dict[Any, int]] = field(default_factory=dict)


def _replications(where: str, value: Any) -> Replications:
    if not isinstance(value, dict):
        return Replications(_COUNT.check(where, value))
    given = dict(value)
    whole = _COUNT.check(f'{where}.all', given.pop(ALL, 1))
    return Replications(whole, map_of(map_of(_COUNT, SCALAR)).check(where, given))


_REPLICATIONS = Kind(_replications, {'anyOf': [_COUNT.schema, {
    'type': 'object', 'properties': {ALL: _COUNT.schema},
    'additionalProperties': {'type': 'object', 'additionalProperties': _COUNT.schema}}]})


def _start(where: str, value: Any) -> str:
    """Return a pose as the text X,Y,YAW, in which placeholders may stand."""
    pose = ','.join(map(str, value)) if isinstance(value, (list, tuple)) else value
    return pose if isinstance(pose, str) and '{' in pose else POSE.to_word(POSE.check(where, pose))


@dataclass(frozen=True)
class Experiment(RunOptions):
    """The content of an experiment's file, checked. ``folder``: its folder; relative paths in it start there."""

    folder: str = ''
    name: str = option(text(100), None, 'the name of the experiment', key='experiment', is_required=True)
    launch: str = option(text(), None, 'a launch file; `$(find PACKAGE)`, or a path from the folder of this file')
    command: Tuple[str, ...] = option(
        list_of(text(), least=1, allowed='at least one word, at most 10000'), None, "instead of a launch file: "
        "a command as a list of words, run under the trial's ROS master. It starts its nodes itself, with the "
        "[launcher](lockstep_launcher.md): `[rosrun, move_base_abstract, lockstep, --seed, '{seed}', my_node.py]`; "
        '`participants` must name the nodes that take part', absent=())
    function: str = option(_FUNCTION, None, 'instead of a launch file: `module:function` that is a trial, '
                           '[below](#trials-that-are-a-function)')
    prepare: str = option(_FUNCTION, None, '`module:function` that each warm process calls once, '
                          '[below](#trials-that-are-a-function)', systems=('function',))
    inputs: Tuple[str, ...] = option(list_of(text()), [], 'files on whose content a trial depends; paths are relative '
                                     'to the folder of this file')
    participants: Optional[Tuple[str, ...]] = option(
        one_of_types(list_of(NODE, _ALL_OR_NODES), (str, lambda _: None, pattern(ALL, _ALL_OR_NODES))), ALL,
        '`all`: every rospy and roscpp node, [by these rules](lockstep_launch.md#who-takes-part); or a list of '
        'nodes, and the others look on', systems=OF_NODES)
    start: Dict[str, Any] = option(
        map_of(replace(POSE, check=_start), NODE), {}, "`{NODE: [X, Y, YAW]}`: where a robot's node starts [m, m, rad, "
        'map frame]; `{NAME}` stands for a factor, as in `args`', systems=_LAUNCH, in_digest=True)
    param: Dict[str, Any] = option(
        PARAMETERS, {}, "`{NAME: VALUE}`: parameters by their full names, which take precedence over the file's; "
        '`{NAME}` stands for a factor, as in `args`', systems=OF_NODES, in_digest=True)
    args: Dict[str, Any] = option(
        map_of(SCALAR), {}, 'arguments of the launch file or the function; `{NAME}` stands for a factor, for `seed` '
        'or `replication`', systems=('launch', 'function'))
    factors: Dict[str, Tuple[Any, ...]] = option(
        map_of(list_of(SCALAR, 'a list, each a text, a number, true or false', 1, True, MOST_TRIALS)), {},
        'each factor is a list of strings, numbers, true or false; all combinations run. A factor that no `args`, '
        '`param`, `start`, `launch`, `network` or `command` uses is an error, because all its values would be the same '
        'system')
    replications: Replications = option(
        _REPLICATIONS, 1, 'replications of each configuration. With `{all: 30, robots: {8: 5}}`, configurations with '
        'that value of the factor have fewer (never more)')
    seed: int = option(number(0, LARGEST_SEED, whole=True), 0, 'replication k (from 0 on) has the seed `seed` + k in '
                       'every configuration: common random numbers')
    until: Until = option(
        one_of_types(mapping_of(Until), *((type_, lambda at: Until(at=at), _INSTANT) for type_ in (int, float))),
        {}, 'what ends a trial, whichever comes first; a node with `required="true"` ends it too',
        systems=OF_NODES)
    record: Record = option(
        mapping_of(Record), {}, 'what is kept of a trial besides its event log')
    metrics: Metrics = option(
        one_of_types(mapping_of(Metrics), (str, lambda name: Metrics(function=name), _FUNCTION)), {},
        '`module:function` that returns a number for each metric, [below](#metrics); or a mapping')
    primary: str = option(NAME, None, 'the metric that the experiment is about: the report shows it first, tests it '
                          'separately, and folds the others')
    baseline: Dict[str, Any] = option(map_of(SCALAR), {}, '`{algorithm: greedy}`: the value of a factor with which the '
                                      'report compares all its other values')
    smallest_difference: Dict[str, float] = option(
        map_of(number(1e-100, 1e100)), {}, '`{makespan: 5.0}`: the smallest difference that matters, per metric, in '
        'its '
        'unit; a difference that is surely smaller is called negligible')
    at_limit: Dict[str, str] = option(
        map_of(one_of('lower_bound', 'value')), {}, '`{NAME: lower_bound or value}`: what a metric means in a trial '
        'that '
        '`until: seconds` ended, if it might have gone on; '
        '[otherwise](experiment_report.md#trials-that-the-limit-of-time-ended) the metric is not compared')
    report: Tuple[str, ...] = option(
        one_of_types(list_of(_FUNCTION, 'a list of module:function, or one'), (str, lambda name: (name,), _FUNCTION)),
        [], '`module:function`, or a list: [sections of your own](experiment_report.md#sections-of-your-own) in the '
        'report')
    verify: float = option(number(0, 1), 0, 'the share of trials that [run twice](#a-trial), to compare them')
    time_limit: float = option(number(1, 1e7, unit='s, wall'), 600, 'the time that a run may take [s, wall]')

    @functools.cached_property
    def digest_options(self) -> List[Dict[str, Any]]:
        """The options that plan.made_of() takes besides its fixed list, one {field: value} each; not the defaults."""
        return [{one.field: value} for one, value in collected(self, lambda one: one.in_digest)]

    @property
    def system(self) -> str:
        """The one of SYSTEMS that the experiment runs."""
        return next(key for key in SYSTEMS if getattr(self, key))

    @property
    def known_metrics(self) -> Dict[str, Metric]:
        """The metrics that are known before a trial has run, by name: the built-in ones, then those of the user."""
        own = {name: Metric(one.title or name, one.unit, one.better) for name, one in self.metrics.columns.items()}
        return {**({} if self.function else USUAL), **own}

    @property
    def functions(self) -> Dict[str, str]:
        """The functions of the user that the experiment calls: {key of the file: 'module:function'}."""
        named = {'metrics': self.metrics.function, 'function': self.function, 'prepare': self.prepare}
        return {key: name for key, name in named.items() if name}

    def replications_of(self, configuration: Dict[str, Any]) -> int:
        """Return the number of replications of a configuration, {factor: value}."""
        fewer = self.replications.fewer
        return min([self.replications.all, *(fewer[name][value] for name, value in configuration.items()
                                             if value in fewer.get(name, {}))])

