"""The events of one robot in traffic, as values; see :mod:`.events`."""
from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Tuple

from ..runs.trace import RowKind
from .events import written

if TYPE_CHECKING:
    from .events import Row


@written(RowKind('entered', 'area', 'the robot got a place in a [zone](zones.md) or on a lane'))
class Entered(NamedTuple):
    """The robot has got a place in ``area``."""

    time_ns: int
    robot: str
    kind: str
    area: str


@written(RowKind('left', 'area', 'it gave that place back'))
class Left(NamedTuple):
    """The robot has given back its place in ``area``."""

    time_ns: int
    robot: str
    kind: str
    area: str


@written(RowKind('places', 'area, capacity',
                 'before the first `entered` of an area that has room for so many robots only'))
class Places(NamedTuple):
    """``area`` has room for ``capacity`` robots.

    This event comes once for each area, with the first robot that gets a place there, just before its Entered.
    """

    time_ns: int
    robot: str
    area: str
    capacity: int


@written(RowKind('zone_limit', 'zone, max_speed (0: none)',
                 'a zone has another limit; the row has the first robot by name'))
class ZoneLimit(NamedTuple):
    """The limit of ``zone`` is ``max_speed`` [m/s] from now on, 0: none; one event, with the first robot by name."""

    time_ns: int
    robot: str
    zone: str
    max_speed: float


@written(RowKind('paced', 'zone, max_speed', 'the robot goes on by that limit'))
class Paced(NamedTuple):
    """The robot stops and goes on from rest, because the limit of ``zone`` on its way is now ``max_speed`` [m/s]."""

    time_ns: int
    robot: str
    zone: str
    max_speed: float


@written(RowKind('priority', 'number', 'the robot has this [priority](zones.md#priorities) from now on'))
class Prioritized(NamedTuple):
    """The robot has this ``priority`` from now on."""

    time_ns: int
    robot: str
    priority: int


@written(RowKind('deadlock', 'robot, area, ...', 'the robot closed a circle of waiting'))
class Deadlock(NamedTuple):
    """The robot has closed a circle of waiting robots: ``circle`` is (robot, area, robot, area, ...)."""

    time_ns: int
    robot: str
    circle: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'deadlock', *self.circle)


@written(RowKind('gave_way', 'area, ...', 'the robot drives back out of these areas, to resolve such a circle'))
class GaveWay(NamedTuple):
    """The robot drives back out of ``areas``, in which other robots of a circle of waiting want a place."""

    time_ns: int
    robot: str
    areas: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'gave_way', *self.areas)
