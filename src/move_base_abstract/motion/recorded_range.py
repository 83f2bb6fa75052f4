"""The ranges of the legs to which a calibration was fitted, and which goals lie outside them."""
from __future__ import annotations

import math
import re
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Tuple, Union

from ..common.kinds import number, numbers
from ..common.parameter_table import Parameter, read_table

#: (lowest value, highest value)
Range = Tuple[float, float]
Points = Sequence[Tuple[float, float]]

HELD = 'held by the prior'
#: logged once by a fleet or a node, for the first such goal; formatted with (robot, Recorded.words)
WARNING = '{}: a goal lies outside the ranges to which its calibration was fitted ({}); this warning comes once, but ' \
          'event logs have a row beyond for each such goal'
_NAME = re.compile(r'[a-z][a-z0-9_]*')
_DEGREE = math.radians(1.0)  # a turn may be larger than the largest recorded one by this: none was exactly 180 degrees
_SLACK = 1e-9  # a recorded leg may lie outside by this: rounding of its length


class Recorded(NamedTuple):
    """The ranges of the recorded legs.

    ``length`` [m] of their ways; ``start_turn`` [rad]: their first turns; ``clearance`` [m]: the distance of their ways
    from occupied cells, None: unknown; ``tolerance`` [m]: the distance before its goal at which a leg ends.
    """

    length: Range
    start_turn: Range
    clearance: Optional[Range] = None
    tolerance: float = 0.0

    def beyond(self, leg: Any, clearance_of: Callable[[Points], Optional[float]]) -> Tuple[Union[str, float], ...]:
        """Return the ways in which ``leg`` (PhasedRoute) lies outside the ranges: kind, value, kind, value, ...

        The kinds are 'longer', 'shorter', 'turn' and 'narrow'; lengths are in m, the turn in rad.
        ``clearance_of(points)`` returns the clearance [m] of a way of straight pieces, None: there is no map.
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
        """Return the ranges as in an event log: name, low, high, name, low, high, ..."""
        named = ('length', self.length), ('start_turn', self.start_turn), ('clearance', self.clearance)
        return tuple(value for name, both in named if both is not None for value in (name, *both))

    def words(self, found: Tuple[Union[str, float], ...]) -> str:
        """Return a text for ``found``, a result of :meth:`beyond`."""
        texts: Dict[Any, Tuple[str, float, Range]] = {
            'longer': ('a way of {:.2f} m, recorded: {:.2f} to {:.2f} m', 1.0, self.length),
            'shorter': ('a way of {:.2f} m, recorded: {:.2f} to {:.2f} m', 1.0, self.length),
            'turn': ('a turn of {:.0f} degrees at the start, recorded: {:.0f} to {:.0f}', 180.0 / math.pi,
                     self.start_turn),
            'narrow': ('{:.2f} m to an occupied cell, recorded: {:.2f} to {:.2f} m', 1.0,
                       self.clearance or (0.0, 0.0))}
        return '; '.join(texts[kind][0].format(*(scale * float(part) for part in (value, *texts[kind][2])))
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
    Parameter('length', None, _range(1e6), allowed='a list [low, high] [m], both >= 0'),
    Parameter('start_turn', None, _range(3.15), allowed='a list [low, high] in 0..3.15 [rad]'),
    Parameter('clearance', None, _range(1e6), allowed='a list [low, high] [m], both >= 0'),
)


def read_recorded(value: Any) -> Recorded:
    """Return the :class:`Recorded` in a section of a calibration; this is the converter of a Parameter.

    :raises ValueError: if ``value`` is not a mapping with the right keys.
    """
    if not isinstance(value, dict) or not {'length', 'start_turn'} <= set(value) <= {one.name for one in _TABLE}:
        raise ValueError
    return Recorded(**read_table(value, _TABLE, 'recorded'))


def read_intervals(value: Any) -> Dict[str, Union[str, Range]]:
    """Return {parameter: (low, high) or HELD} of a section of a calibration; this is the converter of a Parameter.

    :raises ValueError: if ``value`` is not a mapping of names to ranges or HELD.
    """
    if not isinstance(value, dict):
        raise ValueError
    found: Dict[str, Union[str, Range]] = {}
    for name, interval in value.items():
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise ValueError
        found[name] = HELD if interval == HELD else _range(1e6)(interval)
    return found
