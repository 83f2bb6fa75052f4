"""What a robot is doing, in a word or two, for people."""

import math

_LONGEST = 40  # characters


def activity(navigator, condition, tasks=None):
    """Return what the robot of ``navigator`` (Navigator) does, in a word or two.

    One of failed, held, travelling, working, waiting, charging, idle, and how it has failed, or for what it is held.
    ``condition``: its Condition; ``tasks``: its PlaceTaskRunner, if it has one. Where several hold the first of them is
    told. Of one with a battery its charge follows, in whole percent.
    """
    doing = _doing(navigator, condition, tasks)
    if condition.battery is None:
        return doing
    return '{}, {} %'.format(doing, math.ceil(100.0 * condition.battery.soc))


def _doing(navigator, condition, tasks):
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


def shortened(text):
    """Return a text of at most 40 characters."""
    return text if len(text) <= _LONGEST else text[:_LONGEST - 3] + '...'
