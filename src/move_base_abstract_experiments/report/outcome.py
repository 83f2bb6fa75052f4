"""Read an experiment's folder: its plan, and the outcome of each planned trial."""
from __future__ import annotations

import csv
import json
import math
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, Tuple

import numpy as np

from move_base_abstract.common.csv_files import open_csv
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import MAX_BYTES, load_json_mapping
from move_base_abstract.common.shown import shown, shown_text

from .. import records
from . import design, endings

if TYPE_CHECKING:
    from .design import Configuration, Factor, Metric

FORMAT = 1
COMPLETE, FAILED, MISSING = 'complete', 'failed', 'not run'
SAFE_ID = re.compile(r'[A-Za-z0-9_][A-Za-z0-9._-]{0,199}')
LARGEST_INT = 10**18  # whole numbers must be smaller, so that a column of 64-bit integers can hold them
LARGEST = 1e100  # the largest value of a metric; larger ones cannot have been measured
_STATES = ('identical', 'different')


@dataclass(frozen=True)
class Trial:
    """One planned trial and its outcome, durations in s. Only a complete trial has metrics, durations and robots."""

    id: str
    configuration: int  # its place in Experiment.configurations
    replication: int
    seed: Optional[int]
    status: str  # COMPLETE, FAILED or MISSING
    error: str = ''  # a complete trial can have one too, for example of its metrics
    metrics: Dict[str, float] = field(default_factory=dict)  # NaN where the trial has none
    simulated_seconds: float = math.nan
    wall_seconds: float = math.nan
    times_real_time: float = math.nan
    repeatable: Optional[bool] = None  # None: not recorded
    labels: Tuple[str, ...] = ()
    verified: Optional[str] = None  # 'identical', 'different', or None: not run again
    difference: str = ''
    robots: Dict[str, Dict[str, float]] = field(default_factory=dict)  # by name and quantity
    waits: Dict[str, float] = field(default_factory=dict)  # [s] of all robots together, by place, zone or lane
    attempts: int = 1
    ended_by: str = ''  # see endings; '': not recorded
    kept: str = ''  # the trial's program, if it is not the present one and the trial was kept nevertheless
    open_goals: Optional[int] = None  # the number of goals that had not ended at the trial's end; None: not recorded
    properties: Any = None  # the 'properties' of trial.json, unchecked; sections.properties reads them


@dataclass(frozen=True)
class Experiment:
    """An experiment, as read from its folder."""

    folder: Path
    plan: Dict[str, Any]
    factors: Tuple[Factor, ...]
    configurations: Tuple[Configuration, ...]
    metrics: Tuple[Metric, ...]
    trials: Tuple[Trial, ...]  # in the order of the plan
    replays: Set[str] = field(default_factory=set)  # the IDs of the trials whose replay this report has written
    known: Dict[Any, Any] = field(default_factory=dict, compare=False)  # a cache of tables

    @property
    def name(self) -> str:
        """The name that the user gave the experiment."""
        return str(self.plan.get('experiment') or 'experiment')

    @property
    def complete(self) -> List[Trial]:
        """The complete Trials."""
        return [trial for trial in self.trials if trial.status == COMPLETE]

    def trials_of(self, configuration: Configuration) -> List[Trial]:
        """Return the Trials of a Configuration in the order of the plan."""
        if 'by configuration' not in self.known:
            found = self.known['by configuration'] = [[] for _ in self.configurations]
            for trial in self.trials:
                found[trial.configuration].append(trial)
        return self.known['by configuration'][configuration.place]

    @property
    def outcomes(self) -> Tuple[Metric, ...]:
        """Those of design.FAILED_TRIALS and LIMITED_TRIALS that occur; not the latter if all end so by design."""
        has_failed = any(trial.status == FAILED for trial in self.trials)
        return (design.FAILED_TRIALS,) * has_failed + (design.LIMITED_TRIALS,) * endings.has_limited(self)

    def values(self, metric: Metric) -> np.ndarray:
        """Return the values of a Metric, shape (configurations, replications).

        NaN stands for a trial that failed, has not run or has no value. Columns are replications in ascending order;
        the trials of one column have the same seed and the same program.
        """
        of = {'failed': lambda trial: float(trial.status == FAILED), 'limit': lambda trial: (
            float(trial.ended_by == endings.LIMIT) if trial.status == COMPLETE else math.nan)}
        return self._table(('values', metric.name, metric.outcome), of.get(metric.outcome, lambda trial: (
            trial.metrics.get(metric.name, math.nan))), math.nan)

    def cut(self, metric: Metric) -> np.ndarray:
        """Return which of values() the limit of time cut off, so that they are at best bounds: booleans, same shape."""
        return self._table(('cut', metric.name, metric.outcome),
                           lambda trial: endings.is_cut(self, metric, trial), 0.0) > 0.0

    def count(self, status: str) -> np.ndarray:
        """Return the number of trials with this status, per configuration."""
        return np.nansum(self._table(('count', status), lambda trial: float(trial.status == status), 0.0), axis=1)

    def _table(self, key: Tuple[str, ...], value_of: Callable[[Trial], float], nothing: float) -> np.ndarray:
        if key not in self.known:
            keys = sorted({(each.kept, each.replication) for each in self.trials})
            columns = {one: place for place, one in enumerate(keys)}
            self.known[key] = table = np.full((len(self.configurations), len(columns)), nothing)
            for trial in self.trials:
                if trial.status != MISSING:
                    table[trial.configuration, columns[trial.kept, trial.replication]] = value_of(trial)
        return self.known[key]


