"""Read recordings of several robots at once: missions, their legs, and the poses of all robots every half second.

examples/reality/README.md explains the format.
"""
from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Sequence, Tuple, Type, Union

import numpy

from move_base_abstract.common.csv_files import open_csv, rows_of
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

_MISSION = {'run': str, 'map': str, 'kind': str, 'robots': int, 'seed': int, 'simulated_s': float, 'wall_s': float,
            'legs': int, 'cycles': int, 'missed_loops': int, 'moved': int, 'load': float}
_POSES = ('t', 'x', 'y', 'yaw', 'v', 'w', 'goal')


class Mission(NamedTuple):
    """One mission, from the start of Stage to its end: the columns of missions.csv."""

    run: str
    map: str
    kind: str
    robots: int
    seed: int
    simulated_s: float
    wall_s: float
    legs: int
    cycles: int
    missed_loops: int
    moved: int
    load: float


class Recordings(NamedTuple):
    """The content of a folder of recordings.

    ``legs``: rows as {column: text}; ``poses``: {(run, number of the robot): array of rows t, x, y, yaw, v, w, goal}.
    """

    missions: Tuple[Mission, ...]
    legs: Tuple[Dict[str, str], ...]
    poses: Dict[Tuple[str, int], numpy.ndarray]


def read_recordings(folder: Union[str, Path]) -> Recordings:
    """Return the Recordings in the files missions.csv, legs.csv.gz and poses.csv.gz of ``folder``.

    :raises ConfigurationError: if one cannot be read, has a value that is no number, or names a mission that is not in
        missions.csv.
    """
    folder = Path(folder)
    missions = tuple(_missions(folder / 'missions.csv'))
    legs = tuple(row for _, row in _rows(folder / 'legs.csv.gz', ('run', 'robot', 'goal')))
    poses = _poses(folder / 'poses.csv.gz')
    known = {mission.run for mission in missions}
    for name, runs in (('legs.csv.gz', [leg['run'] for leg in legs]), ('poses.csv.gz', [run for run, _ in poses])):
        strange = sorted(set(runs) - known)
        if strange:
            raise ConfigurationError('{}: run: got {}; allowed: one that missions.csv has'.format(
                folder / name, shown(strange[0])))
    return Recordings(missions, legs, poses)


def encounters(legs: Sequence[Dict[str, str]], distance: float) -> List[Dict[str, str]]:
    """Return the rows of ``legs`` in which another robot came nearer than ``distance`` [m]."""
    return [leg for leg in legs if leg['min_robot_dist_m'] and float(leg['min_robot_dist_m']) < distance]


def _missions(path: Path) -> Iterator[Mission]:
    for where, row in _rows(path, _MISSION):
        values: Any = {name: _value(row, name, kind, where) for name, kind in _MISSION.items()}
        yield Mission(**values)


def _poses(path: Path) -> Dict[Tuple[str, int], numpy.ndarray]:
    rows: Dict[Tuple[str, int], List[List[float]]] = {}
    with open_csv(path) as stream:  # by position, because there are a hundred thousand rows
        lines = csv.reader(stream, strict=True)
        head = next(lines, [])
        if head != ['run', 'robot', *_POSES]:
            raise ConfigurationError('{}: line 1: got {}; allowed: run,robot,{}'.format(
                path, shown(','.join(head)), ','.join(_POSES)))
        for cells in lines:
            try:
                run, robot, *values = cells
                numbers = [float(value) for value in values]
                key = run, int(robot)
            except ValueError:
                numbers = []
            if len(numbers) != len(_POSES) or not all(map(math.isfinite, numbers)):
                raise ConfigurationError('{}: line {}: got {}; allowed: a name and {} finite numbers'.format(
                    path, lines.line_num, shown(','.join(cells)), len(_POSES) + 1))
            rows.setdefault(key, []).append(numbers)
    return {key: numpy.array(values) for key, values in rows.items()}


def _rows(path: Path, needed: Iterable[str]) -> Iterator[Tuple[str, Dict[str, str]]]:
    with open_csv(path) as stream:
        for where, row in rows_of(stream, str(path)):
            missing = [name for name in needed if name not in row]
            if missing:
                raise ConfigurationError('{}: no column {}; allowed: a table with {}'.format(
                    path, ', '.join(missing), ', '.join(needed)))
            yield where, row


def _value(row: Mapping[str, str], name: str, kind: Type[Any], where: str) -> Union[float, str]:
    try:
        value = kind(row[name])
    except ValueError:
        value = math.nan
    if kind is not str and not math.isfinite(value):
        raise ConfigurationError('{}: {}: got {}; allowed: a finite number'.format(where, name, shown(row[name])))
    return value
