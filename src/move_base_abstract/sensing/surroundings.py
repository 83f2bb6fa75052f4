"""The robots that the lasers of one process see, in addition to the map."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Dict, List, Tuple

if TYPE_CHECKING:
    from ..maps.costmaps import Footprint
    from ..maps.occupancy import OccupancyMap
    from ..motion.geometry import Pose2D
    from ..motion.robot import Robot
    from .laser import Laser, Scan
    from .rays import Body

_ROUNDING = 1e-9


class Surroundings:
    """Robots with their outlines; robots with different global frames are in different worlds."""

    def __init__(self) -> None:
        self._bodies: Dict[Robot, Tuple[str, Footprint, float]] = {}

    def add(self, robot: Robot, global_frame: str, footprint: Footprint) -> None:
        """Let the lasers of other robots see ``robot``; ``footprint``: its outline in its base frame."""
        self._bodies[robot] = global_frame, footprint, (
            1.0 + _ROUNDING) * max(math.hypot(x, y) for x, y in footprint.points)

    def remove(self, robot: Robot) -> None:
        """Remove ``robot``, so that no laser sees it."""
        del self._bodies[robot]

    def scan(self, robot: Robot, laser: Laser, occupancy: OccupancyMap | None, stamp_ns: int) -> Scan:
        """Return the :class:`.Scan` of a robot's laser at ``stamp_ns`` [ns].

        :raises TimeError: if a robot no longer remembers its pose at that instant.
        """
        base = robot.pose_at(stamp_ns)
        return laser.scan(base, occupancy, self._bodies_near(robot, base, laser, stamp_ns), stamp_ns)

    def _bodies_near(self, robot: Robot, base: Pose2D, laser: Laser, stamp_ns: int) -> List[Body]:
        from .rays import Body  # imported here, since it needs numpy
        settings, world = laser.settings, self._bodies[robot][0]
        reach = settings.range_max + math.hypot(settings.mount.x, settings.mount.y)
        found = []
        for other, (frame, footprint, radius) in self._bodies.items():
            if other is not robot and frame == world:
                pose = other.pose_at(stamp_ns)
                if pose.distance_to(base) <= reach + radius:
                    found.append(Body(pose.x, pose.y, radius, footprint.at(pose)))
        return found
