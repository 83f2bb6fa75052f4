"""Missions: the robots, where they start, and the places that they visit, in the order of the visits.

A mission comes from a YAML file (read_mission) or from a field's readings (read_field_points, mission_from_points).
All places are in the map frame, in metres (x east, y north) and radians (yaw from x, counter-clockwise).
This module needs only the standard library and PyYAML. Everything is checked when it is read and immutable afterwards.
"""
from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Any, Dict, NamedTuple, Optional, Sequence, Tuple

from .common.bounded_yaml import load_yaml_file
from .common.csv_files import read_values
from .common.errors import ConfigurationError
from .common.geometry import Pose2D, pose_of
from .common.kinds import similar
from .common.ros_names import ROBOT_NAME_RULE, is_robot_name
from .common.shown import shown, shown_text

if TYPE_CHECKING:
    from .common.type_names import StrPath

WGS84_SEMI_MAJOR_M = 6378137.0  # equatorial radius a [m]
WGS84_ECCENTRICITY_SQUARED = 0.00669437999014  # e^2

MISSION_KEYS = ('robots',)
ROBOT_KEYS = ('name', 'start', 'goals')


class MissionError(ConfigurationError):
    """A mission or field file cannot be used. The text names the file, the place in it, and what is allowed."""


class RobotPlan(NamedTuple):
    """The part of one robot in a mission: its name, its start and its goals."""

    name: str  # ROS name; also its namespace and tf prefix
    start: Pose2D
    goals: Tuple[Pose2D, ...]  # in the order in which they are visited


class Mission(NamedTuple):
    """The plans of all robots, in the order of the file."""

    robots: Tuple[RobotPlan, ...]

    @property
    def goal_count(self) -> int:
        """Number of goals of all robots together."""
        return sum(len(robot.goals) for robot in self.robots)

    def first_robots(self, count: Optional[int]) -> Mission:
        """Return the mission of the first ``count`` robots, or of all if it is None.

        :raises MissionError: if ``count`` is not in 1..the number of robots.
        """
        if count is not None and not 1 <= count <= len(self.robots):
            raise MissionError(f'the mission has {len(self.robots)} robots: their number must be '
                               f'1..{len(self.robots)}, got {count}')
        return Mission(self.robots[:count])


class FieldPoint(NamedTuple):
    """One reading of a field in local metric coordinates."""

    x: float  # m, east of the field's south-west corner
    y: float  # m, north of the field's south-west corner
    value: float  # in the unit of the file's value column


def _facing_travel(previous: Pose2D, place: Pose2D) -> Pose2D:
    """Return ``place`` with the heading of the way from ``previous``, or with ``previous.yaw`` if the two coincide."""
    same = (previous.x, previous.y) == (place.x, place.y)
    return Pose2D(place.x, place.y, previous.yaw if same else previous.bearing_to(place))


# ---------------------------------------------------------------------------------------------- the mission file

def read_mission(path: StrPath) -> Mission:
    """Return the Mission in the YAML file ``path``.

    :raises MissionError: if the file cannot be used.
    """
    try:
        document = load_yaml_file(path)
    except ConfigurationError as error:
        raise MissionError(str(error)) from None
    return parse_mission(document, str(path))


def parse_mission(document: Any, source: str) -> Mission:
    """Return the Mission in a loaded YAML document; error texts begin with ``source``.

    :raises MissionError: if the document is not a mission.
    """
    _check_mapping(document, MISSION_KEYS, MISSION_KEYS, f'{source}: mission')
    entries = document['robots']
    if not isinstance(entries, list) or not entries:
        raise MissionError(f'{source}: robots: must be a list of at least one robot, got {shown(entries)}')
    robots = tuple(_parse_robot(entry, f'{source}: robots[{i}]') for i, entry in enumerate(entries))
    seen: Dict[str, int] = {}
    for i, robot in enumerate(robots):
        if robot.name in seen:
            raise MissionError(f"{source}: robots[{i}].name: '{robot.name}' is already the name of "
                               f'robots[{seen[robot.name]}]; names must differ')
        seen[robot.name] = i
    return Mission(robots)


def _parse_robot(entry: Any, where: str) -> RobotPlan:
    _check_mapping(entry, ROBOT_KEYS, ROBOT_KEYS, where)
    name = entry['name']
    if not is_robot_name(name):
        raise MissionError(f'{where}.name: must be {ROBOT_NAME_RULE} (it becomes a ROS namespace), got {shown(name)}')
    start = _parse_place(entry['start'], None, f'{where}.start')
    goals = entry['goals']
    if not isinstance(goals, list) or not goals:
        raise MissionError(f'{where}.goals: must be a list of at least one goal, got {shown(goals)}')
    places = [start]
    for i, goal in enumerate(goals):
        places.append(_parse_place(goal, places[-1], f'{where}.goals[{i}]'))
    return RobotPlan(name, start, tuple(places[1:]))


