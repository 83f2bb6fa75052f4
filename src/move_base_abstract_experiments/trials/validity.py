"""Count the goals of robots that lay outside of what was recorded for their calibrations, from the event log alone."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Set, Tuple

#: the ways in which a goal can lie outside, see move_base_abstract.motion.recorded_range
BEYOND = ('longer', 'shorter', 'turn', 'narrow')
ROBOT_VALUES = ('goals_begun', 'goals_beyond', *(f'goals_beyond_{what}' for what in BEYOND))


class Validity:
    """The counts of goals, from the rows ``recorded``, ``beyond``, ``departed`` and ``ended`` of a log."""

    def __init__(self) -> None:
        self._counts: Dict[str, Dict[str, float]] = {}  # of robots whose log has a row `recorded`
        self._under_way: Set[str] = set()  # the robots with a goal for which they have departed; never iterated

    def take(self, robot: str, kind: str, values: List[Any]) -> None:
        """Count a row; ``values`` is its list."""
        if kind == 'recorded':
            self._counts.setdefault(robot, dict.fromkeys(ROBOT_VALUES, 0))
        elif kind == 'ended':
            self._under_way.discard(robot)
        elif robot in self._counts and kind == 'departed' and robot not in self._under_way:
            self._under_way.add(robot)
            self._counts[robot]['goals_begun'] += 1
        elif robot in self._counts and kind == 'beyond':
            self._counts[robot]['goals_beyond'] += 1
            for what in BEYOND:
                self._counts[robot][f'goals_beyond_{what}'] += what in values

    def of_robot(self, robot: str) -> Dict[str, float]:
        """Return {one of ROBOT_VALUES: number}; {} for a robot without a row `recorded`."""
        return self._counts.get(robot, {})

    def goals(self) -> Optional[Tuple[float, float]]:
        """Return the number of goals, and of those outside; None if no robot has a row `recorded`."""
        if not self._counts:
            return None
        begun = sum(counts['goals_begun'] for counts in self._counts.values())
        return begun, sum(counts['goals_beyond'] for counts in self._counts.values())
