"""All checks of a scenario."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List

from .capacity_check import check_capacities
from .charge_check import check_charge
from .findings import Finding, in_order
from .ground_check import check_ground
from .net_check import check_net
from .range_check import check_range

if TYPE_CHECKING:
    from .world import World

_CHECKS = (check_ground, check_net, check_charge, check_capacities, check_range)


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