def _parse_place(value: Any, previous: Optional[Pose2D], where: str) -> Pose2D:
    """Return [x, y] or [x, y, yaw] as a Pose2D.

    Without a yaw the heading is that of the way from the previous place; 0 if there is none.
    """
    if not isinstance(value, list) or len(value) not in (2, 3):
        raise MissionError(f'{where}: must be [x, y] or [x, y, yaw] in m and rad, map frame, got {shown(value)}')
    for name, number in zip(('x', 'y', 'yaw'), value):
        if isinstance(number, bool) or not isinstance(number, (int, float)) or not math.isfinite(number):
            hint = ' (YAML takes 1e3 as text: write 1.0e+3)' if isinstance(number, str) else ''
            raise MissionError(f'{where}: {name} must be a finite number, got {shown(number)}{hint}')
    place = pose_of(map(float, value), where, MissionError)
    return _facing_travel(previous, place) if len(value) == 2 and previous is not None else place


def _check_mapping(value: Any, known: Sequence[str], required: Sequence[str], where: str) -> None:
    if not isinstance(value, dict):
        raise MissionError(f'{where}: must be a mapping with the keys {", ".join(known)}, got {shown(value)}')
    for key in value:
        if key not in known:
            hint = similar(key, known, f'; known keys: {", ".join(known)}')
            raise MissionError(f'{where}.{shown_text(key)}: unknown key{hint}')
    for key in required:
        if key not in value:
            raise MissionError(f"{where}: the key '{key}' is missing")


# ---------------------------------------------------------------------------------------------- field readings

def read_field_points(path: StrPath, value_column: Optional[str] = None) -> Tuple[FieldPoint, ...]:
    """Read the columns lat, lon [degrees, WGS84] and a value from a CSV file; return a tuple of FieldPoint.

    value_column: the name of the value's column. If it is None, the column is 'value', or, if there is none, the first
    that is neither lat nor lon. The projection is the equirectangular one with the field's middle latitude p as its
    standard parallel, moved to the south-west corner of the readings' bounding box (angles in radians):

        x = N cos(p) (lon - lon_min)      N = a / sqrt(1 - e^2 sin(p)^2)                  (radius along the parallel)
        y = M (lat - lat_min)             M = a (1 - e^2) / (1 - e^2 sin(p)^2)^(3/2)      (radius along the meridian)

    J. P. Snyder, Map Projections: A Working Manual, USGS Professional Paper 1395, 1987: equations 12-1 and 12-2 with
    the radii of equations 4-20 and 4-18 in place of the sphere's. Over a field of 1 km the error is below 0.1 m
    within 60 degrees of the equator.

    :raises MissionError: if the file cannot be used, or has fewer than 3 points.
    """
    try:
        rows = [row for _, row in read_values(path, ('lat', 'lon'), value_column)]
    except ConfigurationError as error:
        raise MissionError(str(error)) from None
    if len(rows) < 3:
        raise MissionError(f'{path}: needs at least 3 points, got {len(rows)}')
    south, north = min(row[0] for row in rows), max(row[0] for row in rows)
    west = min(row[1] for row in rows)
    east_m, north_m = _metres_per_radian(math.radians(0.5 * (south + north)))
    return tuple(FieldPoint(east_m * math.radians(lon - west), north_m * math.radians(lat - south), value)
                 for lat, lon, value in rows)


def _metres_per_radian(latitude: float) -> Tuple[float, float]:
    """Return the metres per radian of longitude and of latitude at a latitude [rad], on the WGS84 ellipsoid."""
    shrink = 1.0 - WGS84_ECCENTRICITY_SQUARED * math.sin(latitude) ** 2
    parallel = WGS84_SEMI_MAJOR_M / math.sqrt(shrink)
    meridian = WGS84_SEMI_MAJOR_M * (1.0 - WGS84_ECCENTRICITY_SQUARED) / shrink ** 1.5
    return parallel * math.cos(latitude), meridian


# ---------------------------------------------------------------------------------------------- chance

def mission_from_points(points: Sequence[Any], robot_count: int, goals_each: int, seed: int = 1) -> Mission:
    """Return a mission robot_0, robot_1, ... in which each robot starts at one point and visits goals_each others.

    points: a sequence of objects with x and y [m]. Robot k draws from a generator of its own, made of (seed, k), so
    adding a robot changes no other robot's plan. A robot's places are all different; two robots may visit the same one.

    :raises MissionError: if a number is not >= 1, or there are too few points.
    """
    for name, value in (('robot_count', robot_count), ('goals_each', goals_each)):
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise MissionError(f'{name} must be a whole number >= 1, got {shown(value)}')
    if goals_each + 1 > len(points):
        raise MissionError(f'goals_each must be < the number of points, {len(points)}, got {goals_each}')
    return Mission(tuple(_draw_plan(points, k, goals_each, seed) for k in range(robot_count)))


def _draw_plan(points: Sequence[Any], index: int, goals_each: int, seed: int) -> RobotPlan:
    rng = random.Random(f'{seed}/{index}')  # text is hashed with SHA-512: the same on every machine
    stops = [Pose2D(point.x, point.y) for point in rng.sample(list(points), goals_each + 1)]
    for i in range(1, len(stops)):
        stops[i] = _facing_travel(stops[i - 1], stops[i])
    return RobotPlan(f'robot_{index}', stops[0], tuple(stops[1:]))
