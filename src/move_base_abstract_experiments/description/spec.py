"""Read an experiment's file, and check it as a whole before anything starts.

The module `experiment` checks each option by itself; this one checks what depends on several options. An unknown key
is an error that names the most similar known key.
"""
from __future__ import annotations

import dataclasses
import math
import os
from typing import Any, Dict, Iterable, List, Optional, Tuple

from move_base_abstract.common.bounded_yaml import load_yaml_file, load_yaml_text
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import error, unknown
from move_base_abstract.common.options import options_of, read as read_options, schema_of
from move_base_abstract.runs.metrics import USUAL

from . import placeholders
from .experiment import MOST_TRIALS, OWN_COLUMNS, SYSTEMS, Experiment, in_words

#: why a system does not have an option of another one; follows the error
_WITHOUT = {'command': '; a command has its words', 'launch': '',
            'function': '; a function ends by itself, and has no participants'}


def read(path: str, folder: Optional[str] = None, given: Optional[Dict[str, Any]] = None) -> Experiment:
    """Return the Experiment in a YAML file. ``folder``: where relative paths in it start; None: in the file's folder.

    ``given``: {key: value} from the command line, see changed().

    :raises ConfigurationError: naming the file, the place in it, and what is allowed.
    """
    document = load_yaml_file(path)
    document = changed(document, given) if isinstance(document, dict) and given else document
    try:
        return checked(document, os.path.dirname(os.path.abspath(path)) if folder is None else folder)
    except ConfigurationError as problem:
        raise ConfigurationError(f'{path}: {problem}') from None


def changed(document: Dict[str, Any], given: Dict[str, Any]) -> Dict[str, Any]:
    """Return a document with {key: value} from the command line: lists and mappings are added to those of the file."""
    found = {**document, **given}
    for key, value in given.items():
        for kind in (list, dict):
            if isinstance(value, kind) and isinstance(document.get(key), kind):
                found[key] = [*document[key], *value] if kind is list else {**document[key], **value}
    return found


def changed_text(text: bytes, given: Dict[str, Any]) -> bytes:
    """Return the text of an experiment's file, changed as by changed()."""
    import yaml
    document: bytes = yaml.safe_dump(changed(load_yaml_text(text, 'the file'), given), sort_keys=False,
                                     allow_unicode=True, encoding='utf-8')
    return b'# the file as given, changed by: ' + ', '.join(given).encode() + b'\n' + document


def checked(document: Any, folder: str) -> Experiment:
    """Return the Experiment of a document, as loaded from YAML; see read()."""
    if isinstance(document, dict) and 'isolation' in document:  # until the release after 1.0
        raise ConfigurationError("'isolation' has gone: each trial has a process of its own; take this line out")
    experiment = read_options(Experiment, '', document, folder=folder)
    given = [key for key in SYSTEMS if key in document]
    if len(given) != 1:
        raise ConfigurationError(f"exactly one of {', '.join(SYSTEMS)} must be given, got {', '.join(given) or 'none'}")
    _check_system(experiment, experiment.system)
    known = [*experiment.factors, 'seed', 'replication']
    for where, value in _texts(experiment):
        placeholders.check(where, value, known)
    _check_replications(experiment)
    _check_compared(experiment)
    _check_names(experiment)
    _check_factors(experiment)
    return experiment


def schema() -> Dict[str, Any]:
    """Return the JSON Schema of experiments' files. It checks everything except names that refer to other keys."""
    refused = {system: _refused(Experiment, system) for system in SYSTEMS}
    refused['command']['participants'] = {'type': 'array'}  # a command does not say which nodes take part
    systems: List[Any] = [{'if': {'required': [system]}, 'then': {'properties': refused[system], **(
        {'required': ['participants']} if system == 'command' else {})}} for system in SYSTEMS]
    windows = {'if': {'properties': {'lookahead': {'exclusiveMinimum': 0}}, 'required': ['lookahead']},
               'then': {'properties': {'stored_topics': {'maxItems': 0}, 'chaos_seed': {'maximum': 0}}}}
    by_network = {'if': {'properties': {'lookahead': {'enum': ['network']}}, 'required': ['lookahead']},
                  'then': {'required': ['network']}}
    decides = {'if': {'anyOf': [*({'properties': {key: {'exclusiveMinimum': 0}}, 'required': [key]}
                                  for key in ('chaos_delay', 'chaos_starts')),
                                {'properties': {'chaos_only': {'minItems': 1}}, 'required': ['chaos_only']}]},
               'then': {'properties': {'chaos_seed': {'minimum': 1}}, 'required': ['chaos_seed']}}
    return {'$schema': 'http://json-schema.org/draft-07/schema#', 'title': 'an experiment of move_base_abstract',
            **schema_of(Experiment), 'oneOf': [{'required': [system]} for system in SYSTEMS],
            'allOf': [*systems, windows, by_network, decides]}


