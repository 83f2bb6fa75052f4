"""The tidy table of an experiment: one row per trial in the plan's order, as CSV, and as Parquet if pyarrow is there.

Only the columns `wall_seconds` and `times_real_time` depend on the machine. All others are the same to the byte
whenever and wherever the trials ran.
"""
from __future__ import annotations

import csv
import importlib.util
import io
import json
import sys
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, List, Optional, Sequence

from move_base_abstract.common.shown import shown_text
from move_base_abstract.properties import Gathering
from move_base_abstract.runs.built_in import SOMETIMES
from move_base_abstract.runs.metrics import METRICS, Metric

from ..records import DIFFERENT, FORMAT, IDENTICAL, Plan, Result
from . import outputs

BEFORE = ('replication', 'seed', 'status')
AFTER = ('simulated_seconds', 'wall_seconds', 'times_real_time', 'repeatable', 'labels', 'events', 'log_sha256',
         'verified', 'ended_by', 'error')
WALL = ('wall_seconds', 'times_real_time')
MOST_TOLD = 5
_MOST_LOOKED = 100  # the number of trials among which one with metrics is looked for


class Errors:
    """The first few different errors of trials, each with the number of its trials. ``count``: of all such trials."""

    def __init__(self) -> None:
        self.count = 0
        self._counts: Dict[str, int] = {}

    def take(self, result: Result) -> bool:
        """Count a trial if it has an error; return whether the error is new, and among the first few."""
        self.count += bool(result.error)
        is_new = bool(result.error) and result.error not in self._counts and len(self._counts) < MOST_TOLD
        if result.error and (is_new or result.error in self._counts):
            self._counts[result.error] = self._counts.get(result.error, 0) + 1
        return is_new

    def lines(self, trials: int) -> List[str]:
        """Return a line for each error. ``trials``: the number of all trials that were looked at."""
        return [f'{shown_text(error)} in {count} of {trials} trials' for error, count in self._counts.items()]


class Summary:
    """A summary of an experiment's trials in a few numbers."""

    def __init__(self) -> None:
        self.complete = self.missing = self.identical = 0
        self.failed: List[Result] = []  # the first MOST_TOLD of each
        self.different: List[Result] = []
        self.failed_count = self.different_count = 0
        self.errors = Errors()  # of complete trials
        self.properties = Gathering()

    def take(self, result: Optional[Result]) -> None:
        """Add the Result of a trial; None: it has not run."""
        if result is None:
            self.missing += 1
            return
        self.complete += result.is_complete
        if result.properties:
            self.properties.take(result.id, result.seed, result.properties)
        self.identical += result.verified == IDENTICAL
        if result.is_complete:
            self.errors.take(result)
        else:
            self.failed_count += 1
            self.failed += [result] if self.failed_count <= MOST_TOLD else []
        if result.verified == DIFFERENT:
            self.different_count += 1
            self.different += [result] if self.different_count <= MOST_TOLD else []


def columns(plan: Plan, metrics: Iterable[str]) -> List[str]:
    """Return the names of the table's columns, in their order."""
    return ['id', *plan.factors, *BEFORE, *metrics, *AFTER]


def _row(plan: Plan, metrics: Iterable[str], result: Result) -> List[Any]:
    # A factor may have the name of a key of trial.json that is no column, such as robots.
    values = {**vars(result), **{name: result.metrics.get(name) for name in metrics}, **result.configuration,
              'labels': '; '.join(result.labels)}
    return [values.get(name) for name in columns(plan, metrics)]


class _Rows:
    """Reads the ended trials of a plan one by one; afterwards ``summary`` and ``metrics`` are complete."""

    def __init__(self, plan: Plan, path: Path, metrics: List[str]) -> None:
        self._plan = plan
        self._path = path
        self._known = list(metrics)
        self.metrics = set(metrics)
        self.summary = Summary()

    def pieces(self, kept: Optional[List[List[Any]]]) -> Iterator[bytes]:
        """Yield the table as CSV, with the metrics that were given. The rows are added to the list ``kept``, too.

        If a trial has a metric that was not given, no more rows follow, because the table is made again with it.
        """
        yield csv_text([columns(self._plan, self._known)])
        for one in self._plan.trials:
            result = outputs.read_planned(self._path, self._plan, one)
            self.summary.take(result)
            if result is not None:
                self.metrics.update(result.metrics)
                if len(self.metrics) == len(self._known):
                    row = _row(self._plan, self._known, result)
                    if kept is not None:
                        kept.append(row)
                    yield csv_text([row])


