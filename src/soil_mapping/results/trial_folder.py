"""The folder of a trial, complete or marked as unfinished.

    NAME.unfinished/       while the trial runs; if it dies, this folder stays, and the trial is begun again
    NAME/                  a complete trial; the name appears in one step, when all files are on the disk
        trial.json         format, config, seed, engine, metrics, simulated_s, speed_up, wall_s (of phases), versions,
                           package (version), inputs (SHA-256 of files that were read), machine, events_sha256
        events.csv         time_ns, robot, event, task, x_m, y_m, value       (mission_log.Event)
        samples.csv        time_ns, robot, task, x_m, y_m, value_kpa          (mission_log.Sample)
        metrics.csv        the map after each sample                          (mission_log.Moment)
        trajectories.csv   time_ns, robot, x_m, y_m                           (mission_log.Waypoint)
        truth.npy prediction.npy variance.npy     float64, (rows from the south, columns), kPa and kPa^2
        truth.png prediction.png variance.png trajectories.png     only with pictures=True, drawn last
        .made_by_move_base_abstract     marks that this program made the folder, and may replace it

An engine may put further files (FROM_ENGINES) into TrialFolder.path before it is finished. Numbers in CSV files are
written so that reading gives the same bits. Times are simulated ns since the start of the mission, so the event logs of
two runs can be compared directly.
"""
from __future__ import annotations

import csv
import hashlib
import io
import json
import math
import os
from pathlib import Path
from typing import Any, Callable, Dict, Sequence, get_type_hints

import numpy as np

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.own_files import FolderKind, OutputError, whole_file
from move_base_abstract.common.version import package_version

from ..mission.mission_log import Event, Moment, Sample, Waypoint
from .provenance import machine, versions
from .result import Metrics, TrialResult

FORMAT = 1
UNFINISHED = '.unfinished'
OLD = '.old'  # while a complete trial replaces another one
ARRAYS = ('truth', 'prediction', 'variance')
PICTURES = (*ARRAYS, 'trajectories')
FROM_ENGINES = ('lockstep_events.jsonl', 'charge.jsonl', 'trial.bag', 'trial.bag.active', 'error.txt')
TABLES = (
    ('events', 'events.csv', Event, Event._fields),
    ('samples', 'samples.csv', Sample, ('time_ns', 'robot', 'task', 'x_m', 'y_m', 'value_kpa')),
    ('history', 'metrics.csv', Moment, Moment._fields),
    ('waypoints', 'trajectories.csv', Waypoint, ('time_ns', 'robot', 'x_m', 'y_m')),
)
KIND = FolderKind('trial', ('trial.json', *(file for _, file, _, _ in TABLES), *(f'{name}.npy' for name in ARRAYS),
                            *(f'{name}.png' for name in PICTURES), *FROM_ENGINES))


def is_complete(path: Any, prefix: str = '') -> bool:
    """Return whether the folder has a complete trial. ``prefix``: what the names of its files begin with."""
    return (Path(path) / f'{prefix}trial.json').is_file()


class TrialFolder:
    """The folder of one trial that is about to run; a context manager.

    Entering removes the remains of an earlier try and makes NAME.unfinished. finish() renames it to NAME. Without
    finish(), NAME.unfinished stays, and shows how far the trial came. A complete NAME is replaced only by another
    complete trial. A folder that is neither a trial's nor empty is never replaced (own_files.py).

    :raises ConfigurationError: on entering, if something else has that name, or another process writes there.
    :raises OutputError: if something cannot be written, for example because the disk is full.
    """

    def __init__(self, path: Any) -> None:
        self.final_path = Path(os.path.abspath(path))
        if not self.final_path.name:
            raise ConfigurationError(f'{path}: must be a folder that can be given its name, not the root of all')
        self.path = self.final_path.with_name(self.final_path.name + UNFINISHED)
        self._old = self.final_path.with_name(self.final_path.name + OLD)
        self._marker: Any = None

    def check(self) -> None:
        """Check that nothing else has the names of the folder. :raises ConfigurationError: if so, with its path."""
        for path in (self.final_path, self.path, self._old):
            KIND.check(path)

    def __enter__(self) -> TrialFolder:
        self.check()
        KIND.remove(self.path)
        self._marker = KIND.make(self.path)
        return self

    def __exit__(self, *problem: object) -> None:
        os.close(self._marker)

    def finish(self, result: TrialResult, pictures: bool = False, recorded: Callable[..., Any] = lambda: None) -> Path:
        """Write all files of a TrialResult to the disk, give the folder its final name, and return its path.

        pictures: whether to draw pictures, too. recorded: called when the trial is complete, before pictures are drawn.
        """
        self._write(result)
        recorded()
        if pictures:
            from .pictures import write_pictures  # matplotlib takes a second to import
            write_pictures(self.final_path, result)
        return self.final_path

    def _write(self, result: TrialResult) -> None:
        write_files(self.path, result)
        try:
            _sync_folder(self.path)
            self._swap()
        except OSError as error:
            raise OutputError(f'{self.final_path}: cannot be given its name: {error.strerror}; the trial is in '
                              f'{self.path}') from error

    def _swap(self) -> None:
        """Give the folder its final name. An older complete one is moved first; a kill in between loses only that."""
        KIND.remove(self._old)
        KIND.check(self.final_path)
        if is_complete(self.final_path):
            os.rename(self.final_path, self._old)
        else:
            KIND.remove(self.final_path)
        os.rename(self.path, self.final_path)
        _sync_folder(self.final_path.parent)
        KIND.remove(self._old)


