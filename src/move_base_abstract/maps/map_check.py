"""Whether a robot may be sent to a place. Needs no numpy, so robots without a map do not load it."""
from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, Any, Iterator, Optional, Tuple

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D
    from .occupancy import OccupancyMap

#: the text that move_base logs for a goal off its costmap
TEXT_OFF_MAP = ('The goal sent to the navfn planner is off the global costmap. '
                'Planning will always fail to this goal.')


class Ground(Enum):
    """The state of a place, as in move_base's costmap: map values of 0 to 99 are free, -1 is unknown."""

    FREE = 'free'
    UNKNOWN = 'unknown'
    OCCUPIED = 'occupied'
    OFF_MAP = 'off the map'


class MapCheck:
    """Judges by the map where one robot may be sent.

    While there is no map (``occupancy`` is None), no goal can be judged; the text ``lacking`` says why.
    ``allow_unknown``: whether unknown cells count as free; ``allow_occupied``: whether any cell is allowed.
    """

    def __init__(self, occupancy: Optional[OccupancyMap] = None, allow_unknown: bool = True,
                 allow_occupied: bool = False, lacking: str = 'no map has come yet') -> None:
        self.occupancy = occupancy
        self.lacking = lacking
        self.allow_unknown = allow_unknown
        self._allow_occupied = allow_occupied

    def use(self, occupancy: OccupancyMap) -> None:
        """Judge by the map ``occupancy`` (OccupancyMap) from now on."""
        self.occupancy = occupancy

    def use_none(self, lacking: Any) -> None:
        """Judge no goals from now on; the text ``lacking`` says why."""
        self.lacking = lacking
        self.occupancy = None

    def refusal(self, pose: Pose2D) -> Optional[str]:
        """Return a text that says why the robot must not be sent to ``pose`` (map frame), or None.

        For a pose off the map it is the text of move_base.
        """
        occupancy = self.occupancy
        if occupancy is None:
            return self.lacking
        if self._allow_occupied or occupancy.is_free(pose, self.allow_unknown):
            return None
        ground = occupancy.ground_at(pose.x, pose.y)
        if ground is Ground.OFF_MAP:
            return TEXT_OFF_MAP
        return 'The goal ({:g}, {:g}) lies in an {} cell of the map.'.format(pose.x, pose.y, ground.value)


def square_rings(increment: float, limit: float) -> Iterator[Tuple[float, float]]:
    """Yield offsets (dx, dy) [m] on growing squares around (0, 0), ``increment`` [m] apart, up to ``limit`` [m].

    The order is that in which move_base tries places near a goal: from the inside to the outside; on a square by the
    size of dy, then by that of dx; south before north, west before east.
    """
    count = int(limit / increment + 1e-9) if increment > 0.0 else 0
    for ring in range(1, count + 1):
        for row in range(ring + 1):
            for column in range(ring + 1) if row == ring else (ring,):
                for y_sign in (-1, 1) if row else (1,):
                    for x_sign in (-1, 1) if column else (1,):
                        yield x_sign * column * increment, y_sign * row * increment
