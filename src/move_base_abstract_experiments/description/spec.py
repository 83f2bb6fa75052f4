"""What an experiment is: its file, read and checked as a whole before anything starts.

An unknown key is an error that names the known one which is like it.
"""
import math
import os
import re
from typing import NamedTuple, Optional

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep import stored_topics
from move_base_abstract_ros.launching import ends

from . import checks
from .metric_names import BUILT_IN, Metric

KEYS = ('experiment', 'launch', 'command', 'function', 'prepare', 'inputs', 'participants', 'leave_out', 'replace',
        'args', 'factors', 'replications', 'seed', 'until', 'record', 'metrics', 'primary', 'baseline',
        'smallest_difference', 'at_limit', 'report', 'verify', 'time_limit', 'sleep', 'lookahead', 'cores',
        'stored_topics', 'crashes')
SYSTEMS = ('launch', 'command', 'function')  # one of them is run
UNTIL = ('seconds', 'topic', 'idle')
RECORD = ('messages', 'files', 'hashes', 'motion')
METRICS = ('function', 'columns')
COLUMN = ('title', 'unit', 'better')
CORES = ('auto', 'one', 'all')
AT_LIMIT = ('lower_bound', 'value')
ALL = 'all'
MOST_TRIALS = 1_000_000
LONGEST_S = 1e9  # simulated, of a trial
TIME_LIMIT_S = 600.0  # wall, of a trial
LARGEST_SEED = 10**17
OWN_COLUMNS = ('id', 'replication', 'seed', 'status', 'simulated_seconds', 'wall_seconds', 'times_real_time',
               'repeatable', 'labels', 'events', 'log_sha256', 'verified', 'ended_by', 'error')
_TOPIC = re.compile(r'/?[A-Za-z][\w/]{0,255}\Z', re.ASCII)
_FUNCTION = re.compile(r'[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*\Z', re.ASCII)
_PATTERN = re.compile(r'[\w.*?\[\]-]{1,100}\Z', re.ASCII)
_KIND = re.compile(r'[A-Za-z][\w.-]*/[\w.-]+\Z', re.ASCII)


class Until(NamedTuple):
    """What ends a trial, whichever comes first; besides, the end of a node that the launch file calls required."""

    seconds: float = 0.0  # simulated, from the start; 0: no such end
    topic: str = ''  # the first message on it
    idle: bool = False  # when nobody has anything left to do


class Record(NamedTuple):
    """What is kept of a trial beside its event log."""

    messages: tuple = ()  # topics
    files: tuple = ()  # patterns of names of files that the nodes leave in their working folder
    hashes: bool = False  # whether what participants send each other is in the event log, as hashes
    motion: bool = True  # whether robots write by which limits they travel, so that a replay is exact


class Experiment(NamedTuple):
    """An experiment's file, checked. ``folder``: where it lies; relative paths in it start there."""

    name: str
    folder: str
    launch: str
    command: tuple
    trial_function: str  # module:function that is a trial, where no graph of nodes is run
    prepare: str  # module:function that each warm process calls once
    inputs: tuple  # files whose content makes a trial another one
    participants: Optional[tuple]  # full names; None: all
    leave_out: tuple
    replace: dict
    args: dict
    factors: dict
    replications: int
    fewer: dict  # {factor: {value: replications of its trials}}
    seed: int
    until: Until
    record: Record
    function: str
    columns: dict  # name: Metric, of the user's function
    primary: str  # the metric that the experiment is about, or ''
    baseline: dict  # {factor: the value with which all others are compared}
    smallest_difference: dict  # {metric: the smallest difference that counts}
    at_limit: dict  # {metric: one of AT_LIMIT, of trials that until.seconds has ended}
    report: tuple  # functions that add sections to the report, as module:function
    verify: float
    time_limit: float  # s, wall
    sleep: str
    lookahead: float = 0.0  # s, simulated, from one participant to another; 0: none
    cores: str = ''  # one of CORES, or '': what the launch file, or else the time master, says
    stored_topics: list = ()  # 'TOPIC' or 'NODE=TOPIC', which nodes only store
    crashes: str = ends.FAIL  # one of ends.POLICIES

    @property
    def metrics(self):
        """What is told of the metrics, as {name: Metric}: the built-in ones, then the user's."""
        return {**({} if self.trial_function else BUILT_IN), **self.columns}

    def replications_of(self, configuration):
        """Return how many replications a configuration, {factor: value}, has."""
        return min([self.replications, *(self.fewer[name][value] for name, value in configuration.items()
                                         if value in self.fewer.get(name, {}))])


