"""What a robot is doing, in a word or two, for people to read."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Optional

from ..common.shown import cut
from ..runs.states import STATES

if TYPE_CHECKING:
    from ..faults.condition import Condition
    from ..tasks.place_tasks import PlaceTaskRunner
    from .navigator import Navigator

_LONGEST = 40  # characters


def activity(navigator: Navigator, condition: Condition, tasks: Optional[PlaceTaskRunner] = None) -> str:
    """Return what the robot of ``navigator`` (Navigator) does, in a word or two.

    If the robot has failed, its battery is empty, or it is held, the text says so. Otherwise it is the state with the
    lowest precedence of those that hold. If the robot has a battery, its charge follows in whole percent.
    ``condition``: the robot's Condition; ``tasks``: its PlaceTaskRunner, or None.
    """
    doing = _doing(navigator, condition, tasks)
    if condition.battery is None:
        return doing
    return '{}, {} %'.format(doing, math.ceil(100.0 * condition.battery.soc))


def _doing(navigator: Navigator, condition: Condition, tasks: Optional[PlaceTaskRunner]) -> str:
    if condition.state_text:
        return cut(condition.state_text, _LONGEST)
    works, waits = (False, False) if tasks is None else (tasks.is_working, tasks.is_waiting)
    battery = condition.battery
    holds = {'driving': navigator.robot.leg is not None, 'working': works, 'waiting': navigator.is_active or waits,
             'charging': battery is not None and battery.charger is not None and battery.soc < 1.0, 'idle': True}
    return min((state for state in STATES if holds.get(state.name)), key=lambda state: state.precedence).name


def emptied(navigator: Navigator, tasks: Optional[PlaceTaskRunner], now_ns: int) -> str:
    """Return a warning that the battery is empty: where the robot is, and what it was about to do.

    Call it at that instant, ``now_ns`` [ns], before anything ends because of it.
    """
    pose, travel = navigator.robot.pose_at(now_ns), navigator.travel
    place = '' if tasks is None else tasks.place
    if navigator.robot.leg is not None:
        doing = 'driving' if travel.target is None else 'on its way to ({:g}, {:g})'.format(
            travel.target.x, travel.target.y)
    elif travel.held_for and navigator.is_active:
        doing = 'held on its way for ' + ', '.join(travel.held_for)
    elif tasks is not None and tasks.is_waiting:
        doing = 'waiting for room at place ' + place
    elif tasks is not None and tasks.is_working:
        doing = 'working at place ' + place if place else 'working'
    else:
        doing = 'without anything to do'
    return 'The battery is empty at ({:g}, {:g}); the robot was {}.'.format(round(pose.x, 3), round(pose.y, 3), doing)
