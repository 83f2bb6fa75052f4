"""plan.json and trial.json: their keys, and how they are read. Anybody may have written them, so all is checked.

They are plain files of a bounded size. The type of a field here says which values its key may have. If a key is
missing, as in a file of an older version, its value is the default. Unknown keys are ignored.
"""
from __future__ import annotations

import dataclasses
import functools
import math
import os
import re
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple, Type, TypeVar, Union, get_type_hints

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import load_json_mapping
from move_base_abstract.common.shown import shown

FORMAT = 1
MAX_PLAN_BYTES = 512 * 1024 * 1024  # enough for 1,000,000 trials
COMPLETE, FAILED = 'complete', 'failed'  # status
IDENTICAL, DIFFERENT = 'identical', 'different'  # verified
Number = Union[int, float, None]
T = TypeVar('T')
_IF_ANY = ('waits', 'error_lines')
_ID = re.compile(r'[A-Za-z0-9_][A-Za-z0-9._-]{0,199}\Z')
_KINDS = {dict: 'a mapping', list: 'a list', str: 'a text', int: 'a whole number', bool: 'true or false',
          float: 'a number', type(None): 'null'}


@dataclass
class Numbered:
    """The identity of a trial."""

    id: str
    configuration: Dict[str, Any] = field(default_factory=dict)
    replication: int = 0
    seed: int = 0


@dataclass
class Planned(Numbered):
    """A trial in plan.json. ``kept``: the label of a trial that is kept although it is of an old program; or None."""

    made_of: Optional[str] = None
    program: Optional[str] = None
    kept: Optional[str] = None

    @property
    def written(self) -> Dict[str, Any]:
        """The mapping that is written into the file."""
        return {key: value for key, value in vars(self).items() if value is not None}


@dataclass
class Plan:
    """plan.json: the trials of an experiment, and what the report needs to know about it."""

    experiment: str = ''
    factors: Dict[str, Any] = field(default_factory=dict)
    metrics: Dict[str, Any] = field(default_factory=dict)
    primary: Any = None
    baseline: Optional[Dict[str, Any]] = None
    at_limit: Optional[Dict[str, Any]] = None
    smallest_difference: Optional[Dict[str, Any]] = None
    until: Optional[Dict[str, Any]] = None
    replications: Any = None
    verify: Any = None
    report: Any = None
    provenance: Dict[str, Any] = field(default_factory=dict)
    trials: List[Planned] = field(default_factory=list)


@dataclass
class Result(Numbered):
    """trial.json: the outcome of a trial. Durations in s."""

    status: str = FAILED
    error: Optional[str] = None
    metrics: Dict[str, Number] = field(default_factory=dict)
    simulated_seconds: Number = None
    wall_seconds: Number = None
    times_real_time: Number = None
    repeatable: bool = False
    labels: List[str] = field(default_factory=list)
    events: int = 0
    log_sha256: Optional[str] = None
    verified: Optional[str] = None
    difference: Optional[str] = None
    robots: Dict[str, Any] = field(default_factory=dict)
    waits: Dict[str, Any] = field(default_factory=dict)  # {where robots waited for room: s}; written only if they did
    ended_by: Optional[str] = None
    open_goals: Optional[int] = None
    crashes: List[str] = field(default_factory=list)
    ends: List[Any] = field(default_factory=list)
    error_lines: List[Any] = field(default_factory=list)  # of its participants; written only if there are any
    properties: Dict[str, Any] = field(default_factory=dict)
    made_of: Optional[str] = None
    program: Optional[str] = None
    worker: Optional[str] = ''
    attempts: int = 1

    @property
    def is_complete(self) -> bool:
        """Whether the trial has come to its end."""
        return self.status == COMPLETE

    @property
    def written(self) -> Dict[str, Any]:
        """The mapping that is written into the file."""
        return {'format': FORMAT, **{name: value for name, value in vars(self).items() if name not in _IF_ANY or value}}

    def judged_by(self, primary: Any) -> Result:
        """Return this Result, as failed if it has no value of the experiment's primary metric (if it names one).

        trial.json does not say this, because ``primary`` may change when all trials have run.
        """
        there = [name for name, value in self.metrics.items() if value is not None and not math.isnan(value)]
        if not self.is_complete or not primary or not isinstance(primary, str) or primary in there:
            return self
        why = self.error or f'it has {", ".join(sorted(there)) or "no metric"}'
        return dataclasses.replace(self, status=FAILED, error=f'no value of {primary}, the primary metric: {why}')

    def fail(self, problem: str) -> None:
        """Mark the trial as failed, with this error."""
        self.status, self.error = FAILED, problem


