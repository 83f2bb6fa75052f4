"""Look ahead: whether a robot's charge is enough for an order, and for the way to a charger after it.

All charges are whole millionths of a full battery. They count driving as fast as the robot may, its work, and what it
always draws, but no waiting and no turning. The reserve is for these.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Iterable, List, Mapping, Optional, Sequence

from .order import Order
from .policies import Distance, OpenOrder, Point

if TYPE_CHECKING:
    from .fleet_state import RobotState

FULL = 1_000_000
#: (way [mm], time of work [s], energy of the work [J]) -> the share of a full battery that they take
Takes = Callable[[int, float, float], float]


def in_millionths(share: float) -> int:
    """Return a state of charge, or a part of a battery, as a whole number."""
    return round(FULL * share)


class LookAhead:
    """What robots need.

    ``reserve``: the state of charge that must be left; ``chargers``: where they are [m]; ``takes``: {robot: Takes} of
    the robots that have a battery.
    """

    def __init__(self, reserve: float, chargers: Sequence[Point], distance: Distance,
                 takes: Mapping[str, Takes]) -> None:
        self._reserve = in_millionths(reserve)
        self._chargers = chargers
        self._distance = distance
        self._takes = takes

    def is_short(self, robot: RobotState, one: OpenOrder) -> bool:
        """Return whether the robot lacks the charge for an order; of one that has an order this is not known: False."""
        if robot.charge is None or robot.order is not None:
            return False
        need = self._need(robot, one)
        return need is not None and robot.charge < need + self._reserve

    def may_visit(self, robot: RobotState, place: Point) -> bool:
        """Return whether the robot has the charge for the way to a place, and for that from there to a charger."""
        if robot.charge is None:
            return True
        there, back = self._distance(robot.name, robot.at, place), self._of_way(robot.name, place)
        if there is None or back is None:
            return False
        return robot.charge >= in_millionths(self._takes[robot.name](there, 0.0, 0.0)) + back + self._reserve

    def cannot_finish(self, robot: RobotState) -> bool:
        """Return whether a robot stands for an order that it can no longer finish, the reserve included."""
        one = robot.order
        if robot.charge is None or one is None or robot.moves or robot.works or robot.is_out_of_order:
            return False
        need = self._of_order(robot.name, robot.at, one.order, robot.stop)
        return need is not None and robot.charge < need

    def must_go(self, robot: RobotState) -> bool:
        """Return whether a robot that stands without an order must go while its charge is enough for the way."""
        if robot.charge is None or robot.order is not None or robot.moves:
            return False
        need = self._of_way(robot.name, robot.at)
        return need is not None and robot.charge < need + self._reserve

    def wanted(self, robot: RobotState, orders: Iterable[OpenOrder]) -> int:
        """Return the charge that the robot needs for one of ``orders``; 0: it needs no more for one, or none helps."""
        if robot.charge is None:
            return 0
        needs: List[int] = []
        for one in orders:
            if self.is_short(robot, one):
                need = self._need(robot, one) if robot.is_charging else (
                    self._from_charger(robot.name, one.order, one.next_stop))
                if need is not None and need + self._reserve <= FULL:
                    needs.append(need + self._reserve)
            elif self._need(robot, one) is not None:
                return 0
        return min(needs, default=0)

    def fault_of(self, order: Order, robots: Iterable[RobotState]) -> Optional[str]:
        """Return a text if no robot can do the order even with a full battery, otherwise None."""
        least: Optional[int] = None
        for robot in robots:
            need = 0 if robot.charge is None else self._from_charger(robot.name, order, 0)
            if need is not None:
                if need + self._reserve <= FULL:
                    return None
                least = need if least is None else min(least, need)
        left = ', and {:g} must be left'.format(self._reserve / FULL) if self._reserve else ''
        return None if least is None else (
            'charge: from a charger to its stops and back to one takes {:.2f} of a full battery{}'.format(
                least / FULL, left))

    def _need(self, robot: RobotState, one: OpenOrder) -> Optional[int]:
        """Return what an order takes of a robot from where it is: on its way, from the worse one of the way's ends."""
        begins = (robot.at, robot.bound_for) if robot.moves else (robot.at,)
        needs = [self._of_order(robot.name, begin, one.order, one.next_stop) for begin in begins]
        return max((need for need in needs if need is not None), default=None)

    def _of_way(self, robot: str, begin: Point) -> Optional[int]:
        """Return what the way to the nearest charger takes; None: no way leads to one."""
        ways = [way for way in (self._distance(robot, begin, charger) for charger in self._chargers) if way is not None]
        return in_millionths(self._takes[robot](min(ways), 0.0, 0.0)) if ways else None

    def _of_order(self, robot: str, begin: Point, order: Order, first: int) -> Optional[int]:
        """Return what the stops from number ``first`` on take, and the way to a charger; None: there is no way."""
        takes, share = self._takes[robot], 0.0
        for stop in order.stops[first:]:
            end = stop.pose.x, stop.pose.y
            way = self._distance(robot, begin, end)
            if way is None:
                return None
            seconds = stop.duration_ns / 1e9
            share += takes(way, seconds, stop.power * seconds + stop.energy)
            begin = end
        back = self._of_way(robot, begin)
        return None if back is None else in_millionths(share) + back

    def _from_charger(self, robot: str, order: Order, first: int) -> Optional[int]:
        needs = (self._of_order(robot, charger, order, first) for charger in self._chargers)
        return min((need for need in needs if need is not None), default=None)
