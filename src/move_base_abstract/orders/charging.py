"""When and where robots charge: thresholds, chargers with limited room, a queue, and charging while idle.

A robot below ``charge_below`` goes to charge when its order is done, and takes no order before it is above
``charge_until``. With ``charge_reserve`` robots look ahead (:mod:`.look_ahead`): a robot also goes to charge while its
charge is still enough for the way, or if it lacks the charge for all open orders. It goes to the nearest charger with
room; of equally near ones, to the first in the scenario. If there is none, the robot waits where it stands, or
where it parks; if it looks ahead and its charge would soon be too low for the way, it waits at the border of the
nearest charger. Robots are served in the order in which they began to wait, at one instant by name. A robot that is
charged enough and has no order leaves its charger if another robot waits for one, with ``charge_full`` at this
charge at the earliest; it drives to a parking place, or, if there is none with room, to where it started.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ..motion.geometry import Pose2D
from . import rows
from .fleet_state import AT_CHARGER, FREE, HOME, HOMING, PARKING, TO_CHARGER, RobotState
from .look_ahead import LookAhead
from .parking import Parking
from .policies import Distance, OpenOrder
from .settings import DispatchSettings


class Charger(NamedTuple):
    """A charger: the pose at which robots stand, and the number of robots that have room (None: any number)."""

    name: str
    pose: Pose2D
    capacity: Optional[int] = None


#: sends a robot somewhere: (robot, pose, id of the goal)
Send = Callable[[RobotState, Pose2D, str], object]
Tell = Callable[..., object]


class Charging:
    """Decides when and where each robot charges.

    ``send`` and ``tell(robot, kind, values...)`` are methods of the dispatcher; ``parking``: where robots park.
    """

    def __init__(self, settings: DispatchSettings, chargers: Sequence[Charger], distance: Distance, send: Send,
                 tell: Tell, parking: Parking, ahead: Optional[LookAhead] = None) -> None:
        self._settings = settings
        self._ahead = ahead
        self._chargers = {charger.name: charger for charger in chargers}
        self._distance = distance
        self._send = send
        self._tell = tell
        self._parking = parking
        self._number = 0

    def look(self, robots: Sequence[RobotState]) -> None:
        """Note which robots must charge, and which have charged enough."""
        if not self._chargers:
            return
        for robot in robots:
            if robot.phase == AT_CHARGER and not robot.is_charging:  # it was placed elsewhere
                self.leave(robot)
                robot.phase = FREE
            if robot.is_charging and robot.phase == FREE and not robot.goal_id:  # it has come to stand in a charger
                robot.phase, robot.charger, robot.awaits_charger_since = AT_CHARGER, robot.stands_in, None
            must_go = self._ahead is not None and self._ahead.must_go(robot)
            if robot.must_charge and not must_go and not robot.is_below(self._settings.charge_until) and (
                    not robot.wants or robot.is_charging and robot.wants <= (robot.charge or 0)):
                robot.must_charge, robot.awaits_charger_since, robot.wants = False, None, 0
            elif not robot.must_charge and (must_go or robot.is_below(self._settings.charge_below)):
                robot.must_charge = True

    def lack(self, robots: Sequence[RobotState], orders: Sequence[OpenOrder]) -> None:
        """Note which of ``robots``, which are free and got none of ``orders``, must charge to do one of them."""
        if self._ahead is not None:
            for robot in robots:
                wants = self._ahead.wanted(robot, orders) if robot.order is None else 0
                if wants and not (robot.is_charging and wants <= (robot.charge or 0)):
                    robot.must_charge, robot.wants = True, wants

    def ended(self, robot: RobotState, succeeded: bool, now_ns: int) -> None:
        """Note that the robot's way to a charger, or home from one, has ended."""
        if robot.phase == TO_CHARGER and succeeded and robot.is_charging:
            robot.phase = AT_CHARGER
            return
        robot.tried_now[robot.charger if robot.phase == TO_CHARGER else HOME] = now_ns  # not again at this instant
        self.leave(robot)
        robot.phase = FREE

    def leave(self, robot: RobotState) -> None:
        """Note that the robot leaves its charger, which then has room again."""
        if robot.charger:
            if robot.phase == AT_CHARGER:
                self._tell(robot.name, 'charge_over', robot.charger)
            robot.charger = ''

    def send(self, robots: Sequence[RobotState], now_ns: int) -> None:
        """Send robots to charge. Call it after orders have been assigned, since a robot that gets one makes room."""
        self._send_low(robots, now_ns)
        self._send_idle(robots, now_ns)

    def _send_low(self, robots: Sequence[RobotState], now_ns: int) -> None:
        """Send the robots that must charge, as long as there is room."""
        waiting = []
        for robot in robots:
            if robot.must_charge and robot.phase in (FREE, PARKING) and not robot.is_out_of_order:
                if robot.awaits_charger_since is None:
                    self._number += 1
                    robot.awaits_charger_since, robot.waits_from_ns = self._number, now_ns
                    robot.is_told_to_wait = False
                waiting.append(robot)
        for robot in sorted(waiting, key=lambda one: one.awaits_charger_since or 0):
            charger = self._nearest(robot, robots, now_ns)
            if charger is None and self._ahead is not None and self._ahead.must_go(robot):
                charger = self._nearest(robot, (), now_ns)  # it waits there, at the border of the zone
            if charger is not None:
                self._go(robot, charger, rows.LOW, now_ns)
            elif not robot.is_told_to_wait:
                robot.is_told_to_wait = True
                self._tell(robot.name, 'charge_awaited', rows.LOW)

    def _send_idle(self, robots: Sequence[RobotState], now_ns: int) -> None:
        """Make room for waiting robots; send idle robots to charge if the settings say so."""
        waiters = [robot for robot in robots if robot.awaits_charger_since is not None
                   and robot.phase in (FREE, PARKING) and not robot.is_out_of_order]
        taken = _taken(robots)
        for robot in robots:
            if robot.must_charge or robot.is_out_of_order:
                continue
            room = self._chargers[robot.charger].capacity if robot.charger else None
            is_awaited = room is not None and taken[robot.charger] > room  # a robot waits at its border
            if (waiters or is_awaited) and robot.phase == AT_CHARGER and robot.tried_now.get(HOME) != now_ns and (
                    not robot.is_below(self._settings.charge_full or 0.0)):
                if is_awaited:
                    taken[robot.charger] -= 1
                else:
                    waiters.pop()
                self.leave(robot)
                if not self._parking.go(robot, robots, now_ns):
                    self._send(robot, robot.home, robot.new_id('home', now_ns))
                    robot.phase = HOMING
            elif robot.phase == FREE and self._settings.charge_when_idle and not waiters and robot.is_below(
                    self._settings.charge_when_idle):
                charger = self._nearest(robot, robots, now_ns)
                if charger is not None:
                    self._go(robot, charger, rows.IDLE, now_ns)

    def _go(self, robot: RobotState, charger: Charger, why: str, now_ns: int) -> None:
        robot.phase, robot.charger, robot.awaits_charger_since = TO_CHARGER, charger.name, None
        self._tell(robot.name, 'charge_assigned', charger.name, why)
        self._send(robot, charger.pose, robot.new_id('charge', now_ns))

    def _nearest(self, robot: RobotState, robots: Sequence[RobotState], now_ns: int) -> Optional[Charger]:
        taken = _taken(robots)
        found: List[Tuple[Any, ...]] = []
        for index, charger in enumerate(self._chargers.values()):
            if (charger.capacity is not None and taken.get(charger.name, 0) >= charger.capacity) or (
                    robot.tried_now.get(charger.name) == now_ns):
                continue
            away = self._distance(robot.name, robot.at, (charger.pose.x, charger.pose.y))
            if away is not None:
                found.append((away, index, charger))
        return min(found)[2] if found else None


def _taken(robots: Sequence[RobotState]) -> Dict[str, int]:
    """Return {charger: the number of robots that are there or on their way}."""
    taken: Dict[str, int] = {}
    for one in robots:
        if one.charger:
            taken[one.charger] = taken.get(one.charger, 0) + 1
    return taken
