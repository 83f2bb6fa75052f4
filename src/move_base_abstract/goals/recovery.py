"""How long move_base tries before it gives a goal up, and which recovery behaviours it announces meanwhile."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, List, Tuple

from ..common.units import seconds_to_ns

_ROTATION_RATE = 1.0


@dataclass(frozen=True)
class RecoveryBehavior:
    """A recovery behaviour: its name, and how long it takes [s, simulated]."""

    name: str
    seconds: float = 0.0


#: the time [s] of one turn in place at move_base's fastest in-place rotation, 1 rad/s
ROTATION_SECONDS = 2.0 * math.pi / _ROTATION_RATE

DEFAULT_BEHAVIORS = (RecoveryBehavior('conservative_reset'), RecoveryBehavior('rotate_recovery', ROTATION_SECONDS),
                     RecoveryBehavior('aggressive_reset'), RecoveryBehavior('rotate_recovery', ROTATION_SECONDS))
#: the behaviours of move_base with ``clearing_rotation_allowed: false``
BEHAVIORS_WITHOUT_ROTATION = tuple(behavior for behavior in DEFAULT_BEHAVIORS if behavior.name != 'rotate_recovery')


@dataclass(frozen=True)
class RecoveryPolicy:
    """When to give up: ``patience`` [s] of planning, then each of ``behaviors`` followed by as much planning again.

    With ``fast``, all of this is left out: a goal that cannot be reached ends at once.
    """

    fast: bool = True
    patience: float = 5.0
    behaviors: Tuple[RecoveryBehavior, ...] = DEFAULT_BEHAVIORS

    def schedule(self, start_ns: int) -> Tuple[List[Any], int]:
        """Return ([(begin [ns], index of behaviour), ...], when to give up [ns]) for a try from ``start_ns`` [ns]."""
        if self.fast:
            return [], start_ns
        patience_ns = seconds_to_ns(self.patience)
        now_ns = start_ns + patience_ns
        begins = []
        for index, behavior in enumerate(self.behaviors):
            begins.append((now_ns, index))
            now_ns += seconds_to_ns(behavior.seconds) + patience_ns
        return begins, now_ns
