"""The robots that lasers of one process see, besides the map."""
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
    """Robots with their outlines; those with another global frame are in another world."""

    def __init__(self) -> None:
        self._bodies: Dict[Robot, Tuple[str, Footprint, float]] = {}

    def add(self, robot: Robot, global_frame: str, footprint: Footprint) -> None:
        """Have lasers of others see a robot; ``footprint``: its outline in its base frame."""
        self._bodies[robot] = global_frame, footprint, (
            1.0 + _ROUNDING) * max(math.hypot(x, y) for x, y in footprint.points)

    def remove(self, robot: Robot) -> None:
        """Have it seen no more."""
        del self._bodies[robot]

    def scan(self, robot: Robot, laser: Laser, occupancy: OccupancyMap | None, stamp_ns: int) -> Scan:
        """Return the :class:`.Scan` of a robot's laser at ``stamp_ns`` [ns], of which all remember their poses."""
        base = robot.pose_at(stamp_ns)
        return laser.scan(base, occupancy, self._bodies_near(robot, base, laser, stamp_ns), stamp_ns)

    def _bodies_near(self, robot: Robot, base: Pose2D, laser: Laser, stamp_ns: int) -> List[Body]:
        from .rays import Body  # which needs numpy
        settings, world = laser.settings, self._bodies[robot][0]
        reach = settings.range_max + math.hypot(settings.mount.x, settings.mount.y)
        found = []
        for other, (frame, footprint, radius) in self._bodies.items():
            if other is not robot and frame == world:
                pose = other.pose_at(stamp_ns)
                if pose.distance_to(base) <= reach + radius:
                    found.append(Body(pose.x, pose.y, radius, footprint.at(pose)))
        return found
