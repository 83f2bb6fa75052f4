"""What it costs a robot to meet another one: chances and times from the section ``encounters`` of a calibration."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, Mapping, NamedTuple, Optional, Tuple

from ..common.kinds import Pairs, ascending_pairs, number, string
from ..common.parameter_table import Parameter, read_mapping
from ..engine.chance import Purpose
from ..engine.factors import Gamma, Lognormal, along

#: how two robots meet
HEAD_ON, CROSSING, OVERTAKING, STANDING = KINDS = ('head_on', 'crossing', 'overtaking', 'standing')
_CHANCES = ascending_pairs(number(0.0, 1000.0), number(0.0, 1.0))
_CHANCE = number(0.0, 1.0)
_SECONDS = number(0.001, 86400.0, unit='s')
_CV = number(0.01, 10.0)
_OF_CHANCES = 'a list of [nearest distance [m], chance in 0..1], the distances >= 0 and ascending'


def _chances(value: Any) -> Pairs:
    """Convert one chance for all distances, or pairs of (distance [m], chance)."""
    pairs: Pairs = _CHANCES(value if isinstance(value, list) else [[0.0, value]])
    return pairs


TABLE = (
    Parameter('source', None, string('a text')),
    Parameter('radius', None, number(0.01, 1000.0, unit='m')),
    *(Parameter('chance_' + kind, None, _CHANCES, allowed=_OF_CHANCES) for kind in KINDS),
    Parameter('both_chance', None, _CHANCE),
    Parameter('delay_mean', None, _SECONDS),
    Parameter('delay_cv', None, _CV),
    Parameter('block_chance', None, _chances, allowed=_CHANCE.allowed + ', or ' + _OF_CHANCES),
    Parameter('block_mean', None, _SECONDS),
    Parameter('block_cv', None, _CV),
    Parameter('abort_chance', None, _CHANCE),
    Parameter('long_chance', 0.0, _CHANCE),
    Parameter('long_mean', 600.0, _SECONDS),
    Parameter('narrow_below', None, number(0.0, 1000.0, unit='m')),
    Parameter('narrow_weight', None, number(0.01, 100.0)),
)


class Cost(NamedTuple):
    """What an encounter costs the two robots.

    ``seconds``: the time that each of them stands [s], 0 = not at all; ``aborts``: whether those that stand then give
    up their goals; ``keeps``: if both get stuck, whether each keeps its goal.
    """

    seconds: Tuple[float, float]
    aborts: bool
    keeps: Tuple[bool, ...] = ()


NO_COST = Cost((0.0, 0.0), False)


@dataclass(frozen=True)
class EncounterLaw:
    """What happens when two robots come within ``radius`` [m] of one another.

    ``chances``: ((kind, ((nearest distance [m], chance that the encounter costs anything), ...)), ...). If the free
    space around the robots is narrower than ``narrow_below`` [m], the chance p becomes 1 - (1 - p)^``narrow_weight``.

    If the encounter costs anything, both robots have to stand with ``both_chance``, otherwise one of them. Each stands
    for a time drawn from the Lognormal ``delay`` [s]. With a chance by ``block_chances`` ((nearest distance [m],
    chance), ...) the encounter is a *block*: the time is drawn from the Gamma ``block`` [s], and with ``abort_chance``
    the robot then gives up its goal. The share ``long_chance`` of the blocks is longer: exponential with the mean
    ``long_mean`` [s]; after these no robot gives up.
    """

    source: str
    radius: float
    chances: Tuple[Tuple[str, Pairs], ...]
    both_chance: float
    delay: Lognormal
    block_chances: Pairs
    block: Gamma
    abort_chance: float
    long_chance: float
    long_mean: float
    narrow_below: float
    narrow_weight: float

    def chance(self, kind: str, nearest: float, width: Optional[float] = None) -> float:
        """Return the chance that an encounter of ``kind`` costs anything.

        ``nearest`` [m]: the smallest distance between the robots; ``width`` [m]: that of the free space, None: unknown.
        """
        chance = along(dict(self.chances)[kind], nearest)
        if width is not None and width < self.narrow_below:
            return float(1.0 - (1.0 - chance) ** self.narrow_weight)
        return chance

    def draw(self, chance: float, yields: Tuple[int, ...], uniform: Callable[..., float], nearest: float) -> Cost:
        """Return the :class:`Cost` of an encounter, drawn by ``uniform(purpose, place)`` in (0, 1).

        ``chance``: the result of :meth:`chance`; ``yields``: the numbers (0, 1) of the robots that may have to stand;
        ``nearest`` [m]: the smallest distance between them.
        """
        if not yields or uniform(Purpose.ENCOUNTER, 0) >= chance:
            return NO_COST
        blocks = uniform(Purpose.ENCOUNTER, 1) < along(self.block_chances, nearest)
        both = len(yields) == 2 and uniform(Purpose.ENCOUNTER, 2) < self.both_chance
        chosen = yields if both else (yields[int(uniform(Purpose.ENCOUNTER, 3) * len(yields))],)
        is_long = blocks and uniform(Purpose.ENCOUNTER, 5) < self.long_chance
        purposes = Purpose.ENCOUNTER_SECONDS, Purpose.ENCOUNTER_SECONDS_OF_OTHER

        def seconds(which: int) -> float:
            if which not in chosen:
                return 0.0
            if is_long:
                return -self.long_mean * math.log(uniform(purposes[which], 0))
            return (self.block if blocks else self.delay).draw(lambda place: uniform(purposes[which], place))
        aborts = blocks and not is_long and uniform(Purpose.ENCOUNTER, 4) < self.abort_chance
        return Cost((seconds(0), seconds(1)), aborts)


def make_encounter_law(raw: Mapping[str, Any], where: str) -> EncounterLaw:
    """Return the :class:`EncounterLaw` in the mapping ``raw``.

    :raises ConfigurationError: if a value is missing, unknown or not allowed; the text begins with ``where``.
    """
    values = read_mapping(raw, TABLE, f'{where}: encounters', [row.name for row in TABLE if row.default is None])
    return EncounterLaw(
        values['source'], values['radius'], tuple((kind, values['chance_' + kind]) for kind in KINDS),
        values['both_chance'], Lognormal(values['delay_mean'], values['delay_cv']), values['block_chance'],
        Gamma(values['block_mean'], values['block_cv']), values['abort_chance'], values['long_chance'],
        values['long_mean'], values['narrow_below'], values['narrow_weight'])
