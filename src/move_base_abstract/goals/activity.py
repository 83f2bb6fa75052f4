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