def csv_text(table: Iterable[Sequence[Any]]) -> bytes:
    """Return rows as CSV (bytes): numbers in the shortest form that reads back the same, None as an empty cell."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator='\n').writerows([[_cell(value) for value in row] for row in table])
    return stream.getvalue().encode()


def _cell(value: Any) -> str:
    if value is None:
        return ''
    return json.dumps(value) if isinstance(value, (bool, int, float)) else str(value)


def write(folder: outputs.OutputFolder, plan: Plan) -> Summary:
    """Write trials.csv of an OutputFolder, and trials.parquet if possible; add metrics to plan.json; return a Summary.

    There may be a million trials, so only one is in memory at a time (except for Parquet, which needs all). If the plan
    does not name a metric, the trials are read a second time.
    """
    named = list(plan.metrics)
    metrics = _first_metrics(folder, plan)
    while True:
        rows = _Rows(plan, folder.path, metrics)
        table: Optional[List[List[Any]]] = [] if _has_parquet() else None
        folder.write_pieces('trials.csv', rows.pieces(table))
        if len(rows.metrics) == len(metrics):
            break
        metrics = named + sorted(rows.metrics - set(named))
    for name in metrics:
        plan.metrics.setdefault(name, METRICS.get(name, Metric(name)).described())
    folder.write_pieces('plan.json', plan_text(plan))
    if rows.summary.properties.runs:
        folder.write('properties.csv', _properties(rows.summary.properties))
    if table is not None:
        _write_parquet(folder, columns(plan, metrics), table)
    return rows.summary


def _properties(told: Gathering) -> bytes:
    """Return properties.csv: a row for each property that some trial broke, and each `sometimes` that never held."""
    names = ('property', 'node', 'text', 'runs', 'first_run', 'first_seed', 'first_instant_ns')
    return csv_text([names, *([row[name] for name in names] for row in told.rows),
                     *((SOMETIMES, node, text, told.runs, '', None, None) for node, text in told.never_held())])


def _first_metrics(folder: outputs.OutputFolder, plan: Plan) -> List[str]:
    """Return the names of the metrics: those of the plan, then, sorted, others of the first trial that has any."""
    named = list(plan.metrics)
    for one in plan.trials[:_MOST_LOOKED]:
        result = outputs.read_planned(folder.path, plan, one)
        if result is not None and result.metrics:
            return named + sorted(set(result.metrics) - set(named))
    return named


def plan_text(plan: Plan) -> Iterator[bytes]:
    """Yield plan.json in pieces, since with a million trials it has half a gigabyte. Each trial has a line."""
    yield b'{\n "format": %d' % FORMAT
    for key, value in vars(plan).items():
        yield f',\n {json.dumps(key)}: '.encode()
        if value and value is plan.trials:
            for place, one in enumerate(plan.trials):
                yield f'{"," if place else "["}\n  {json.dumps(one.written, allow_nan=False)}'.encode()
            yield b'\n ]'
        else:
            yield json.dumps(value, indent=1, allow_nan=False).replace('\n', '\n ').encode()
    yield b'\n}\n'


def _has_parquet() -> bool:
    return all(importlib.util.find_spec(name) for name in ('pandas', 'pyarrow'))


def _write_parquet(folder: outputs.OutputFolder, names: List[str], table: List[List[Any]]) -> None:
    stream = io.BytesIO()
    try:
        import pandas
        pandas.DataFrame(table, columns=names).to_parquet(stream, engine='pyarrow', index=False)
    except Exception as problem:  # pyarrow does not fit numpy, or a factor has texts and numbers; the CSV is there
        lines = str(problem).strip().splitlines()
        print(f'experiment: no trials.parquet: {type(problem).__name__}: {lines[0] if lines else ""}', file=sys.stderr)
    else:
        folder.write('trials.parquet', stream.getvalue())
