"""Find the encounters of recorded legs, by the ways and the times that the simulator would give them.

Each recorded goal becomes a leg of the calibration: from the recorded start at the recorded instant, along the way that
is planned on the map. Between goals a robot stands where it was recorded. The encounters then follow as in the
simulator (:mod:`move_base_abstract.encounters`), so that values fitted to them can be used there.
"""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.units import LAST_NS, seconds_to_ns
from move_base_abstract.encounters.control import find_stay, kind_of, next_meeting
from move_base_abstract.encounters.nearness import windows
from move_base_abstract.encounters.track import Track
from move_base_abstract.maps.grid_planner import MapWays
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.pace import Pace, PacedLeg
from move_base_abstract.motion.phased_route import PhasedRoute

from .legs import Way, way_along

if TYPE_CHECKING:
    from move_base_abstract.motion.calibration import Calibration

    from .recordings import Recordings

_PREEMPTED, _SUCCEEDED, _ABORTED = '2', '3', '4'  # of actionlib_msgs/GoalStatus
LEAST_CLEARANCE = 0.3  # m; legs with less clearance of their plan do not count, because narrow places cost time, too
_MAPS = Path(__file__).resolve().parents[2] / 'maps'


class Meeting(NamedTuple):
    """An encounter of a leg with another robot."""

    kind: str  # one of encounter_law.KINDS
    nearest: float  # the least distance to which the robots would have come [m]
    after: float  # when, after the start of the leg [s]
    may_yield: bool  # whether the leg's robot may be the one that stands
    other: Optional[int]  # the number of the other robot's leg in the list of all legs; None if it stood


class MetLeg(NamedTuple):
    """A recorded leg with its :class:`Meeting` objects.

    ``map``: its name; ``way``: that of the planner; ``duration`` [s]; ``cut``: whether it was cancelled after that
    time, and would have taken longer.
    """

    map: str
    way: Way
    duration: float
    succeeded: bool
    meetings: Tuple[Meeting, ...]
    cut: bool = False


def met_legs(recordings: Recordings, folder: Union[str, Path], calibration: Calibration, radius: float,
             robot_radius: float) -> List[MetLeg]:
    """Return a :class:`MetLeg` for each leg of ``recordings`` (Recordings in ``folder``) that counts.

    ``calibration``: that of the robots; ``radius`` [m]: of an encounter; ``robot_radius`` [m]: the distance of ways
    from occupied cells.
    """
    found: List[MetLeg] = []
    for mission in recordings.missions:
        rows = [row for row in recordings.legs if row['run'] == mission.run]
        ways = _ways(mission.map, folder, robot_radius)
        motions = {robot: _motions([row for row in rows if row['robot'] == robot], calibration, ways, radius)
                   for robot in sorted({row['robot'] for row in rows})}
        found += _of_mission(mission.map, motions, radius, len(found))
    return found


class _Motion(NamedTuple):
    """A leg of a robot, or a stand (``row`` and ``way`` are None), from ``begin_ns`` to ``end_ns`` [ns]."""

    track: Track
    begin_ns: int
    end_ns: int
    row: Optional[dict]
    way: Optional[Way]


def _ways(name: str, folder: Union[str, Path], robot_radius: float) -> MapWays:
    path = Path(folder) / (name + '.yaml')
    description = read_description(str(path if path.exists() else _MAPS / (name + '.yaml')))
    return MapWays.on(load_map(description), robot_radius)


def _motions(rows: Sequence[Dict[str, str]], calibration: Calibration, ways: MapWays, radius: float) -> List[_Motion]:
    """Return the _Motion objects of one robot, in order; legs without a way on the map are stands."""
    found, reach = [], 2.0 * radius
    for row in sorted(rows, key=lambda row: float(row['send_s'])):
        begin_ns, end_ns = (seconds_to_ns(float(row[name])) for name in ('send_s', 'result_s'))
        start, goal = _pose(row, 'start'), _pose(row, 'goal')
        corners = ways.corners(start, goal)
        if corners is None:
            found.append(_Motion(Track(None, start, begin_ns, reach), begin_ns, end_ns, None, None))
        else:
            leg = PacedLeg(PhasedRoute(start, goal, corners, calibration.limits, calibration.phases,
                                       calibration.tolerances, begin_ns),
                           Pace(seconds_to_ns(calibration.durations.delay), 1.0))
            found.append(_Motion(Track(leg, None, begin_ns, reach), begin_ns, end_ns, row,
                                 way_along(start, corners, goal)))
        found.append(_Motion(Track(None, _pose(row, 'end'), end_ns, reach), end_ns, LAST_NS, None, None))
    return [one._replace(end_ns=min(one.end_ns, other.begin_ns)) for one, other in zip(found, [*found[1:], found[-1]])]


def _pose(row: Mapping[str, str], what: str) -> Pose2D:
    try:
        return Pose2D(*(float(row[what + axis]) for axis in ('_x', '_y', '_yaw')))
    except ValueError as error:
        raise ConfigurationError('legs: run {}, robot {}, goal {}: {}'.format(
            row['run'], row['robot'], row['goal'], error)) from None


def _of_mission(name: str, motions: Mapping[str, List[_Motion]], radius: float, first: int) -> List[MetLeg]:
    counted: Any = [(robot, one) for robot in motions for one in motions[robot]
                    if one.row is not None and _counts(one.row)]
    numbers = {id(one): first + number for number, (_, one) in enumerate(counted)}
    return [MetLeg(name, one.way, float(one.row['duration_s']), one.row['state'] == _SUCCEEDED, tuple(
        meeting for other in motions if other != robot for theirs in motions[other]
        for meeting in _meetings(one, theirs, radius, numbers)), one.row['state'] == _PREEMPTED)
        for robot, one in counted]


def _counts(row: Mapping[str, str]) -> bool:
    return row['state'] in (_PREEMPTED, _SUCCEEDED, _ABORTED) and not any(
        float(row.get(name) or 0.0) for name in ('rescued', 'stuck_start')) and not (
            float(row.get('plan_clearance_m') or LEAST_CLEARANCE) < LEAST_CLEARANCE)


def _meetings(own: _Motion, theirs: _Motion, radius: float, numbers: Mapping[int, int]) -> List[Meeting]:
    """Return the Meeting of a leg with a _Motion of another robot, as a list: [Meeting] or []."""
    begin_ns, end_ns = max(own.begin_ns, theirs.begin_ns), min(own.end_ns, theirs.end_ns)
    if begin_ns >= end_ns or (theirs.row is None and begin_ns > own.begin_ns and theirs.begin_ns == begin_ns):
        return []  # the other robot's leg has ended meanwhile; its stand is no new encounter
    pair = (own.track, theirs.track)
    due_ns = next_meeting(*pair, radius, list(windows(*pair, begin_ns, end_ns)), begin_ns)
    if due_ns is None or due_ns >= end_ns:
        return []
    stay = find_stay(*pair, radius, due_ns)
    kind, yields = kind_of(*pair, due_ns, stay.nearest_ns)
    return [Meeting(kind, stay.nearest, (due_ns - own.begin_ns) * 1e-9, 0 in yields, numbers.get(id(theirs)))]
