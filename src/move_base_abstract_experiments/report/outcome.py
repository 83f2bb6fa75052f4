"""Read an experiment's folder: its plan, and the outcome of each planned trial."""
from __future__ import annotations

import csv
import json
import math
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Set, Tuple

import numpy as np

from move_base_abstract.common.csv_files import open_csv
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown, shown_text

from .. import records
from . import design, endings

if TYPE_CHECKING:
    from .design import Configuration, Factor, Metric

COMPLETE, FAILED, MISSING = records.COMPLETE, records.FAILED, 'not run'
LARGEST_INT = 10**18  # whole numbers must be smaller, so that a column of 64-bit integers can hold them
LARGEST = 1e100  # the largest value of a metric; larger ones cannot have been measured
_SECONDS = ('simulated_seconds', 'wall_seconds', 'times_real_time')


@dataclass(frozen=True)
class Trial:
    """One planned trial and its outcome, durations in s. Only a complete trial has metrics, durations and robots."""

    id: str
    configuration: int  # its place in Experiment.configurations
    replication: int
    seed: int
    status: str  # COMPLETE, FAILED or MISSING
    error: str = ''  # a complete trial can have one too, for example of its metrics
    metrics: Dict[str, float] = field(default_factory=dict)  # NaN where the trial has none
    simulated_seconds: float = math.nan
    wall_seconds: float = math.nan
    times_real_time: float = math.nan
    repeatable: bool = False
    labels: Tuple[str, ...] = ()
    verified: Optional[str] = None  # 'identical', 'different', or None: not run again
    difference: str = ''
    robots: Dict[str, Dict[str, float]] = field(default_factory=dict)  # by name and quantity
    waits: Dict[str, float] = field(default_factory=dict)  # [s] of all robots together, by place, zone or lane
    attempts: int = 1
    ended_by: str = ''  # see endings; '': not recorded
    kept: str = ''  # the trial's program, if it is not the present one and the trial was kept nevertheless
    open_goals: Optional[int] = None  # the number of goals that had not ended at the trial's end; None: not recorded
    error_lines: Tuple[Tuple[str, str], ...] = ()  # (participant, the first ERROR or FATAL line)
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
    plan = records.read_plan(str(folder))
    _check_plan(plan, folder / 'plan.json')
    told = {**vars(plan), 'trials': [vars(one) for one in plan.trials]}
    factors = design.factors_of(told)
    configurations, places = design.configurations_of(factors, told['trials'])
    rows = {} if (folder / 'trials').is_dir() else _rows_of_csv(folder / 'trials.csv', plan)
    known: Dict[Any, Any] = {}
    for one, place in zip(plan.trials, places):  # equal configurations and programs share one object, to save memory
        one.configuration = known.setdefault(place, one.configuration)
        one.program = known.setdefault(one.program, one.program)
    trials = tuple(_trial(folder, plan, one, place, rows) for one, place in zip(plan.trials, places))
    return Experiment(folder, told, factors, configurations, design.metrics_of(told, trials), trials)


def _check_plan(plan: records.Plan, path: Path) -> None:
    """Check of a plan what only a report needs."""
    for name, least in (plan.smallest_difference or {}).items():
        if isinstance(least, bool) or not isinstance(least, (int, float)) or not 0.0 < least <= LARGEST:
            raise ConfigurationError(f'{path}: smallest_difference[{shown(name)}] must be a number above 0, got '
                                     f'{shown(least)}')
    seen: Set[Any] = set()
    for place, trial in enumerate(plan.trials):
        where = f'{path}: trials[{place}]'
        if max(abs(trial.replication), abs(trial.seed)) >= LARGEST_INT:
            raise ConfigurationError(f'{where}: replication and seed must be within +-{LARGEST_INT}, got '
                                     f'{shown(trial.replication)} and {shown(trial.seed)}')
        same = json.dumps(trial.configuration, sort_keys=True), trial.replication
        if trial.id in seen or same in seen:
            raise ConfigurationError(f'{where}: is planned twice: {shown(trial.id)}')
        seen.update((trial.id, same))


def _rows_of_csv(path: Path, plan: records.Plan) -> Dict[str, records.Result]:
    """Return the rows of trials.csv by ID, as Results; for a folder that came without its trials."""
    if not path.is_file():
        return {}
    with open_csv(path) as stream:
        return {row['id']: _of_row(row, plan.metrics).judged_by(plan.primary)
                for row in csv.DictReader(stream) if row.get('id')}


def _of_row(row: Mapping[str, str], metrics: Iterable[str]) -> records.Result:
    told = {key: value for key, value in row.items() if isinstance(key, str) and value not in ('', None)}
    return records.Result(
        told['id'], status=told.get('status', ''), error=told.get('error'), ended_by=told.get('ended_by'),
        metrics={name: _number(told.get(name)) for name in metrics}, verified=told.get('verified'),
        labels=[told['labels']] if 'labels' in told else [],
        repeatable=told.get('repeatable', '').lower() in ('true', '1', 'yes'),
        **{name: _number(told.get(name)) for name in _SECONDS})  # type: ignore[arg-type]


def _trial(folder: Path, plan: records.Plan, planned: records.Planned, configuration: int,
           rows: Mapping[str, records.Result]) -> Trial:
    """Return the Trial of an entry of the plan."""
    base: Dict[str, Any] = dict(id=planned.id, configuration=configuration, replication=planned.replication,
                                seed=planned.seed, kept=str(planned.program) if planned.kept else '')
    try:
        told = rows.get(planned.id) or records.read_planned(str(folder), plan, planned)
    except ConfigurationError as error:
        return Trial(**base, status=FAILED, error=str(error))
    return _told(base, told) if told else Trial(**base, status=MISSING)


def _told(base: Dict[str, Any], told: records.Result) -> Trial:
    """Return the Trial of a Result."""
    base.update(attempts=told.attempts, properties=told.properties)
    base['error_lines'] = tuple((sys.intern(shown_text(str(one.get('node')))), sys.intern(shown_text(str(
        one.get('first'))))) for one in told.error_lines if isinstance(one, dict))
    base['ended_by'] = sys.intern(shown_text(told.ended_by or ''))
    error = next(iter((told.error or '').strip().splitlines()), '')[:1000]
    if not told.is_complete:
        error = error or ('no reason was recorded' if told.status == FAILED else f'its status is {shown(told.status)}')
        return Trial(**base, status=FAILED, error=error)
    return Trial(
        **base, status=COMPLETE, error=error, repeatable=told.repeatable,
        **{name: _number(getattr(told, name)) for name in _SECONDS},  # type: ignore[arg-type]
        metrics={name: _number(value) for name, value in told.metrics.items()},
        labels=tuple(sys.intern(label) for label in told.labels), open_goals=told.open_goals,
        verified=told.verified if told.verified in (records.IDENTICAL, records.DIFFERENT) else None,
        difference=shown_text(told.difference or ''),
        robots={name: {key: _number(value) for key, value in each.items()}
                for name, each in told.robots.items() if isinstance(each, dict)},
        waits={where: _number(value) for where, value in told.waits.items() if _number(value) >= 0.0})


def _number(value: Any) -> float:
    """Return a value as a float that can be squared, or NaN for anything else in a file: null, text, infinity."""
    try:
        number = float(value) if isinstance(value, (int, float, str)) else math.nan
    except (ValueError, OverflowError):
        return math.nan
    return number if abs(number) <= LARGEST else math.nan
