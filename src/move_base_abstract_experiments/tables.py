"""The tidy table of an experiment: one row per trial in the plan's order, as CSV, and Parquet where pyarrow is there.

What depends on the machine stands in `wall_seconds` and `times_real_time`; all else is the same to the byte whenever
and wherever the trials ran.
"""
import csv
import importlib.util
import io
import json
import sys

from . import outputs

BEFORE = ('replication', 'seed', 'status')
AFTER = ('simulated_seconds', 'wall_seconds', 'times_real_time', 'repeatable', 'labels', 'events', 'log_sha256',
         'verified', 'ended_by', 'error')
WALL = ('wall_seconds', 'times_real_time')


def metric_names(plan, found):
    """Return the names of the metrics: those of the plan, then what else the trials have, by name."""
    named = list(plan['metrics'])
    return named + sorted({name for about in found for name in about['metrics']} - set(named))


def columns(plan, metrics):
    """Return the names of the columns."""
    return ['id', *plan['factors'], *BEFORE, *metrics, *AFTER]


def rows(plan, path):
    """Return (names of metrics, rows of a table) of those trials of a plan that have ended."""
    abouts = [outputs.read_planned(path, one) for one in plan['trials']]
    abouts = [about for about in abouts if about is not None]
    metrics = metric_names(plan, abouts)
    table = []
    for about in abouts:
        # A factor may have the name of a key of trial.json that is no column, such as robots.
        values = {**about, **{name: about['metrics'].get(name) for name in metrics}, **about['configuration']}
        values['labels'] = '; '.join(about['labels'])
        table.append([values.get(name) for name in columns(plan, metrics)])
    return metrics, table


def csv_text(names, table):
    """Return a table as CSV: numbers in the shortest form that reads back the same; nothing for null."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator='\n')
    writer.writerow(names)
    writer.writerows([[_cell(value) for value in row] for row in table])
    return stream.getvalue()


def _cell(value):
    if value is None:
        return ''
    return json.dumps(value) if isinstance(value, (bool, int, float)) else str(value)


def write(folder, plan):
    """Write trials.csv of an OutputFolder, and trials.parquet where that can be; add metrics to plan.json."""
    metrics, table = rows(plan, folder.path)
    names = columns(plan, metrics)
    folder.write('trials.csv', csv_text(names, table).encode())
    for name in metrics:
        plan['metrics'].setdefault(name, {'unit': '', 'title': name, 'better': None})
    folder.write_pieces('plan.json', plan_text(plan))
    _write_parquet(folder, names, table)


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


def _write_parquet(folder, names, table):
    if not all(importlib.util.find_spec(name) for name in ('pandas', 'pyarrow')):
        return
    stream = io.BytesIO()
    try:
        import pandas
        pandas.DataFrame(table, columns=names).to_parquet(stream, engine='pyarrow', index=False)
    except Exception as problem:  # a pyarrow that does not fit numpy, a factor of texts and numbers; the CSV is there
        lines = str(problem).strip().splitlines()
        print(f'experiment: no trials.parquet: {type(problem).__name__}: {lines[0] if lines else ""}', file=sys.stderr)
    else:
        folder.write('trials.parquet', stream.getvalue())