def read_plan(folder: str) -> Plan:
    """Return plan.json of an experiment's folder.

    :raises ConfigurationError: if it is missing, or cannot be understood.
    """
    path = os.path.join(folder, 'plan.json')
    try:
        content = load_json_mapping(path, MAX_PLAN_BYTES)
    except FileNotFoundError:
        raise ConfigurationError(f'{path}: is not there; `experiment run FILE -o OUT` makes it') from None
    plan = _read(Plan, content, path, FORMAT)
    for name, levels in plan.factors.items():
        _check({f'factors.{name}': levels}, {f'factors.{name}': (list,)}, path)
    plan.trials = [_planned(one, f'{path}: trials[{place}]') for place, one in enumerate(content.get('trials', []))]
    return plan


def _planned(content: Any, where: str) -> Planned:
    if not isinstance(content, dict) or not isinstance(content.get('id'), str) or not _ID.match(content['id']):
        raise ConfigurationError(f"{where}: must be a mapping with an 'id' of letters, digits, '.', '_' and '-', "
                                 f'got {shown(content)}')
    return _read(Planned, content, where)


def read_planned(folder: str, plan: Plan, planned: Planned) -> Optional[Result]:
    """Return trial.json of a planned trial, or None if it is missing, or its ``made_of`` is not the planned one.

    A trial that is kept although it is of an old program has a label that says so; one without a value of the plan's
    primary metric is failed. :raises: as read_trial(), also if the trial is of another plan.
    """
    result = read_trial(folder, planned.id)
    if result is None or None not in (planned.made_of, result.made_of) and planned.made_of != result.made_of:
        return None
    for key in ('configuration', 'replication', 'seed'):
        told, wanted = getattr(result, key), getattr(planned, key)
        if told != wanted:
            raise ConfigurationError(f"{os.path.join(folder, 'trials', planned.id, 'trial.json')}: is of another plan: "
                                     f"its '{key}' is {shown(told)}, but the plan has {shown(wanted)}")
    result = result.judged_by(plan.primary)
    return dataclasses.replace(result, labels=[*result.labels, planned.kept]) if planned.kept else result


def read_trial(folder: str, name: str) -> Optional[Result]:
    """Return trial.json of a trial of an experiment's folder, or None if it is missing.

    :raises ConfigurationError: if it cannot be understood; the text begins with its path.
    """
    path = os.path.join(folder, 'trials', name, 'trial.json')
    try:
        content = load_json_mapping(path)
    except FileNotFoundError:
        return None
    return result_of(content, name, path)


def result_of(content: Any, name: str, where: str) -> Result:
    """Return the content of a trial.json as a Result. ``where``: its path, for errors.

    :raises ConfigurationError: if it cannot be understood, or is not of the trial ``name``.
    """
    result = _read(Result, {'id': name, **content}, where, FORMAT)
    if result.id != name:
        raise ConfigurationError(f"{where}: 'id' must be {name!r}, got {shown(result.id)}")
    for label in result.labels:
        _check({'labels': label}, {'labels': (str,)}, where)
    for metric, value in result.metrics.items():
        _check({f'metrics.{metric}': value}, {f'metrics.{metric}': (int, float, type(None))}, where)
    return result


def _read(cls: Type[T], content: Dict[str, Any], where: str, wanted_format: Optional[int] = None) -> T:
    """Return a mapping as an object of a dataclass, with the types of the values checked."""
    if wanted_format and (content.get('format') != wanted_format or isinstance(content['format'], bool)):
        raise ConfigurationError(f"{where}: 'format' must be {wanted_format}, got {shown(content.get('format'))}; "
                                 'another version of this program wrote it')
    hashable: Any = cls  # which mypy does not believe of a dataclass
    types = _types_in(hashable)
    _check(content, types, where)
    return cls(**{name: content[name] for name in types if name in content})


@functools.lru_cache(maxsize=None)  # a table reads a file for each trial
def _types_in(cls: Any) -> Dict[str, Tuple[type, ...]]:
    """Return {name: the types that its values may have in a JSON file} for the fields of a dataclass."""
    return {name: _types_of(hint) for name, hint in get_type_hints(cls).items()}


def _types_of(hint: Any) -> Tuple[type, ...]:
    """Return the types that values of a type hint may have in a JSON file; () for any type."""
    if hint is Any:
        return ()
    origin = getattr(hint, '__origin__', hint)
    return tuple(_types_of(one)[0] for one in hint.__args__) if origin is Union else (origin,)


def _check(content: Dict[str, Any], types: Dict[str, Tuple[type, ...]], where: str) -> None:
    for key, allowed in types.items():
        value = content.get(key)
        if key in content and allowed and (
                not isinstance(value, allowed) or isinstance(value, bool) and bool not in allowed
                or isinstance(value, float) and not math.isfinite(value)):
            names = ' or '.join(_KINDS[one] for one in allowed)
            raise ConfigurationError(f'{where}: {key!r} must be {names}, got {shown(value)}')