def read(folder: Path) -> Experiment:
    """Return the Experiment of a folder.

    A trial whose file cannot be understood counts as failed, and its error says why.

    :raises ConfigurationError: if there is no plan, or it cannot be understood.
    """
    folder = Path(folder)
    plan = _json(folder / 'plan.json', records.MAX_PLAN_BYTES)
    _check_plan(plan, folder / 'plan.json')
    planned = plan['trials']
    factors = design.factors_of(plan)
    configurations, places = design.configurations_of(factors, planned)
    rows = {} if (folder / 'trials').is_dir() else _rows_of_csv(folder / 'trials.csv', plan.get('metrics', {}))
    _share(planned, places)
    trials = tuple(_trial(folder, plan, each, places[place], rows) for place, each in enumerate(planned))
    return Experiment(folder, plan, factors, configurations, design.metrics_of(plan, trials), trials)


def _share(planned: Sequence[Dict[str, Any]], places: Sequence[int]) -> None:
    """Let the trials of a plan share equal configurations and programs, to save memory.

    :param places: the place of each trial's configuration.
    """
    known: Dict[Any, Any] = {}
    for each, place in zip(planned, places):
        for key in ('configuration', 'program'):
            if key in each:
                each[key] = known.setdefault((key, place if key == 'configuration' else str(each[key])), each[key])


def _json(path: Path, most: int = MAX_BYTES) -> Dict[str, Any]:
    """Return the mapping that a JSON file holds. :raises ConfigurationError: naming the file and what is wrong."""
    try:
        return load_json_mapping(path, most)
    except FileNotFoundError:
        raise ConfigurationError(f'{path}: is not there; the folder must be one that `experiment run` made') from None


def _check_plan(plan: Dict[str, Any], path: Path) -> None:
    if plan.get('format') != FORMAT:
        raise ConfigurationError(f"{path}: 'format' must be {FORMAT}, got {shown(plan.get('format'))}")
    for key, kind, name in (('trials', list, 'list'), ('factors', dict, 'mapping'), ('metrics', dict, 'mapping')):
        if not isinstance(plan.get(key, kind()), kind):
            raise ConfigurationError(f"{path}: '{key}' must be a {name}, got {shown(plan[key])}")
    for key in ('baseline', 'smallest_difference', 'at_limit'):
        if not isinstance(plan.get(key) or {}, dict):
            raise ConfigurationError(f"{path}: '{key}' must be a mapping, got {shown(plan[key])}")
    for name, least in (plan.get('smallest_difference') or {}).items():
        if isinstance(least, bool) or not isinstance(least, (int, float)) or not 0.0 < least <= LARGEST:
            raise ConfigurationError(f'{path}: smallest_difference[{shown(name)}] must be a number above 0, got '
                                     f'{shown(least)}')
    for name, levels in plan.get('factors', {}).items():
        if not isinstance(levels, list):
            raise ConfigurationError(f'{path}: factors[{shown(name)}] must be a list, got {shown(levels)}')
    plan.setdefault('trials', [])
    seen: Set[Any] = set()
    for place, trial in enumerate(plan['trials']):
        where = f'{path}: trials[{place}]'
        if not isinstance(trial, dict) or not isinstance(trial.get('configuration', {}), dict):
            raise ConfigurationError(f"{where}: must be a mapping with a mapping 'configuration', got {shown(trial)}")
        if not isinstance(trial.get('id'), str) or not SAFE_ID.fullmatch(trial['id']):
            raise ConfigurationError(f"{where}: 'id' must be letters, digits, '.', '_' and '-', got "
                                     f"{shown(trial.get('id'))}")
        for key in ('replication', 'seed') if 'seed' in trial else ('replication',):
            number = trial.get(key)
            if isinstance(number, bool) or not isinstance(number, int) or abs(number) >= LARGEST_INT:
                raise ConfigurationError(f"{where}: '{key}' must be a whole number within +-{LARGEST_INT}, got "
                                         f"{shown(number)}")
        same = json.dumps(trial.get('configuration', {}), sort_keys=True), trial['replication']
        if trial['id'] in seen or same in seen:
            raise ConfigurationError(f"{where}: is planned twice: {shown(trial['id'])}")
        seen.update((trial['id'], same))


def _rows_of_csv(path: Path, metrics: Mapping[str, Dict[str, str]]) -> Dict[str, Dict[str, Any]]:
    """Return the rows of trials.csv by ID, in the form of trial.json; for a folder that came without its trials."""
    if not path.is_file():
        return {}
    with open_csv(path) as stream:
        return {row['id']: _of_row(row, metrics) for row in csv.DictReader(stream) if row.get('id')}


