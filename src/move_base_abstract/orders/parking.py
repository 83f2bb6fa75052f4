"""Where robots stand that have nothing to do: at places with ``parking``, so that they leave those that others need.

A robot without an order that does not charge drives to the nearest parking place with room; of equally near ones, to
the first in the scenario. So does a robot that waits for a charger. A robot that looks ahead parks only where it has
the charge to get to a charger again. Robots choose in the order of their names. If no place has room, the robot stays
where it is. It may get an order, or be sent to charge, at any time.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Sequence, Tuple

from ..motion.geometry import Pose2D
from .fleet_state import FREE, PARKING, RobotState

if TYPE_CHECKING:
    from ..tasks.places import Place
    from .charging import Send, Tell
    from .look_ahead import LookAhead
    from .policies import Distance


class Parking:
    """Sends idle robots to park at those of ``places`` that are for it; the other arguments are those of Charging."""

    def __init__(self, places: Iterable[Place], distance: Distance, send: Send, tell: Tell,
                 ahead: Optional[LookAhead] = None) -> None:
        self._ahead = ahead
        self._places = {place.name: place for place in places if place.parking}
        self._distance = distance
        self._send = send
        self._tell = tell

    def ended(self, robot: RobotState, succeeded: bool, now_ns: int) -> None:
        """Note that the robot's way to its parking place has ended."""
        robot.phase = FREE
        if succeeded:
            robot.parked_at = robot.at
        else:
            robot.tried_now[robot.parking] = now_ns  # not again at this instant
            robot.parking = ''

    def send(self, robots: Sequence[RobotState], now_ns: int) -> None:
        """Send idle robots to park. Call it after all have got orders, or have been sent to charge."""
        if not self._places:
            return
        idle = [robot for robot in robots if robot.phase == FREE and not robot.goal_id and not robot.is_out_of_order]
        for robot in idle:
            self._look(robot, robots)
        for robot in idle:
            if not robot.parking:
                self.go(robot, robots, now_ns)

    def go(self, robot: RobotState, robots: Sequence[RobotState], now_ns: int) -> bool:
        """Send the robot to the nearest parking place with room; return whether there is one."""
        place = self._nearest(robot, robots, now_ns)
        if place is None:
            return False
        self._tell(robot.name, 'park_assigned', place.name)
        self._send(robot, place.pose, robot.new_id('park.' + place.name, now_ns))
        robot.phase, robot.parking = PARKING, place.name
        return True

    def _look(self, robot: RobotState, robots: Sequence[RobotState]) -> None:
        """Note at which parking place the robot stands: where it has parked, or one with room to which it has come."""
        if robot.parking and robot.at == robot.parked_at:
            return
        robot.parking = ''
        pose = Pose2D(*robot.at)
        for place in self._places.values():
            if place.holds(pose) and self._has_room(place, robots):
                robot.parking, robot.parked_at = place.name, robot.at
                return

    @staticmethod
    def _has_room(place: Place, robots: Sequence[RobotState]) -> bool:
        return place.capacity is None or sum(robot.parking == place.name for robot in robots) < place.capacity

    def _nearest(self, robot: RobotState, robots: Sequence[RobotState], now_ns: int) -> Optional[Place]:
        found: List[Tuple[Any, ...]] = []
        for index, place in enumerate(self._places.values()):
            if not self._has_room(place, robots) or robot.tried_now.get(place.name) == now_ns:
                continue
            point = place.pose.x, place.pose.y
            if self._ahead is not None and not self._ahead.may_visit(robot, point):
                continue
            away = self._distance(robot.name, robot.at, point)
            if away is not None:
                found.append((away, index, place))
        return min(found)[2] if found else None
