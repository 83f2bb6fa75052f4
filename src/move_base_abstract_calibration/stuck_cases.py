"""Find where robots got stuck in recordings of several robots, and how often they could have.

Two robots that touch each other for long are stuck together. The recordings leave no doubt about how long that is:
robots that touch and come free do so within seconds. Such a case belongs to the latest encounter of the two robots
before, so that the simulator, in which robots do not touch, can draw it there. A robot that gives up a goal on its way,
and the next one where it stands, without another robot, is stuck at a wall. Its way's least clearance counts.
"""
from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.common.csv_files import number_in, open_csv, rows_of
from move_base_abstract.maps.clearance import ClearanceField

from .meetings import meetings_of, motions_of

if TYPE_CHECKING:
    from move_base_abstract.maps.occupancy import OccupancyMap
    from move_base_abstract.motion.calibration import Calibration

    from .legs import RecordedLeg
    from .meetings import Motion

TOUCH = 0.52  # m; robots of 0.36 m touch if their centres are no further apart than 0.51 m
LEAST_SECONDS = 30.0  # s; robots that touch for this long are stuck
CLEARANCE = 1.0  # m; a larger clearance of a way counts as this
_GAP = 2.0  # s; robots that are apart for no longer than this touch all the time
_LATER = 5.0  # s; by the simulator's ways two robots meet up to this much later than they touched
_STAYS = 0.05  # m; a robot that has moved less on a goal that it gave up could not move
_MISSION = ('map', 'kind', 'robots', 'seed', 'policy', 'tasks')  # what recordings of one mission have in common
_POSES = 'poses.csv.gz'

#: {robot: {time [s]: (x, y) [m]}}
Tracks = Dict[str, Dict[float, Tuple[float, float]]]


class Trial(NamedTuple):
    """One chance to get stuck, in a recording of ``mission``, at the distance ``at`` [m]; ``stuck``: what happened."""

    mission: str
    at: float
    stuck: bool


class Contact(NamedTuple):
    """Two ``robots`` that touched each other from ``begin`` to ``end`` [s]; ``freed``: whether they came free."""

    robots: Tuple[str, str]
    begin: float
    end: float
    freed: bool


class Cases(NamedTuple):
    """What recordings say.

    ``meetings`` [Trial]: encounters, by the nearest distance; ``ways`` [Trial]: legs, by the clearance of their ways;
    ``contacts`` [Contact]; ``gave_up`` [bool]: whether each robot of a contact gave goals up; ``patience`` [s]: how
    long robots that could not move tried; ``unmet`` [Contact]: those without an encounter before; ``brief`` [s]: how
    long other contacts lasted that ended.
    """

    meetings: List[Trial]
    ways: List[Trial]
    contacts: List[Contact]
    gave_up: List[bool]
    patience: List[float]
    unmet: List[Contact]
    brief: List[float]

    def without(self, mission: str) -> Cases:
        """Return the cases with no chance to get stuck of this ``mission``; how being stuck ends stays."""
        return self._replace(**{name: [one for one in getattr(self, name) if one.mission != mission]
                                for name in ('meetings', 'ways')})


def find_cases(folders: Sequence[str], calibration: Calibration, radius: float, robot_radius: float,
               touch: float = TOUCH) -> Cases:
    """Return the :class:`Cases` of all recordings in ``folders``; they have missions, legs and poses.

    ``radius`` [m]: of an encounter; ``robot_radius`` [m]: the distance of ways from occupied cells; ``touch`` [m]: of
    the centres of robots that touch.

    :raises ConfigurationError: if a file cannot be read.
    """
    cases = Cases([], [], [], [], [], [], [])
    for folder in folders:
        tracks = _read_tracks(Path(folder) / _POSES)
        for row, occupancy, motions in motions_of(folder, calibration, radius, robot_radius):
            mission = mission_of(row)
            touches = list(_contacts(tracks.get(row['run'], {}), touch))
            contacts = [one for one in touches if one.end - one.begin >= LEAST_SECONDS]
            cases.brief.extend(one.end - one.begin for one in touches if one.freed and one not in contacts)
            _add_meetings(cases, mission, motions, contacts, radius)
            _add_ways(cases, mission, motions, contacts, occupancy)
            _add_ends(cases, motions, contacts)
    return cases