def _refused(cls: Any, system: str) -> Dict[str, Any]:
    """Return the schemas of the options that a system does not have; only their defaults are allowed."""
    found: Dict[str, Any] = {}
    for key, one in options_of(cls).items():
        inner = _refused(type(one.initial), system) if dataclasses.is_dataclass(one.initial) else {}
        if one.systems and system not in one.systems:
            found[key] = False if one.default is None else {'enum': [one.default]}
        elif inner:
            found[key] = {'properties': inner}
    return found


def configurations(experiment: Experiment) -> List[Dict[str, Any]]:
    """Return all configurations, {factor: value}, the last factor changing fastest."""
    found: List[Dict[str, Any]] = [{}]
    for name, values in experiment.factors.items():
        found = [{**one, name: value} for one in found for value in values]
    return found


def _check_system(record: Any, system: str, where: str = '') -> None:
    """Check that no option of another system is given."""
    for key, one in options_of(record).items():
        value = getattr(record, one.field)
        if one.systems and system not in one.systems and value != one.initial:
            raise ConfigurationError(f"'{where}{key}' is an option for {in_words(one.systems)}{_WITHOUT[system]}")
        if dataclasses.is_dataclass(value):
            _check_system(value, system, f'{where}{key}.')


def _check_names(experiment: Experiment) -> None:
    for place, names in (('factors', experiment.factors), ('metrics.columns', experiment.metrics.columns)):
        for name in names:
            if name in OWN_COLUMNS or name in USUAL or place != 'factors' and name in experiment.factors:
                raise ConfigurationError(f'{place}: {name!r} is the name of a column of the table; give another name')
    if experiment.metrics.columns and not (experiment.metrics.function or experiment.function):
        raise ConfigurationError('metrics.columns: no metrics.function returns them')
    if experiment.command and experiment.participants is None:
        raise ConfigurationError('participants: a command does not say which nodes take part; name them, such as '
                                 '[/coordinator, /robot_0/move_base]')
    if experiment.participants is not None and (experiment.participant or experiment.onlooker):
        raise ConfigurationError("'participant' and 'onlooker' change what 'participants: all' says; with a list of "
                                 "'participants', all others look on")


def _texts(experiment: Experiment) -> List[Tuple[str, Any]]:
    """Return (where, text) for all texts in which {NAME} is a placeholder."""
    return [('launch', experiment.launch), ('network', experiment.network),
            *((f'{place}.{key}', value) for place in ('args', 'param', 'start')
              for key, value in getattr(experiment, place).items()),
            *(('command', word) for word in experiment.command)]


def _check_factors(experiment: Experiment) -> None:
    """Check that the system gets each factor; otherwise all its values would give the same system."""
    for name in () if experiment.function else experiment.factors:
        if not any('{' + name + '}' in str(value) for _, value in _texts(experiment)):
            where = 'command: a word' if experiment.command else f'args: {name}:'
            raise ConfigurationError(f"factors.{name}: nothing of the system depends on it; use {{{name}}} in what "
                                     f"the system gets, such as {where} '{{{name}}}'")


def _check_replications(experiment: Experiment) -> None:
    for name, levels in experiment.replications.fewer.items():
        if name not in experiment.factors:
            raise unknown('replications: the factor', name, ['all', *experiment.factors])
        for level, number in levels.items():
            _check_level(f'replications.{name}', level, experiment.factors[name])
            if number > experiment.replications.all:
                raise error(f'replications.{name}.{level}', number,
                                  f"at most 'all', which is {experiment.replications.all}")
    count = experiment.replications.all * math.prod(len(values) for values in experiment.factors.values())
    if count > MOST_TRIALS:
        raise ConfigurationError(f'the experiment has {count} trials, more than {MOST_TRIALS}')


def _check_compared(experiment: Experiment) -> None:
    """Check the names of metrics, if all are known before a trial has run, and the factors and values of baselines."""
    is_known = not (experiment.metrics.function or experiment.function)
    for key, names in (('primary', [experiment.primary] if experiment.primary else []),
                       ('smallest_difference', experiment.smallest_difference), ('at_limit', experiment.at_limit)):
        for name in names:
            if is_known and name not in experiment.known_metrics:
                raise unknown(f'{key}: the metric', name, experiment.known_metrics)
    for name, value in experiment.baseline.items():
        if name not in experiment.factors:
            raise unknown('baseline: the factor', name, experiment.factors)
        _check_level(f'baseline.{name}', value, experiment.factors[name])


def _check_level(where: str, value: Any, levels: Iterable[Any]) -> None:
    if not any(type(value) is type(one) and value == one for one in levels):
        raise unknown(f'{where}: the value', str(value), map(str, levels))
