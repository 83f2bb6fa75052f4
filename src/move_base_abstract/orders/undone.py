"""What a dispatcher has not done when nothing is left that could happen, and why, in words."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Iterable, Iterator

from ..common.shown import shown_text

if TYPE_CHECKING:
    from .fleet_state import RobotState
    from .policies import OpenOrder, Question


def undone(robots: Iterable[RobotState], orders: Iterable[OpenOrder], refused: Iterable[str],
           why_stands: Callable[[str], str] = lambda _robot: '',
           why_open: Callable[[OpenOrder], str] = lambda _order: '') -> Iterator[str]:
    """Yield a text for each order that is not done, and for each robot that is on its way for none.

    ``why_stands(robot)`` and ``why_open(order)`` return what the texts say of a robot with a goal, and of an open
    order: why it is so, with a comma before it, or nothing.
    """
    for robot in robots:
        if robot.order is not None:
            yield '{} with {}{}'.format(shown_text(robot.order.order.order_id), robot.name, why_stands(robot.name))
        elif robot.goal_id:
            where = 'to charge at ' + robot.charger if robot.charger else (
                'to park at ' + robot.parking if robot.parking else 'home')
            yield '{} on its way {}{}'.format(robot.name, where, why_stands(robot.name))
    for one in orders:
        yield '{} with nobody{}'.format(shown_text(one.order.order_id), why_open(one))
    for order_id in refused:
        yield '{} refused'.format(shown_text(order_id))


def why_open(one: OpenOrder, question: Question) -> str:
    """Return why none of the free robots of ``question`` does an open order."""
    if not question.robots:
        return 'no robot is free'
    there = [robot for robot in question.robots if None not in (
        question.distance(robot.name, *ends) for ends in zip([(robot.x, robot.y), *one.points], one.points))]
    if not there:
        return 'no free robot has a way to its stops'
    if all(question.is_short(robot.name, one) for robot in there):
        return 'no free robot has the charge for it'
    return 'the policy chose no robot'
