"""Read legs from a table: one row per goal, with the columns that docs/calibrate.md names."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Iterable, Iterator, List, Mapping, Optional, Union

from move_base_abstract.common.csv_files import number_in, open_csv, rows_of
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.geometry import Pose2D, pose_of

from .legs import RecordedLeg, Way, way_along

if TYPE_CHECKING:
    from pathlib import Path

_NEEDED = ('start_x', 'start_y', 'start_yaw', 'goal_x', 'goal_y', 'goal_yaw', 'duration_s', 'state')
_PREEMPTED, _SUCCEEDED, _ABORTED = 2, 3, 4  # of actionlib_msgs/GoalStatus
_MOST_ROWS = 1_000_000
_HALF_TURN = math.pi + 1e-3  # rad; a table may have rounded it up


def read_legs(path: Union[str, Path]) -> List[RecordedLeg]:
    """Return the RecordedLegs in the CSV file ``path``.

    :raises ConfigurationError: if it cannot be read, a column is missing, or a value is no number.
    """
    with open_csv(path) as stream:
        return _read(_Lines(stream), str(path))


class _Lines:
    """The lines of a stream that are no comments; ``number``: that of the latest line, from 1 on."""

    def __init__(self, stream: Iterable[str]) -> None:
        self._stream = stream
        self.number = 0

    def __iter__(self) -> Iterator[str]:
        for line in self._stream:
            self.number += 1
            if not line.startswith('#'):
                yield line


def _read(lines: _Lines, path: str) -> List[RecordedLeg]:
    legs: List[RecordedLeg] = []
    for where, row in rows_of(lines, path, _NEEDED):
        if len(legs) >= _MOST_ROWS:
            raise ConfigurationError('{}: got more than {} rows; allowed: at most that'.format(path, _MOST_ROWS))
        legs.append(_leg(row, where, len(legs) + 1))
    if not legs:
        raise ConfigurationError('{}: got no rows; allowed: a table with {}, and at least one row'.format(
            path, ', '.join(_NEEDED)))
    return legs


def _leg(row: Mapping[str, str], where: str, number: int) -> RecordedLeg:
    values = {name: number_in(row, name, where) for name in _NEEDED}
    _check('duration_s', values['duration_s'], where, values['duration_s'] > 0.0, 'a number > 0 [s]')
    start, goal = (pose_of((values[name + axis] for axis in ('_x', '_y', '_yaw')), f'{where}: {name}')
                   for name in ('start', 'goal'))
    optional = {name: _optional(row, name, where) for name in (
        'plan_m', 'driven_m', 'start_turn_rad', 'end_turn_rad', 'end_x', 'end_y', 'end_yaw', 'goal', 'rescued',
        'stuck_start', 'cancelled', 'min_robot_dist_m', 'plan_clearance_m', 'send_s', 'result_s', 'reverse_s',
        'turned_rad', 'plan_turn_rad')}
    for name in ('plan_m', 'driven_m', 'min_robot_dist_m', 'plan_clearance_m'):
        _check(name, optional[name], where, (optional[name] or 0.0) >= 0.0, 'a number >= 0 [m]')
    for name in ('start_turn_rad', 'end_turn_rad'):
        _check(name, optional[name], where, 0.0 <= (optional[name] or 0.0) <= _HALF_TURN, 'a number in 0..pi [rad]')
    end: Any = [optional[name] for name in ('end_x', 'end_y', 'end_yaw')]
    stamps: Any = optional['send_s'], optional['result_s']
    return RecordedLeg(
        row.get('run') or '', row.get('robot') or '', int(optional['goal'] or number), start, goal,
        values['duration_s'], values['state'] == _SUCCEEDED, values['state'] == _ABORTED,
        _way(optional, start, goal), None if None in end else pose_of(end, f'{where}: end'),
        not (optional['rescued'] or optional['stuck_start'] or optional['cancelled'] == 2.0),
        optional['min_robot_dist_m'], optional['plan_clearance_m'], optional['send_s'],
        None if None in stamps else stamps[1] - stamps[0], cut=values['state'] == _PREEMPTED, map=row.get('map') or '',
        reverse=optional['reverse_s'], turned=_turned_beyond(optional))


def _turned_beyond(values: Mapping[str, Optional[float]]) -> Optional[float]:
    """Return by how much more a robot turned [rad] than its way asks for; None if the table does not say it."""
    asked: Any = [values[name] for name in ('plan_turn_rad', 'start_turn_rad', 'end_turn_rad')]
    return None if None in asked or values['turned_rad'] is None else values['turned_rad'] - sum(asked)


def _way(values: Mapping[str, Any], start: Pose2D, goal: Pose2D) -> Optional[Way]:
    """Return the recorded way, as planned or otherwise as driven. Its turns have the signs of the straight line's."""
    length = values['driven_m'] if values['plan_m'] is None else values['plan_m']
    if length is None:
        return None
    straight = way_along(start, (), goal)
    turns = [turn if values[name] is None else math.copysign(values[name], turn) for name, turn in (
        ('start_turn_rad', straight.start_turn), ('end_turn_rad', straight.end_turn))]
    return Way(length, *turns)


def _check(name: str, value: Any, where: str, is_allowed: bool, allowed: str) -> None:
    if not is_allowed:
        raise ConfigurationError('{}: {}: got {:g}; allowed: {}'.format(where, name, value, allowed))


def _optional(row: Mapping[str, str], name: str, where: str) -> Optional[float]:
    return number_in(row, name, where) if row.get(name) not in (None, '') else None
