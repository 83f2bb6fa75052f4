"""The events of one robot in traffic, as values; see :mod:`.events`."""
from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Tuple

if TYPE_CHECKING:
    from .events import Row


class Entered(NamedTuple):
    """The robot has got a place in ``area``."""

    time_ns: int
    robot: str
    area: str


class Places(NamedTuple):
    """``area`` has room for ``capacity`` robots.

    This event comes once for each area, with the first robot that gets a place there, just before its Entered.
    """

    time_ns: int
    robot: str
    area: str
    capacity: int


class ZoneLimit(NamedTuple):
    """The limit of ``zone`` is ``max_speed`` [m/s] from now on, 0: none; one event, with the first robot by name."""

    time_ns: int
    robot: str
    zone: str
    max_speed: float


class Paced(NamedTuple):
    """The robot stops and goes on from rest, because the limit of ``zone`` on its way is now ``max_speed`` [m/s]."""

    time_ns: int
    robot: str
    zone: str
    max_speed: float


class Prioritized(NamedTuple):
    """The robot has this ``priority`` from now on."""

    time_ns: int
    robot: str
    priority: int


class Left(NamedTuple):
    """The robot has given back its place in ``area``."""

    time_ns: int
    robot: str
    area: str


class Deadlock(NamedTuple):
    """The robot has closed a circle of waiting robots: ``circle`` is (robot, area, robot, area, ...)."""

    time_ns: int
    robot: str
    circle: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'deadlock', *self.circle)


class GaveWay(NamedTuple):
    """The robot drives back out of ``areas``, in which other robots of a circle of waiting want a place."""

    time_ns: int
    robot: str
    areas: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'gave_way', *self.areas)


#: see :data:`.events.PLAIN_ROWS`
PLAIN_ROWS = {Places: 'places', Entered: 'entered', Left: 'left', ZoneLimit: 'zone_limit', Paced: 'paced',
              Prioritized: 'priority'}
