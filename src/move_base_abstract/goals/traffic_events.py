"""What happens to one robot in traffic, as values: as of :mod:`.events`."""
from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Tuple

if TYPE_CHECKING:
    from .events import Row


class Entered(NamedTuple):
    """The robot has got a place in an area."""

    time_ns: int
    robot: str
    area: str


class Places(NamedTuple):
    """The area has room for so many robots; told once, of the first robot that gets a place there, before that."""

    time_ns: int
    robot: str
    area: str
    capacity: int


class ZoneLimit(NamedTuple):
    """The ``zone`` has another ``max_speed`` [m/s], 0: none; told once, of the first robot by name."""

    time_ns: int
    robot: str
    zone: str
    max_speed: float


class Paced(NamedTuple):
    """The robot goes on by the limit that ``zone`` has now, from rest, before which it is told that it stands."""

    time_ns: int
    robot: str
    zone: str
    max_speed: float


class Prioritized(NamedTuple):
    """The robot has this priority from now on."""

    time_ns: int
    robot: str
    priority: int


class Left(NamedTuple):
    """The robot has given its place in an area back."""

    time_ns: int
    robot: str
    area: str


class Deadlock(NamedTuple):
    """The robot has closed a circle of waiting: ``circle`` is (robot, area, ...)."""

    time_ns: int
    robot: str
    circle: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'deadlock', *self.circle)


class GaveWay(NamedTuple):
    """The robot drives back out of ``areas``, in which others of a circle of waiting want a place."""

    time_ns: int
    robot: str
    areas: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'gave_way', *self.areas)


#: as of :data:`.events.PLAIN_ROWS`
PLAIN_ROWS = {Places: 'places', Entered: 'entered', Left: 'left', ZoneLimit: 'zone_limit', Paced: 'paced',
              Prioritized: 'priority'}