def mission_of(row: Mapping[str, str]) -> str:
    """Return what the recordings of one mission have in common, from a ``row`` of missions.csv."""
    return ' '.join(row.get(name, '') for name in _MISSION)


def _read_tracks(path: Path) -> Dict[str, Tracks]:
    found: Dict[str, Tracks] = {}
    with open_csv(path) as stream:
        for where, row in rows_of(stream, path, ('run', 'robot', 't', 'x', 'y')):
            t, x, y = (number_in(row, name, where) for name in ('t', 'x', 'y'))
            found.setdefault(row['run'], {}).setdefault(row['robot'], {})[t] = x, y
    return found


def _contacts(tracks: Tracks, touch: float) -> Iterator[Contact]:
    """Yield the times in which two robots touch, in a recording."""
    for one, other in itertools.combinations(sorted(tracks), 2):
        times = sorted(tracks[one].keys() & tracks[other].keys())
        near = [t for t in times if math.dist(tracks[one][t], tracks[other][t]) <= touch]
        begin = 0
        for last in range(len(near)):
            if last + 1 == len(near) or near[last + 1] - near[last] > _GAP:
                yield Contact((one, other), near[begin], near[last], times[-1] - near[last] > _GAP)
                begin = last + 1


def _add_meetings(cases: Cases, mission: str, motions: Dict[str, List[Motion]], contacts: List[Contact],
                  radius: float) -> None:
    for pair in itertools.combinations(motions, 2):
        met: Dict[float, float] = {}  # {time [s]: nearest distance [m]}
        for own, their in (pair, pair[::-1]):
            for one, other in itertools.product(*(map(_that_move, (motions[own], motions[their])))):
                if one.leg is not None and one.leg.sent is not None:
                    for meeting in meetings_of(one, other, radius, {}):
                        met[round(one.leg.sent + meeting.after, 3)] = meeting.nearest
        for contact in contacts:
            if contact.robots == pair:
                before = [t for t in met if t <= contact.begin + _LATER]
                if before:
                    cases.meetings.append(Trial(mission, met.pop(max(before)), True))
                else:
                    cases.unmet.append(contact)
                for t in [t for t in met if contact.begin < t <= contact.end]:
                    del met[t]  # both are stuck
        cases.meetings.extend(Trial(mission, met[t], False) for t in sorted(met))


def _that_move(motions: List[Motion]) -> List[Motion]:
    return [one for one in motions if one.leg is None or not _stays(one.leg)]


def _stays(leg: RecordedLeg) -> bool:
    """Return whether a robot gave up a goal without moving."""
    return leg.failed and leg.end is not None and (
        math.dist((leg.start.x, leg.start.y), (leg.end.x, leg.end.y)) < _STAYS)


def _cannot_move(leg: Optional[RecordedLeg]) -> bool:
    """Return whether a robot gave up a goal without moving although it had a plan."""
    return leg is not None and _stays(leg) and (leg.way is None or leg.way.length > _STAYS)


def _add_ways(cases: Cases, mission: str, motions: Dict[str, List[Motion]], contacts: List[Contact],
              occupancy: OccupancyMap) -> None:
    field = ClearanceField.on(occupancy, CLEARANCE)
    for robot, own in motions.items():
        legs = [one for one in own if one.leg is not None]
        for one, after in zip(legs, [*legs[1:], None]):
            leg = one.leg
            if leg is None or _stays(leg) or not (leg.counts or leg.cut):
                continue
            end = leg.sent + leg.duration  # type: ignore[operator]  # motions_of has checked that it was recorded
            stuck = leg.failed and _cannot_move(after and after.leg) and not any(
                robot in contact.robots and contact.begin <= end <= contact.end for contact in contacts)
            cases.ways.append(Trial(mission, field.least_along(one.track.leg.way)[0], stuck))


def _add_ends(cases: Cases, motions: Dict[str, List[Motion]], contacts: List[Contact]) -> None:
    cases.contacts.extend(contacts)
    for contact in contacts:
        for robot in contact.robots:
            legs = [one.leg for one in motions.get(robot, ()) if one.leg is not None and one.leg.sent is not None
                    and one.leg.sent < contact.end and one.leg.sent + one.leg.duration > contact.begin]
            if legs:
                cases.gave_up.append(any(leg.failed for leg in legs))
    cases.patience.extend(one.leg.duration for own in motions.values() for one in own
                          if one.leg is not None and _cannot_move(one.leg))