def read(path, folder=None):
    """Return the Experiment in a YAML file; ``folder``: where relative paths in it start, if not where it lies.

    :raises ConfigurationError: naming the file, the place, what is allowed.
    """
    document = load_yaml_file(path)
    try:
        return checked(document, os.path.dirname(os.path.abspath(path)) if folder is None else folder)
    except ConfigurationError as problem:
        raise ConfigurationError(f'{path}: {problem}') from None


def checked(document, folder):
    """Return the Experiment of a document; see read()."""
    given = checks.mapping('the experiment', document, KEYS)
    if sum(key in given for key in SYSTEMS) != 1:
        raise ConfigurationError(f"one of {', '.join(SYSTEMS)} is wanted, got "
                                 f"{', '.join(key for key in SYSTEMS if key in given) or 'none'}")
    if 'experiment' not in given:
        raise ConfigurationError("'experiment' is missing: the name of the experiment")
    experiment = Experiment(
        name=checks.text('experiment', given['experiment'], 100), folder=folder,
        launch=checks.text('launch', given['launch']) if 'launch' in given else '',
        command=checks.texts('command', given.get('command', [])),
        trial_function=_function('function', given.get('function', '')),
        prepare=_function('prepare', given.get('prepare', '')),
        inputs=checks.texts('inputs', given.get('inputs', [])),
        participants=_participants(given.get('participants', ALL)),
        leave_out=_nodes('leave_out', given.get('leave_out', [])), replace=_replaced(given.get('replace', {})),
        args=_args(given.get('args', {})), factors=_factors(given.get('factors', {})),
        **_replications(given.get('replications', 1)),
        seed=checks.number('seed', given.get('seed', 0), 0, LARGEST_SEED, whole=True),
        until=_until(given.get('until', {})), record=_record(given.get('record', {})),
        **_metrics(given.get('metrics', {})), **_compared(given), report=_sections(given.get('report', [])),
        verify=float(checks.number('verify', given.get('verify', 0), 0, 1)),
        time_limit=float(checks.number('time_limit', given.get('time_limit', TIME_LIMIT_S), 1, 1e7)),
        sleep=checks.one_of('sleep', given.get('sleep', 'wall'), ('wall', 'simulated')),
        lookahead=_lookahead(given.get('lookahead', 0)),
        cores=checks.one_of('cores', given['cores'], CORES) if 'cores' in given else '',
        stored_topics=[stored_topics.checked(text)
                       for text in checks.texts('stored_topics', given.get('stored_topics', []))],
        crashes=checks.one_of('crashes', given.get('crashes', ends.FAIL), ends.POLICIES))
    _check_together(experiment)
    return experiment


def _lookahead(value):
    return float(value if value == 0 else checks.number('lookahead', value, 1e-6, 1000))


def configurations(experiment):
    """Return all configurations, {factor: value}, the last factor changing fastest."""
    found = [{}]
    for name, values in experiment.factors.items():
        found = [{**one, name: value} for one in found for value in values]
    return found


def _participants(value):
    return None if value == ALL else _nodes('participants', value)


def _nodes(where, value):
    if not isinstance(value, list):
        raise checks.error(where, value, 'a list of names of nodes' + (', or all' if where == 'participants' else ''))
    names = checks.texts(where, value)
    for name in names:
        if not _TOPIC.match(name):
            raise checks.error(where, name, 'names of nodes, such as /coordinator')
    return tuple('/' + name.lstrip('/') for name in names)


def _replaced(value):
    pairs = checks.mapping('replace', value)
    for kind in [*pairs, *pairs.values()]:
        if not isinstance(kind, str) or not _KIND.match(kind):
            raise checks.error('replace', kind, 'PACKAGE/TYPE: PACKAGE/TYPE, such as move_base/move_base')
    return pairs


def _args(value):
    return {checks.identifier('args', name): checks.scalar(f'args.{name}', item)
            for name, item in checks.mapping('args', value).items()}


