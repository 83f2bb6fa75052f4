"""What a robot is doing, in a word or two, for people to read."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    from ..faults.condition import Condition
    from ..tasks.place_tasks import PlaceTaskRunner
    from .navigator import Navigator

_LONGEST = 40  # characters


def activity(navigator: Navigator, condition: Condition, tasks: Optional[PlaceTaskRunner] = None) -> str:
    """Return what the robot of ``navigator`` (Navigator) does, in a word or two.

    If the robot has failed, its battery is empty, or it is held, the text says so. Otherwise it is the first that holds
    of travelling, working, waiting, charging, idle. If the robot has a battery, its charge follows in whole percent.
    ``condition``: the robot's Condition; ``tasks``: its PlaceTaskRunner, or None.
    """
    doing = _doing(navigator, condition, tasks)
    if condition.battery is None:
        return doing
    return '{}, {} %'.format(doing, math.ceil(100.0 * condition.battery.soc))


def _doing(navigator: Navigator, condition: Condition, tasks: Optional[PlaceTaskRunner]) -> str:
    if condition.state_text:
        return shortened(condition.state_text)
    if navigator.robot.leg is not None:
        return 'travelling'
    if tasks is not None and tasks.is_working:
        return 'working'
    if navigator.is_active or (tasks is not None and tasks.is_waiting):
        return 'waiting'
    battery = condition.battery
    return 'charging' if battery is not None and battery.charger is not None and battery.soc < 1.0 else 'idle'


def shortened(text: str) -> str:
    """Return ``text``, cut to 40 characters if it is longer."""
    return text if len(text) <= _LONGEST else text[:_LONGEST - 3] + '...'
