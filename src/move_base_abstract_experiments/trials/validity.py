"""How many goals of a robot lay outside of what its calibration was fitted to, from the event log alone."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Set

#: what a goal can be, see move_base_abstract.motion.recorded_range
BEYOND = ('longer', 'shorter', 'turn', 'narrow')
ROBOT_VALUES = ('goals_begun', 'goals_beyond', *(f'goals_beyond_{what}' for what in BEYOND))


class Validity:
    """The rows ``recorded``, ``beyond``, ``departed`` and ``ended`` of a log, taken one after another."""

    def __init__(self) -> None:
        self._counts: Dict[str, Dict[str, float]] = {}  # of robots that have said what was recorded
        self._under_way: Set[str] = set()  # robots with a goal that they have set out for; only looked into

    def take(self, robot: str, kind: str, values: List[Any]) -> None:
        """Take a row; ``values`` is its list."""
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
        """Return {one of ROBOT_VALUES: number}, {} of a robot that has not said what was recorded."""
        return self._counts.get(robot, {})

    def metrics(self) -> Dict[str, Optional[float]]:
        """Return {'goals_beyond': the share of all goals [%]}, {} where no robot has said what was recorded."""
        begun = sum(counts['goals_begun'] for counts in self._counts.values())
        beyond = sum(counts['goals_beyond'] for counts in self._counts.values())
        return {'goals_beyond': 100.0 * beyond / begun if begun else None} if self._counts else {}