def _factors(value):
    found = {}
    for name, values in checks.mapping('factors', value).items():
        checks.identifier('factors', name)
        if name in OWN_COLUMNS or name in BUILT_IN:
            raise ConfigurationError(f'factors: {name!r} is the name of a column of the table; name it otherwise')
        if not isinstance(values, list) or not values:
            raise checks.error(f'factors.{name}', values, f'a list, each {checks.SCALARS}')
        found[name] = [checks.scalar(f'factors.{name}[{k}]', item) for k, item in enumerate(values)]
        if len({(type(item), item) for item in found[name]}) < len(values):
            raise checks.error(f'factors.{name}', values, 'each value once')
    return found


def _replications(value):
    """Return the replications of all configurations, and those of factors' values that have fewer."""
    def count(where, number):
        return checks.number(where, number, 1, MOST_TRIALS, whole=True)
    if not isinstance(value, dict):
        return {'replications': count('replications', value), 'fewer': {}}
    given = dict(checks.mapping('replications', value))
    whole = count('replications.all', given.pop('all', 1))
    return {'replications': whole, 'fewer': {
        name: {level: count(f'replications.{name}.{level}', number) for level, number in levels.items()}
        if isinstance(levels, dict) else checks.mapping(f'replications.{name}', levels)
        for name, levels in given.items()}}


def _function(where, value):
    if value != '' and (not isinstance(value, str) or not _FUNCTION.match(value)):
        raise checks.error(where, value, f'module:function, such as my_package.{where}:{where}')
    return value


def _until(value):
    given = checks.mapping('until', value, UNTIL)
    topic = given.get('topic', '')
    if topic and (not isinstance(topic, str) or not _TOPIC.match(topic)):
        raise checks.error('until.topic', topic, 'the name of a topic, such as /done')
    seconds = float(checks.number('until.seconds', given['seconds'], 1e-6, LONGEST_S)) if 'seconds' in given else 0.0
    return Until(seconds, '/' + topic.lstrip('/') if topic else '',
                 checks.flag('until.idle', given.get('idle', False)))


def _record(value):
    given = checks.mapping('record', value, RECORD)
    topics = checks.texts('record.messages', given.get('messages', []))
    for topic in topics:
        if not _TOPIC.match(topic):
            raise checks.error('record.messages', topic, 'names of topics, such as /idleness')
    patterns = checks.texts('record.files', given.get('files', []))
    for pattern in patterns:
        if not _PATTERN.match(pattern):
            raise checks.error('record.files', pattern, 'names of files without a folder, with * and ?, as *.csv')
    return Record(tuple('/' + topic.lstrip('/') for topic in topics), patterns,
                  checks.flag('record.hashes', given.get('hashes', False)),
                  checks.flag('record.motion', given.get('motion', True)))


def _metrics(value):
    given = {'function': value} if isinstance(value, str) else checks.mapping('metrics', value, METRICS)
    function = given.get('function', '')
    if function and (not isinstance(function, str) or not _FUNCTION.match(function)):
        raise checks.error('metrics.function', function, 'module:function, such as my_package.metrics:summarise')
    columns = {}
    for name, told in checks.mapping('metrics.columns', given.get('columns', {})).items():
        where = f'metrics.columns.{checks.identifier("metrics.columns", name)}'
        about = checks.mapping(where, told, COLUMN)
        if name in OWN_COLUMNS or name in BUILT_IN:
            raise ConfigurationError(f'{where}: is the name of a column of the table already')
        better = about.get('better')
        columns[name] = Metric(checks.text(f'{where}.title', about.get('title', name), 100),
                               checks.scalar(f'{where}.unit', about.get('unit', '')),
                               better if better is None else checks.one_of(f'{where}.better', better,
                                                                           ('lower', 'higher')))
    return {'function': function, 'columns': columns}


def _compared(given):
    """Return what the report is to compare by: keys that say nothing of how trials run."""
    primary = given.get('primary', '')
    smallest = {checks.identifier('smallest_difference', name): float(checks.number(
        f'smallest_difference.{name}', value, 1e-100, 1e100))
        for name, value in checks.mapping('smallest_difference', given.get('smallest_difference', {})).items()}
    at_limit = {checks.identifier('at_limit', name): checks.one_of(f'at_limit.{name}', value, AT_LIMIT)
                for name, value in checks.mapping('at_limit', given.get('at_limit', {})).items()}
    return {'primary': checks.identifier('primary', primary) if primary != '' else '', 'at_limit': at_limit,
            'smallest_difference': smallest,
            'baseline': dict(checks.mapping('baseline', given.get('baseline', {})))}