def write_files(folder: Path, result: TrialResult) -> None:
    """Write the files of a TrialResult: first what cannot be computed again, last the file that makes it complete."""
    digest = _write_tables(folder, result)
    for name in ARRAYS:
        content = io.BytesIO()  # numpy does not say why it cannot write to a file
        np.save(content, np.asarray(getattr(result, name), dtype=np.float64), allow_pickle=False)
        with whole_file(folder / f'{name}.npy', 'wb') as stream:
            stream.write(content.getbuffer())
    with whole_file(folder / 'trial.json', 'w', encoding='utf-8') as stream:
        json.dump(_plain(describe(result, digest)), stream, indent=1, allow_nan=False)


def describe(result: TrialResult, events_sha256: str) -> Dict[str, Any]:
    """Return the content of trial.json for a TrialResult."""
    return {
        'format': FORMAT, 'config': result.config, 'seed': result.seed, 'engine': result.engine,
        'metrics': result.metrics._asdict(), 'simulated_s': result.simulated_s, 'speed_up': result.speed_up,
        'wall_s': result.wall_s, 'moving_wall_s': result.moving_wall_s, 'cell_m': result.cell_m,
        'field': result.about_field, 'own_code': result.own_code, 'inputs': result.inputs,
        'events_sha256': events_sha256, 'package': package_version(), 'versions': versions(), 'machine': machine(),
    }


def read_trial(path: Any, prefix: str = '') -> Any:
    """Return the TrialResult of a complete folder; ``prefix``: what the names of its files begin with.

    :raises ValueError: if it is not complete, or has another format.
    """
    path = Path(path)
    if not is_complete(path, prefix):
        raise ValueError(f'{path}: not a complete trial (no {prefix}trial.json)')
    about: Any = read_about(path, prefix)
    tables = {name: _read_table(path / f'{prefix}{file}', record) for name, file, record, _ in TABLES}
    arrays = {name: np.load(path / f'{prefix}{name}.npy', allow_pickle=False) for name in ARRAYS}
    values: Any = {name: math.nan if value is None else value for name, value in about['metrics'].items()}
    metrics = Metrics(**values)
    moving = about['moving_wall_s']
    return TrialResult(config=about['config'], seed=about['seed'], engine=about['engine'], metrics=metrics,
                       simulated_s=about['simulated_s'], cell_m=about['cell_m'], about_field=about.get('field', {}),
                       own_code=about.get('own_code', {}), inputs=about.get('inputs', {}), wall_s=about['wall_s'],
                       moving_wall_s=math.nan if moving is None else moving, **tables, **arrays)


def read_about(path: Any, prefix: str = '') -> Dict[str, Any]:
    """Return the content of trial.json of a complete folder; NaNs are None in it."""
    file = Path(path) / f'{prefix}trial.json'
    with open(file, encoding='utf-8') as stream:
        about = json.load(stream)
    if about.get('format') != FORMAT:
        raise ValueError(f'{file}: format {about.get("format")!r} is unknown; this program reads {FORMAT}')
    return about


def events_text(events: Sequence[Event]) -> str:
    """Return the event log as it is written. Two runs are the same if these texts are equal."""
    return _csv_text(Event._fields, events)


def _write_tables(folder: Path, result: TrialResult) -> str:
    """Write the tables; return the SHA-256 of events.csv."""
    for name, file, _, header in TABLES:
        with whole_file(folder / file, 'w', encoding='utf-8', newline='') as stream:
            stream.write(_csv_text(header, getattr(result, name)))
    return hashlib.sha256(events_text(result.events).encode()).hexdigest()


def _csv_text(header: Sequence[str], rows: Sequence[Any]) -> str:
    lines = [','.join(header)]
    lines += [','.join('' if value != value else str(value) for value in row) for row in rows]  # NaN is empty
    return '\n'.join(lines) + '\n'


def _read_table(path: str, record: Any) -> Any:
    kinds = list(get_type_hints(record).values())
    with open(path, newline='', encoding='utf-8') as stream:
        rows = list(csv.reader(stream))[1:]
    for row in rows:
        if len(row) != len(kinds):
            raise ValueError(f'{path}: got a line of {len(row)} columns; it has {len(kinds)}')
    return [record(*(math.nan if cell == '' else kind(cell) for kind, cell in zip(kinds, row))) for row in rows]


def _plain(value: Any) -> Any:
    """Return a value that JSON can represent; NaN and infinities become None."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.floating, np.integer)):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _sync_folder(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
