"""All checks of a scenario; that of goals beyond what a calibration was fitted to is here."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Iterator, List, Sequence, Tuple

from .capacity_check import check_capacities
from .charge_check import check_charge
from .findings import Finding, in_order
from .ground_check import check_ground
from .net_check import check_net
from .passing_check import check_passing
from .ways import MOST_WAYS, leg_between, too_many

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
            yield too_many(world, 'calibration', '{} starts and places are'.format(len(begins)))
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


_CHECKS = (check_ground, check_net, check_charge, check_capacities, check_passing, check_range)


def findings_of(world: World) -> List[Finding]:
    """Return all findings in a :class:`.World`: [:class:`.Finding`, ...] in the order of KINDS."""
    findings: List[Any] = []
    for check in _CHECKS:
        try:
            findings += check(world)
        except (ArithmeticError, ValueError, MemoryError) as error:  # numbers from which no way can be computed
            findings.append(Finding('not_checked', check.__name__, 'its numbers cannot be computed with: {}'.format(
                error or type(error).__name__), os.path.basename(world.path),
                'bring places and limits into the range of real ones'))
    return in_order(findings)
