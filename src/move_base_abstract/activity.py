"""What a robot is doing, in a word or two, for those who look at it."""

_LONGEST = 40  # characters


def activity(navigator, condition, tasks=None):
    """Return what the robot of ``navigator`` (Navigator) does: failed, held, travelling, working, waiting, idle.

    ``condition``: its Condition; ``tasks``: its PlaceTaskRunner, if it has one. Where several hold the first of them is
    told; with failed and held how, and for what.
    """
    if condition.state_text:
        return shortened(condition.state_text)
    if navigator.robot.leg is not None:
        return 'travelling'
    if tasks is not None and tasks.is_working:
        return 'working'
    if navigator.is_active or (tasks is not None and tasks.is_waiting):
        return 'waiting'
    return 'idle'


def shortened(text):
    """Return a text of at most 40 characters."""
    return text if len(text) <= _LONGEST else text[:_LONGEST - 3] + '...'
