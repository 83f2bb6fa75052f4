"""The range of the legs to which a calibration was fitted, and which goals lie outside of it."""
from __future__ import annotations

import math
import re
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Tuple, Union

from ..common.parameter_table import Parameter, number, numbers, read_table

#: from the lowest to the highest
Range = Tuple[float, float]
Points = Sequence[Tuple[float, float]]

HELD = 'held by the prior'
#: said once by a fleet, and by a node, of the first goal: (robot, Recorded.words)
WARNING = '{}: a goal lies outside of what its calibration was fitted to ({}); this is said once, event logs have a ' \
          'row beyond for each'
_NAME = re.compile(r'[a-z][a-z0-9_]*')
_DEGREE = math.radians(1.0)  # by which a turn is as large as the largest: of turns up to 180 none is just that
_SLACK = 1e-9  # by which a leg that was recorded may lie outside: digits of its length


class Recorded(NamedTuple):
    """The ranges of what was recorded; ``tolerance`` [m]: how far before its goal a leg ends.

    ``length`` [m] of ways, ``start_turn`` [rad], ``clearance`` [m] of ways to what is occupied; None: nobody says.
    """

    length: Range
    start_turn: Range
    clearance: Optional[Range] = None
    tolerance: float = 0.0

    def beyond(self, leg: Any, clearance_of: Callable[[Points], Optional[float]]) -> Tuple[Union[str, float], ...]:
        """Return in what ``leg`` (PhasedRoute) lies outside: 'longer', 'shorter', 'turn', 'narrow', each with a value.

        Lengths in m, the turn in rad. ``clearance_of(points)`` is that of a way of straight pieces [m], None: there is
        no map.
        """
        length = leg.distance + self.tolerance if leg.distance > 0.0 else 0.0
        turn = abs(leg.start_turn)
        found: Tuple[Union[str, float], ...] = ()
        if length > self.length[1] + _SLACK:
            found += 'longer', length
        if length < self.length[0] - _SLACK:
            found += 'shorter', length
        if turn > self.start_turn[1] + _DEGREE:
            found += 'turn', turn
        clearance = None if self.clearance is None else clearance_of(leg.way)
        if self.clearance is not None and clearance is not None and clearance < self.clearance[0] - _SLACK:
            found += 'narrow', clearance
        return found

    def row(self) -> Tuple[Union[str, float], ...]:
        """Return the ranges as an event log has them: name, low, high, one after the other."""
        named = ('length', self.length), ('start_turn', self.start_turn), ('clearance', self.clearance)
        return tuple(value for name, both in named if both is not None for value in (name, *both))

    def words(self, found: Tuple[Union[str, float], ...]) -> str:
        """Return what :meth:`beyond` has found, in words."""
        texts: Dict[Any, Tuple[str, float, Range]] = {
            'longer': ('a way of {:.2f} m, recorded: {:.2f} to {:.2f} m', 1.0, self.length),
            'shorter': ('a way of {:.2f} m, recorded: {:.2f} to {:.2f} m', 1.0, self.length),
            'turn': ('a turn of {:.0f} degrees at the start, recorded: {:.0f} to {:.0f}', 180.0 / math.pi,
                     self.start_turn),
            'narrow': ('{:.2f} m to what is occupied, recorded: {:.2f} to {:.2f} m', 1.0,
                       self.clearance or (0.0, 0.0))}
        return '; '.join(texts[kind][0].format(*(scale * part for part in (value, *texts[kind][2])))
                         for kind, value in zip(found[::2], found[1::2]) for scale in [texts[kind][1]])


def _range(high: float) -> Callable[[object], Range]:
    single = number(0.0, high)

    def convert(value: object) -> Range:
        low, most = (single(part) for part in numbers(2)(value))
        if low > most:
            raise ValueError
        return low, most
    return convert


_TABLE = (
    Parameter('length', None, _range(1e6), 'a list [low, high] [m], both >= 0'),
    Parameter('start_turn', None, _range(3.15), 'a list [low, high] in 0..3.15 [rad]'),
    Parameter('clearance', None, _range(1e6), 'a list [low, high] [m], both >= 0'),
)


def read_recorded(value: Any) -> Recorded:
    """Return the :class:`Recorded` of a calibration's section, a converter of a Parameter."""
    if not isinstance(value, dict) or not {'length', 'start_turn'} <= set(value) <= {one.name for one in _TABLE}:
        raise ValueError
    return Recorded(**read_table(value, _TABLE, 'recorded'))


def read_intervals(value: Any) -> Dict[str, Union[str, Range]]:
    """Return {parameter: (low, high), or HELD} of a calibration's section, a converter of a Parameter."""
    if not isinstance(value, dict):
        raise ValueError
    found: Dict[str, Union[str, Range]] = {}
    for name, interval in value.items():
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise ValueError
        found[name] = HELD if interval == HELD else _range(1e6)(interval)
    return found
