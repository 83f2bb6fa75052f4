"""Colours and marks of configurations: the same on the whole page, and distinct also for colour-blind readers.

A colour stands for a level of one factor, a mark for a level of another one.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, List, NamedTuple, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .design import Levels
    from .outcome import Experiment

#: (on white, on black) per level. Any two have a distance of at least 20 (CIELAB), also as seen without red, green or
#: blue cones (Machado, Oliveira and Fernandes 2009), and each has a contrast of at least 3 with the page.
PALETTE = (('#1c49cd', '#8667ff'), ('#df680d', '#f7b624'), ('#007b45', '#148b79'), ('#ad5181', '#a86ec2'),
           ('#633200', '#e6764a'), ('#3a94f6', '#a5e0ff'))
#: the ends and the middle of the ramp for more levels: blue, grey, ochre, which colour-blind readers tell apart, too
_RAMP = ((('#1c49cd', '#7f9dff'), ('#6f7480', '#a9adb8'), ('#a86a00', '#ffc44d')))
MARKS = ('circle', 'square', 'diamond', 'triangle', 'cross', 'wedge')


class Look(NamedTuple):
    """The colour and the mark of a configuration or a level."""

    colour: Optional[int]  # the number N of the class cN of the page; None: the colour of the page's text
    mark: str  # one of MARKS


class Looks:
    """The Looks of an experiment's configurations.

    The factor that gives the colours is the first one with few levels that are not numbers. If there is none, it is the
    first one with few levels, otherwise the first one that varies. The next factor with few levels gives the marks.
    """

    def __init__(self, experiment: Experiment) -> None:
        self._factors = experiment.factors
        varied = [place for place, factor in enumerate(self._factors) if len(factor.levels) > 1]
        few = [place for place in varied if len(self._factors[place].levels) <= len(PALETTE)]
        few.sort(key=lambda place: self._factors[place].is_numeric)
        self.colour_factor: Optional[int] = next(iter(few or varied), None)
        rest = [place for place in few if place != self.colour_factor]
        self.mark_factor = rest[0] if rest else None
        count = 1 if self.colour_factor is None else len(self._factors[self.colour_factor].levels)
        self.colours = palette(count)  # (on white, on black) per number

    def of_levels(self, levels: Levels) -> Look:
        """Return the Look of a configuration by the places of its levels."""
        colour = levels[self.colour_factor] if self.colour_factor is not None else 0
        mark = levels[self.mark_factor] if self.mark_factor is not None else 0
        return Look(colour or 0, MARKS[mark or 0])

    def of_level(self, factor: int, level: int) -> Look:
        """Return the Look of a level of a factor; a colour of None is the text's own."""
        is_colour = factor == self.colour_factor
        return Look(level if is_colour else None,
                    MARKS[level % len(MARKS)] if factor == self.mark_factor or not is_colour else MARKS[0])


def palette(count: int) -> Tuple[Tuple[str, str], ...]:
    """Return ``count`` colours, each a pair (on white, on black)."""
    if count <= len(PALETTE):
        return PALETTE[:count]
    ramps = [[stop[mode] for stop in _RAMP] for mode in (0, 1)]
    return tuple((_between(ramps[0], place / (count - 1)), _between(ramps[1], place / (count - 1)))
                 for place in range(count))


def _between(stops: Sequence[str], share: float) -> str:
    """Return the colour at a share (0 to 1) of the way along the stops."""
    position = share * (len(stops) - 1)
    place = min(int(position), len(stops) - 2)
    part = position - place
    return '#' + ''.join(f'{round((1.0 - part) * one + part * two):02x}'
                         for one, two in zip(_channels(stops[place]), _channels(stops[place + 1])))


def _channels(colour: str) -> List[int]:
    return [int(colour[at:at + 2], 16) for at in (1, 3, 5)]
