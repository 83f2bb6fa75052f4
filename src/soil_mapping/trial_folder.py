"""The folder that a trial leaves, complete or marked as unfinished.

    NAME.unfinished/       while the trial runs, and for ever if it died: it says so itself and is begun again
    NAME/                  a complete trial; the name appears in one step, when all files are on the disk
        trial.json         format, config, seed, engine, metrics, simulated_s, speed_up, wall_s (per phase), versions,
                           machine, events_sha256
        events.csv         time_ns, robot, event, task, x_m, y_m, value       (mission_log.Event)
        samples.csv        time_ns, robot, task, x_m, y_m, value_kpa          (mission_log.Sample)
        metrics.csv        the map after each sample                          (mission_log.Moment)
        trajectories.csv   time_ns, robot, x_m, y_m                           (mission_log.Waypoint)
        truth.npy prediction.npy variance.npy     float64, (rows from the south, columns), kPa and kPa^2
        truth.png prediction.png variance.png trajectories.png     with pictures=True only

An engine may put further files (a rosbag, logs) into TrialFolder.path before it is finished. Numbers in CSV files are
written so that reading gives the same bits. Times are simulated ns since the start of the mission, so that the event
logs of two runs can be compared as they are.
"""

import contextlib
import csv
import hashlib
import json
import math
import os
import shutil
from pathlib import Path

import numpy as np

from .mission_log import Event, Moment, Sample, Waypoint
from .provenance import machine, versions
from .result import Metrics, TrialResult

FORMAT = 1
UNFINISHED = '.unfinished'
ARRAYS = ('truth', 'prediction', 'variance')
TABLES = (
    ('events', 'events.csv', Event, Event._fields),
    ('samples', 'samples.csv', Sample, ('time_ns', 'robot', 'task', 'x_m', 'y_m', 'value_kpa')),
    ('history', 'metrics.csv', Moment, Moment._fields),
    ('waypoints', 'trajectories.csv', Waypoint, ('time_ns', 'robot', 'x_m', 'y_m')),
)


def is_complete(path):
    """Return whether the folder holds a complete trial. Whatever else is there is not one."""
    return (Path(path) / 'trial.json').is_file()


class TrialFolder:
    """The folder of one trial that is about to run; a context manager.

    Entering removes what an earlier try left and makes NAME.unfinished. finish() turns it into NAME. Leaving without
    finish() leaves NAME.unfinished, for whoever wants to see how far it came. A complete NAME is replaced only by a
    complete one.
    """

    def __init__(self, path):
        self.final_path = Path(path)
        self.path = self.final_path.with_name(self.final_path.name + UNFINISHED)

    def __enter__(self):
        self.final_path.parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(self.path, ignore_errors=True)
        self.path.mkdir()
        return self

    def __exit__(self, *problem):
        return False

    def finish(self, result, pictures=False):
        """Write all files of a TrialResult, see that they are on the disk, and give the folder its final name."""
        digest = _write_tables(self.path, result)
        for name in ARRAYS:
            with _whole_file(self.path / f'{name}.npy', 'wb') as stream:
                np.save(stream, np.asarray(getattr(result, name), dtype=np.float64), allow_pickle=False)
        if pictures:
            from .pictures import write_pictures  # matplotlib takes a second to import
            write_pictures(self.path, result)
        with _whole_file(self.path / 'trial.json', 'w', encoding='utf-8') as stream:
            json.dump(_plain(describe(result, digest)), stream, indent=1, allow_nan=False)
        _sync_folder(self.path)
        _swap(self.path, self.final_path)
        return self.final_path


def describe(result, events_sha256):
    """Return what trial.json says of a TrialResult."""
    return {
        'format': FORMAT, 'config': result.config, 'seed': result.seed, 'engine': result.engine,
        'metrics': result.metrics._asdict(), 'simulated_s': result.simulated_s, 'speed_up': result.speed_up,
        'wall_s': result.wall_s, 'moving_wall_s': result.moving_wall_s, 'cell_m': result.cell_m,
        'field': result.about_field, 'own_code': result.own_code, 'events_sha256': events_sha256,
        'versions': versions(), 'machine': machine(),
    }


def read_trial(path):
    """Return the TrialResult of a complete folder. :raises ValueError: if it is not complete, or of another format."""
    path = Path(path)
    if not is_complete(path):
        raise ValueError(f'{path}: not a complete trial (no trial.json)')
    about = read_about(path)
    tables = {name: _read_table(path / file, record) for name, file, record, _ in TABLES}
    arrays = {name: np.load(path / f'{name}.npy', allow_pickle=False) for name in ARRAYS}
    metrics = Metrics(**{name: math.nan if value is None else value for name, value in about['metrics'].items()})
    moving = about['moving_wall_s']
    return TrialResult(config=about['config'], seed=about['seed'], engine=about['engine'], metrics=metrics,
                       simulated_s=about['simulated_s'], cell_m=about['cell_m'],
                       about_field=about.get('field', {}), own_code=about.get('own_code', {}), wall_s=about['wall_s'],
                       moving_wall_s=math.nan if moving is None else moving, **tables, **arrays)


def read_about(path):
    """Return trial.json of a complete folder as a mapping; NaN is None there."""
    file = Path(path) / 'trial.json'
    with open(file, encoding='utf-8') as stream:
        about = json.load(stream)
    if about.get('format') != FORMAT:
        raise ValueError(f'{file}: format {about.get("format")!r} is unknown; this program reads {FORMAT}')
    return about


def events_text(events):
    """Return the event log as it is written: two runs are the same if these texts are."""
    return _csv_text(Event._fields, events)


def _write_tables(folder, result):
    """Write the tables; return the SHA-256 of events.csv."""
    for name, file, _, header in TABLES:
        with _whole_file(folder / file, 'w', encoding='utf-8', newline='') as stream:
            stream.write(_csv_text(header, getattr(result, name)))
    return hashlib.sha256(events_text(result.events).encode()).hexdigest()


def _csv_text(header, rows):
    lines = [','.join(header)]
    lines += [','.join('' if value != value else str(value) for value in row) for row in rows]  # NaN is empty
    return '\n'.join(lines) + '\n'


def _read_table(path, record):
    kinds = [record.__annotations__[name] for name in record._fields]
    with open(path, newline='', encoding='utf-8') as stream:
        rows = list(csv.reader(stream))[1:]
    return [record(*(math.nan if cell == '' else kind(cell) for kind, cell in zip(kinds, row, strict=True)))
            for row in rows]


def _plain(value):
    """Return a value as JSON has it: NaN and infinities are null."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.floating, np.integer)):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


@contextlib.contextmanager
def _whole_file(path, mode, **options):
    """Open a file that appears under its name only once it is complete and on the disk."""
    part = path.with_name(path.name + '.part')
    with open(part, mode, **options) as stream:
        yield stream
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(part, path)


def _sync_folder(path):
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _swap(unfinished, final):
    """Give the folder its final name. An older complete one is moved away first: a kill in between loses only that."""
    old = final.with_name(final.name + '.old')
    shutil.rmtree(old, ignore_errors=True)
    if final.exists():
        os.rename(final, old)
    os.rename(unfinished, final)
    _sync_folder(final.parent)
    shutil.rmtree(old, ignore_errors=True)