def _of_row(row: Mapping[str, str],
            metrics: Mapping[str, Dict[str, str]]) -> Dict[str, Any]:
    known = {key: value for key, value in row.items() if isinstance(key, str) and value not in ('', None)}
    labels = known.pop('labels', '')
    told: Dict[str, Any] = {**known, 'metrics': {key: _number(known.get(key)) for key in metrics},
            'labels': [labels] if labels else []}
    if 'repeatable' in told:
        told['repeatable'] = told['repeatable'].lower() in ('true', '1', 'yes')
    return told


def _trial(folder: Path, plan: Mapping[str, Any], planned: Mapping[str, Any],
           configuration: int, rows: Mapping[str, Dict[str, Any]]) -> Trial:
    """Return the Trial of an entry of the plan."""
    base: Dict[str, Any] = dict(id=planned['id'], configuration=configuration, replication=planned['replication'],
                seed=planned.get('seed'), kept=str(planned.get('program')) if planned.get('kept') else '')
    path = folder / 'trials' / planned['id'] / 'trial.json'
    try:
        if path.is_file():
            told = _json(path)
            if None not in (planned.get('made_of'), told.get('made_of')) and planned['made_of'] != told['made_of']:
                return Trial(**base, status=MISSING)  # it is of another program and has to run again
            _check_same(told, planned, path)
        elif planned['id'] in rows:
            told = rows[planned['id']]
        else:
            return Trial(**base, status=MISSING)
        labels = [*told['labels'], planned['kept']] if planned.get('kept') and isinstance(
            told.get('labels'), list) else told.get('labels')
        return _told(base, {**told, 'labels': labels}, plan.get('until'))
    except ConfigurationError as error:
        return Trial(**base, status=FAILED, error=str(error))


def _check_same(told: Mapping[str, Any], planned: Mapping[str, Any],
                path: Path) -> None:
    for key in ('configuration', 'replication', 'seed'):
        if key in told and told[key] != planned.get(key):
            raise ConfigurationError(f"{path}: is of another plan: its '{key}' is {shown(told[key])}, but the plan has "
                                     f'{shown(planned.get(key))}')


def _told(base: Mapping[str, Any], told: Mapping[str, Any], until: Optional[Mapping[str, int]]) -> Trial:
    """Return the Trial of a trial.json (a mapping). Any part of it may be missing or wrong."""
    status = told.get('status')
    lines = str(told.get('error') or '').strip().splitlines()
    error = lines[0][:1000] if lines else ''
    if status != COMPLETE:
        error = error or ('no reason was recorded' if status == FAILED else f'its status is {shown(status)}')
        return Trial(**base, status=FAILED, error=error, attempts=_count(told.get('attempts')),
                     ended_by=endings.ended_by(told.get('ended_by'), None, math.nan),
                     properties=told.get('properties'))
    robots: Any = told.get('robots') if isinstance(told.get('robots'), dict) else {}
    waits: Any = told.get('waits') if isinstance(told.get('waits'), dict) else {}
    labels: Any = told.get('labels') if isinstance(told.get('labels'), list) else []
    metrics: Any = told.get('metrics') if isinstance(told.get('metrics'), dict) else {}
    return Trial(
        **base, status=COMPLETE, error=error, metrics={str(name): _number(value) for name, value in metrics.items()},
        **{name: _number(told.get(name))  # type: ignore[arg-type]
           for name in ('simulated_seconds', 'wall_seconds', 'times_real_time')},
        repeatable=told.get('repeatable') if isinstance(told.get('repeatable'), bool) else None,
        labels=tuple(sys.intern(str(label)) for label in labels),
        verified=told.get('verified') if told.get('verified') in _STATES else None,
        difference=shown_text(told.get('difference') or ''),
        robots={str(name): {str(key): _number(value) for key, value in each.items()}
                for name, each in robots.items() if isinstance(each, dict)},
        waits={str(where): value for where, value in ((where, _number(told)) for where, told in waits.items())
               if value >= 0.0},
        attempts=_count(told.get('attempts')), open_goals=_whole(told.get('open_goals')),
        properties=told.get('properties'),
        ended_by=endings.ended_by(told.get('ended_by'), until, _number(told.get('simulated_seconds'))))


def _number(value: Any) -> float:
    """Return a value as a float that can be squared, or NaN for anything else in a file: null, text, infinity."""
    try:
        number = float(value) if isinstance(value, (int, float, str)) else math.nan
    except (ValueError, OverflowError):
        return math.nan
    return number if abs(number) <= LARGEST else math.nan


def _count(value: Any) -> int:
    return _whole(value) or 1


def _whole(value: Any) -> Optional[int]:
    """Return the value if it is a whole number of at least 0, otherwise None."""
    return value if isinstance(value, int) and not isinstance(value, bool) and value >= 0 else None
