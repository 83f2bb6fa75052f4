"""The motion of robots in the tail, as far as recordings say it: how fast they drive backwards, and how they spin."""
import numpy as np

from .fit import succeeded
from .law import Durations

_LEAST_LEGS = 5  # of each kind
_LATE = 3.0  # s; less may be chance
_LONG = 10.0  # m; on a shorter way, a robot may drive backwards all the way


def tail_motion(values, pairs):
    """Return {'reverse_speed': m/s, 'spin_speed': rad/s} of ``pairs`` [(leg, way)], or None if they do not say it.

    ``values``: those of the fitted calibration. A robot that drives backwards for a time t is late by t (1 - reverse
    speed / top speed); the median over legs counts. A robot that spins has turned by so much more than its way asks
    for; the sums over legs count.
    """
    used = succeeded(pairs)
    late = np.array([leg.duration for leg, _ in used]) - Durations(values, [way for _, way in used]).least
    back = [(extra, leg.reverse) for extra, (leg, way) in zip(late, used)
            if leg.reverse is not None and leg.reverse > _LATE and extra > 0.0 and way.length > _LONG]
    spun = [(extra, leg.turned) for extra, (leg, _) in zip(late, used)
            if leg.turned is not None and leg.reverse is not None and leg.reverse < 1.0 and extra > _LATE]
    if min(len(back), len(spun)) < _LEAST_LEGS:
        return None
    share = float(np.median([extra / reverse for extra, reverse in back]))
    extra, turned = np.sum(spun, axis=0)
    found = {'reverse_speed': values['max_speed'] * (1.0 - share), 'spin_speed': float(turned / extra)}
    return found if min(found.values()) > 0.01 else None
