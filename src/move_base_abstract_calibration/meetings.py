"""Find the encounters of recorded legs, by the ways and the times that the simulator would give them.

Each recorded goal becomes a leg of the calibration: from the recorded start at the recorded instant, along the way that
is planned on the map. Between goals a robot stands where it was recorded. The encounters then follow as in the
simulator (:mod:`move_base_abstract.encounters`), so that values fitted to them can be used there.
"""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Tuple, Union

from move_base_abstract.common.csv_files import open_csv, rows_of
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown
from move_base_abstract.common.units import LAST_NS, seconds_to_ns
from move_base_abstract.encounters.control import find_stay, kind_of, next_meeting
from move_base_abstract.encounters.nearness import windows
from move_base_abstract.encounters.track import Track
from move_base_abstract.maps.grid_planner import MapWays
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.motion.pace import Pace, PacedLeg
from move_base_abstract.motion.phased_route import PhasedRoute

from .csv_files import read_legs
from .legs import way_along

if TYPE_CHECKING:
    from move_base_abstract.maps.occupancy import OccupancyMap
    from move_base_abstract.motion.calibration import Calibration

    from .legs import RecordedLeg, Way

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


def met_legs(folder: Union[str, Path], calibration: Calibration, radius: float, robot_radius: float,
             first: int = 0) -> List[MetLeg]:
    """Return a :class:`MetLeg` for each leg of the recordings in ``folder`` that counts.

    ``folder``: it has missions.csv and legs.csv.gz, and the maps that do not ship; examples/reality/README.md explains
    them. ``calibration``: that of the robots; ``radius`` [m]: of an encounter; ``robot_radius`` [m]: the distance of
    ways from occupied cells; ``first``: the number of the first leg in the list of all legs.

    :raises ConfigurationError: if a file cannot be read, or a leg is of a mission that is not in missions.csv.
    """
    found: List[MetLeg] = []
    for row, _, motions in motions_of(folder, calibration, radius, robot_radius):
        found += _of_mission(row['map'], motions, radius, first + len(found))
    return found


def motions_of(folder: Union[str, Path], calibration: Calibration, radius: float,
               robot_radius: float) -> Iterator[Tuple[Mapping[str, str], OccupancyMap, Dict[str, List[Motion]]]]:
    """Yield (row of missions.csv, its map, {robot: [Motion, ...]}) for each mission; see :func:`met_legs`."""
    folder = Path(folder)
    missions: Dict[str, Dict[str, List[RecordedLeg]]] = {}  # {mission: {robot: legs}}
    with open_csv(folder / 'missions.csv') as stream:
        maps = {row['run']: row for _, row in rows_of(stream, folder / 'missions.csv', ('run', 'map'))}
    for leg in read_legs(folder / 'legs.csv.gz'):
        if leg.recording not in maps:
            raise ConfigurationError('{}: run: got {}; allowed: one that missions.csv has'.format(
                folder / 'legs.csv.gz', shown(leg.recording)))
        if leg.sent is None or leg.end is None:
            raise ConfigurationError('{}: run {}, robot {}, goal {}: no number in send_s, end_x, end_y or end_yaw; all '
                                     'must be there'.format(folder / 'legs.csv.gz', *leg[:3]))
        missions.setdefault(leg.recording, {}).setdefault(leg.robot, []).append(leg)
    for run, row in maps.items():
        occupancy = _map(row['map'], folder)
        ways = MapWays.on(occupancy, robot_radius)
        yield row, occupancy, {robot: _motions(legs, calibration, ways, radius)
                               for robot, legs in sorted(missions.get(run, {}).items())}


class Motion(NamedTuple):
    """A leg of a robot, or a stand (``leg`` and ``way`` are None), from ``begin_ns`` to ``end_ns`` [ns]."""

    track: Track
    begin_ns: int
    end_ns: int
    leg: Optional[RecordedLeg]
    way: Optional[Way]


def _map(name: str, folder: Path) -> OccupancyMap:
    path = folder / (name + '.yaml')
    return load_map(read_description(str(path if path.exists() else _MAPS / (name + '.yaml'))))


def _motions(legs: Any, calibration: Calibration, ways: MapWays, radius: float) -> List[Motion]:
    """Return the Motion objects of a robot's ``legs`` [RecordedLeg]; legs without a way on the map are stands."""
    found, reach = [], 2.0 * radius
    for leg in sorted(legs, key=lambda leg: leg.sent):
        begin_ns, end_ns = (seconds_to_ns(at) for at in (leg.sent, leg.sent + leg.duration))
        corners = ways.corners(leg.start, leg.goal)
        if corners is None:
            found.append(Motion(Track(None, leg.start, begin_ns, reach), begin_ns, end_ns, None, None))
        else:
            paced = PacedLeg(PhasedRoute(leg.start, leg.goal, corners, calibration.limits, calibration.phases,
                                         calibration.tolerances, begin_ns),
                             Pace(seconds_to_ns(calibration.durations.delay), 1.0))
            found.append(Motion(Track(paced, None, begin_ns, reach), begin_ns, end_ns, leg,
                                 way_along(leg.start, corners, leg.goal)))
        found.append(Motion(Track(None, leg.end, end_ns, reach), end_ns, LAST_NS, None, None))
    return [*(one._replace(end_ns=min(one.end_ns, other.begin_ns)) for one, other in zip(found, found[1:])),
            *found[-1:]]


def _of_mission(name: str, motions: Mapping[str, List[Motion]], radius: float, first: int) -> List[MetLeg]:
    counted: Any = [(robot, one) for robot in motions for one in motions[robot]
                    if one.leg is not None and _counts(one.leg)]
    numbers = {id(one): first + number for number, (_, one) in enumerate(counted)}
    return [MetLeg(name, one.way, one.leg.duration, one.leg.succeeded, tuple(
        meeting for other in motions if other != robot for theirs in motions[other]
        for meeting in meetings_of(one, theirs, radius, numbers)), one.leg.cut) for robot, one in counted]


def _counts(leg: RecordedLeg) -> bool:
    return (leg.cut or (leg.counts and (leg.succeeded or leg.failed))) and (
        leg.clearance is None or leg.clearance >= LEAST_CLEARANCE)


def meetings_of(own: Motion, theirs: Motion, radius: float, numbers: Mapping[int, int]) -> List[Meeting]:
    """Return the Meeting of a leg with a Motion of another robot, as a list: [Meeting] or []."""
    begin_ns, end_ns = max(own.begin_ns, theirs.begin_ns), min(own.end_ns, theirs.end_ns)
    if begin_ns >= end_ns or (theirs.leg is None and begin_ns > own.begin_ns and theirs.begin_ns == begin_ns):
        return []  # the other robot's leg has ended meanwhile; its stand is no new encounter
    pair = (own.track, theirs.track)
    due_ns = next_meeting(*pair, radius, list(windows(*pair, begin_ns, end_ns)), begin_ns)
    if due_ns is None or due_ns >= end_ns:
        return []
    stay = find_stay(*pair, radius, due_ns)
    kind, yields = kind_of(*pair, due_ns, stay.nearest_ns)
    return [Meeting(kind, stay.nearest, (due_ns - own.begin_ns) * 1e-9, 0 in yields, numbers.get(id(theirs)))]