def _check_compared(experiment):
    """Check names of metrics, as far as they are known before a trial has run, and of factors' values."""
    is_known = not (experiment.function or experiment.trial_function)
    for key, names in (('primary', [experiment.primary] if experiment.primary else []),
                       ('smallest_difference', experiment.smallest_difference), ('at_limit', experiment.at_limit)):
        for name in names:
            if is_known and name not in experiment.metrics:
                raise checks.unknown(f'{key}: the metric', name, experiment.metrics)
    for name, value in experiment.baseline.items():
        if name not in experiment.factors:
            raise checks.unknown('baseline: the factor', name, experiment.factors)
        if not any(type(value) is type(one) and value == one for one in experiment.factors[name]):
            raise checks.unknown(f'baseline.{name}: the value', str(value), map(str, experiment.factors[name]))


def _sections(value):
    names = checks.texts('report', [value] if isinstance(value, str) else value)
    for name in names:
        if not _FUNCTION.match(name):
            raise checks.error('report', name, 'module:function, such as my_package.report:sections, or a list of such')
    return names


def _texts(experiment):
    """Return (where, text) of all in which {NAME} stands for something."""
    return [('launch', experiment.launch), *(('args.' + key, value) for key, value in experiment.args.items()),
            *(('command', word) for word in experiment.command)]


def _check_factors(experiment):
    """Check that each factor gets to the system: else its values were all the same."""
    for name in () if experiment.trial_function else experiment.factors:
        if not any('{' + name + '}' in str(value) for _, value in _texts(experiment)):
            where = 'command: a word' if experiment.command else f'args: {name}:'
            raise ConfigurationError(f"factors.{name}: nothing of the system depends on it; wanted is {{{name}}} in "
                                     f"what it gets, such as {where} '{{{name}}}'")


def _check_together(experiment):
    """Check what depends on several keys."""
    known = [*experiment.factors, 'seed', 'replication']
    for where, value in _texts(experiment):
        checks.check_places(where, value, known)
    for name in experiment.columns:
        if name in experiment.factors:
            raise ConfigurationError(f'metrics.columns.{name}: is a factor, too; name one of them otherwise')
    if experiment.columns and not (experiment.function or experiment.trial_function):
        raise ConfigurationError('metrics.columns: there is no metrics.function that gives them')
    _check_replications(experiment)
    _check_compared(experiment)
    if not experiment.launch:
        for key in ('leave_out', 'replace', *(('args',) if experiment.command else ())):
            if getattr(experiment, key):
                raise ConfigurationError(f"'{key}' is of a launch file" + (
                    '; a command has its words' if experiment.command else ''))
    if experiment.command and experiment.participants is None:
        raise ConfigurationError('participants: a command does not say who takes part; name the nodes, such as '
                                 '[/coordinator, /robot_0/move_base]')
    if not (experiment.launch or experiment.command or experiment.trial_function):
        raise ConfigurationError('command: at least one word is wanted')
    if experiment.trial_function and (any(experiment.until) or experiment.record.messages or experiment.participants):
        raise ConfigurationError("'until', 'record.messages' and 'participants' are of a launch file or a command; "
                                 'a function ends by itself')
    for key in ('lookahead', 'cores', 'stored_topics'):
        if experiment.trial_function and getattr(experiment, key):
            raise ConfigurationError(f"'{key}' is of a launch file or a command; a function has no participants")
    if experiment.lookahead and experiment.stored_topics:
        raise ConfigurationError("'stored_topics' must be [] with a 'lookahead', where all takes time")
    if experiment.prepare and not experiment.trial_function:
        raise ConfigurationError("'prepare' goes with 'function'")
    _check_factors(experiment)


def _check_replications(experiment):
    for name, levels in experiment.fewer.items():
        if name not in experiment.factors:
            raise checks.unknown('replications: the factor', name, ['all', *experiment.factors])
        for level, number in levels.items():
            if level not in experiment.factors[name]:
                raise checks.unknown(f'replications.{name}: the value', str(level), map(str, experiment.factors[name]))
            if number > experiment.replications:
                raise checks.error(f'replications.{name}.{level}', number,
                                   f"at most 'all', which is {experiment.replications}")
    count = experiment.replications * math.prod(len(values) for values in experiment.factors.values())
    if count > MOST_TRIALS:
        raise ConfigurationError(f'{count} trials; allowed: at most {MOST_TRIALS}')
