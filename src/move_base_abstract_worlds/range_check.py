"""Check for goals beyond what a calibration was fitted to: too far, too near, with too large a turn, too narrow."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Iterator, Sequence, Tuple

from .findings import Finding
from .ways import MOST_WAYS, leg_between

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D
    from move_base_abstract.motion.recorded_range import Recorded

    from .world import Drivers, Target, World


def check_range(world: World) -> Iterator[Finding]:
    """Yield a :class:`.Finding` for each target to which some legs from starts or other targets are beyond."""
    for drivers in world.drivers:
        recorded = getattr(drivers.settings.durations, 'recorded', None)
        if recorded is None or drivers.planner is None:
            continue
        begins = [(start.spec.name, start.spec.settings.start) for start in drivers.starts]
        begins += [(target.name, target.pose) for target in world.targets]
        if len(begins) * len(world.targets) > MOST_WAYS:
            yield Finding('not_checked', 'calibration', '{} starts and places are more than {} ways'.format(
                len(begins), MOST_WAYS), os.path.basename(world.path), 'check a scenario with fewer of them')
            continue
        for target in world.targets:
            yield from _of_target(drivers, recorded, begins, target)


def _of_target(drivers: Drivers, recorded: Recorded, begins: Sequence[Tuple[str, Pose2D]],
               target: Target) -> Iterator[Finding]:
    found, count = '', 0
    for name, pose in begins:
        leg = None if pose is target.pose else leg_between(drivers, pose, target.pose)
        beyond = () if leg is None else recorded.beyond(leg, drivers.planner.clearance_of)
        if beyond:
            count += 1
            found = found or 'from {}: {}'.format(name, recorded.words(beyond))
    if found:
        yield Finding('beyond_calibration', '{} {}'.format(target.what, target.name), '{} of {} ways there, from '
                      'starts and places, lie beyond what the calibration was fitted to; {}'.format(
                          count, len([pose for _, pose in begins if pose is not target.pose]), found), target.where,
                      'take predictions of these with care, or calibrate with recordings of such ways', (target.xy,))
