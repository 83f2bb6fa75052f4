"""The tidy table of an experiment: one row per trial in the plan's order, as CSV, and Parquet where pyarrow is there.

What depends on the machine stands in `wall_seconds` and `times_real_time`; all else is the same to the byte whenever
and wherever the trials ran.
"""
import csv
import importlib.util
import io
import json
import sys

from ..description.metric_names import OCCASIONAL, Metric
from ..trials.trial import COMPLETE, DIFFERENT, IDENTICAL
from . import outputs

BEFORE = ('replication', 'seed', 'status')
AFTER = ('simulated_seconds', 'wall_seconds', 'times_real_time', 'repeatable', 'labels', 'events', 'log_sha256',
         'verified', 'ended_by', 'error')
WALL = ('wall_seconds', 'times_real_time')
MOST_TOLD = 5
_MOST_LOOKED = 100  # trials, for one with metrics


class Told:
    """What there is to say of an experiment's trials in a few lines, besides the table."""

    def __init__(self):
        self.complete = self.missing = self.identical = 0
        self.failed, self.different = [], []  # trial.json of the first MOST_TOLD of each
        self.failed_count = self.different_count = 0

    def take(self, about):
        """Take trial.json of a trial; None: it has not run."""
        if about is None:
            self.missing += 1
            return
        self.complete += about['status'] == COMPLETE
        self.identical += about['verified'] == IDENTICAL
        if about['status'] != COMPLETE:
            self.failed_count += 1
            self.failed += [about] if self.failed_count <= MOST_TOLD else []
        if about['verified'] == DIFFERENT:
            self.different_count += 1
            self.different += [about] if self.different_count <= MOST_TOLD else []


def columns(plan, metrics):
    """Return the names of the columns."""
    return ['id', *plan['factors'], *BEFORE, *metrics, *AFTER]


def _row(plan, metrics, about):
    # A factor may have the name of a key of trial.json that is no column, such as robots.
    values = {**about, **{name: about['metrics'].get(name) for name in metrics}, **about['configuration']}
    values['labels'] = '; '.join(about['labels'])
    return [values.get(name) for name in columns(plan, metrics)]


class _Rows:
    """Reads the trials of a plan that have ended, one after another; ``told`` and ``metrics`` are known at the end."""

    def __init__(self, plan, path, metrics):
        self._plan = plan
        self._path = path
        self._known = list(metrics)
        self.metrics = set(metrics)
        self.told = Told()

    def pieces(self, kept):
        """Yield the table as CSV (bytes), by the metrics that were given; rows are added to the list ``kept``, too.

        Once a metric shows that was not given, there is nothing more to yield: it is wanted with that one.
        """
        yield csv_text([columns(self._plan, self._known)])
        for one in self._plan['trials']:
            about = outputs.read_planned(self._path, one)
            self.told.take(about)
            if about is not None:
                self.metrics.update(about['metrics'])
                if len(self.metrics) == len(self._known):
                    row = _row(self._plan, self._known, about)
                    if kept is not None:
                        kept.append(row)
                    yield csv_text([row])


def csv_text(table):
    """Return rows as CSV (bytes): numbers in the shortest form that reads back the same; nothing for null."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator='\n').writerows([[_cell(value) for value in row] for row in table])
    return stream.getvalue().encode()


def _cell(value):
    if value is None:
        return ''
    return json.dumps(value) if isinstance(value, (bool, int, float)) else str(value)


def write(folder, plan):
    """Write trials.csv of an OutputFolder, and trials.parquet where that can be; add metrics to plan.json.

    Return a Told. Of a million trials one is in memory at a time (but for Parquet, which needs all): metrics that the
    plan does not name cost a second look.
    """
    named = list(plan['metrics'])
    metrics = _first_metrics(folder, plan)
    while True:
        rows = _Rows(plan, folder.path, metrics)
        table = [] if _has_parquet() else None
        folder.write_pieces('trials.csv', rows.pieces(table))
        if len(rows.metrics) == len(metrics):
            break
        metrics = named + sorted(rows.metrics - set(named))
    for name in metrics:
        plan['metrics'].setdefault(name, OCCASIONAL.get(name, Metric(name)).described())
    folder.write_pieces('plan.json', plan_text(plan))
    if table is not None:
        _write_parquet(folder, columns(plan, metrics), table)
    return rows.told


def _first_metrics(folder, plan):
    """Return the names of the metrics: those of the plan, then by name what else the first complete trial has."""
    named = list(plan['metrics'])
    for one in plan['trials'][:_MOST_LOOKED]:
        about = outputs.read_planned(folder.path, one)
        if about is not None and about['metrics']:
            return named + sorted(set(about['metrics']) - set(named))
    return named


def plan_text(plan):
    """Yield plan.json in pieces (bytes): of a million trials it is half a gigabyte. Each trial has a line."""
    for number, (key, value) in enumerate(plan.items()):
        yield f'{"," if number else "{"}\n {json.dumps(key)}: '.encode()
        if key == 'trials' and value:
            for place, one in enumerate(value):
                yield f'{"," if place else "["}\n  {json.dumps(one, allow_nan=False)}'.encode()
            yield b'\n ]'
        else:
            yield json.dumps(value, indent=1, allow_nan=False).replace('\n', '\n ').encode()
    yield b'\n}\n'


def _has_parquet():
    return all(importlib.util.find_spec(name) for name in ('pandas', 'pyarrow'))


def _write_parquet(folder, names, table):
    stream = io.BytesIO()
    try:
        import pandas
        pandas.DataFrame(table, columns=names).to_parquet(stream, engine='pyarrow', index=False)
    except Exception as problem:  # a pyarrow that does not fit numpy, a factor of texts and numbers; the CSV is there
        lines = str(problem).strip().splitlines()
        print(f'experiment: no trials.parquet: {type(problem).__name__}: {lines[0] if lines else ""}', file=sys.stderr)
    else:
        folder.write('trials.parquet', stream.getvalue())
