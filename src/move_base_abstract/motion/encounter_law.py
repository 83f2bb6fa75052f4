"""What it costs a robot to meet another one: chances and times, from the section ``encounters`` of a calibration."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, Mapping, NamedTuple, Optional, Tuple

from ..common.errors import ConfigurationError
from ..common.parameter_table import Pairs, Parameter, ascending_pairs, number, read_table, text
from ..common.shown import shown
from ..engine.chance import Purpose
from ..engine.factors import Gamma, Lognormal, along

#: how two robots meet
HEAD_ON, CROSSING, OVERTAKING, STANDING = KINDS = ('head_on', 'crossing', 'overtaking', 'standing')
_CHANCES = ascending_pairs(number(0.0, 1000.0), number(0.0, 1.0))
_CHANCE = number(0.0, 1.0)
_SECONDS = number(0.001, 86400.0)
_CV = number(0.01, 10.0)
_REQUIRED = object()
_OF_CHANCE, _OF_SECONDS, _OF_CV = 'a number in 0..1', 'a number in 0.001..86400 [s]', 'a number in 0.01..10'
_OF_CHANCES = 'a list of [nearest distance [m], chance in 0..1], the distances >= 0 and ascending'


def _row(name: str, convert: Callable[[Any], Any], allowed: str) -> Parameter:
    return Parameter(name, _REQUIRED, convert, allowed)


TABLE = (
    _row('source', text, 'a text'),
    _row('radius', number(0.01, 1000.0), 'a number in 0.01..1000 [m]'),
    *(_row('chance_' + kind, _CHANCES, _OF_CHANCES) for kind in KINDS),
    _row('both_chance', _CHANCE, _OF_CHANCE),
    _row('delay_mean', _SECONDS, _OF_SECONDS),
    _row('delay_cv', _CV, _OF_CV),
    _row('block_chance', _CHANCE, _OF_CHANCE),
    _row('block_mean', _SECONDS, _OF_SECONDS),
    _row('block_cv', _CV, _OF_CV),
    _row('abort_chance', _CHANCE, _OF_CHANCE),
    _row('narrow_below', number(0.0, 1000.0), 'a number in 0..1000 [m]'),
    _row('narrow_weight', number(0.01, 100.0), 'a number in 0.01..100'),
)


class Cost(NamedTuple):
    """What an encounter costs the two robots: how long each stands [s], 0 = not at all; ``aborts``: then gives up."""

    seconds: Tuple[float, float]
    aborts: bool


NO_COST = Cost((0.0, 0.0), False)


@dataclass(frozen=True)
class EncounterLaw:
    """What happens when two robots come within ``radius`` [m] of one another.

    ``chances``: {kind: ((nearest distance [m], chance that it costs anything), ...)}; where the free space around them
    is narrower than ``narrow_below`` [m] the chance p becomes 1 - (1 - p)^``narrow_weight``. Then with ``both_chance``
    both have to stand, else one of them. That takes the Lognormal ``delay`` [s], or with ``block_chance`` the Gamma
    ``block`` [s], of which ``abort_chance`` end in giving up.
    """

    source: str
    radius: float
    chances: Tuple[Tuple[str, Pairs], ...]
    both_chance: float
    delay: Lognormal
    block_chance: float
    block: Gamma
    abort_chance: float
    narrow_below: float
    narrow_weight: float

    def chance(self, kind: str, nearest: float, width: Optional[float] = None) -> float:
        """Return the chance that an encounter costs anything; ``nearest`` [m], ``width`` [m] of what is free."""
        chance = along(dict(self.chances)[kind], nearest)
        if width is not None and width < self.narrow_below:
            return float(1.0 - (1.0 - chance) ** self.narrow_weight)
        return chance

    def draw(self, chance: float, yields: Tuple[int, ...], uniform: Callable[..., float]) -> Cost:
        """Return the :class:`Cost` of an encounter, drawn from ``uniform(purpose, place)`` in (0, 1).

        ``chance`` as of :meth:`chance`; ``yields``: which of the two, 0 and 1, may be the one that has to stand.
        """
        if not yields or uniform(Purpose.ENCOUNTER, 0) >= chance:
            return NO_COST
        blocks = uniform(Purpose.ENCOUNTER, 1) < self.block_chance
        both = len(yields) == 2 and uniform(Purpose.ENCOUNTER, 2) < self.both_chance
        chosen = yields if both else (yields[int(uniform(Purpose.ENCOUNTER, 3) * len(yields))],)
        times = self.block if blocks else self.delay
        purposes = Purpose.ENCOUNTER_SECONDS, Purpose.ENCOUNTER_SECONDS_OF_OTHER
        first, second = (times.draw(lambda place, purpose=purpose: uniform(purpose, place)) if which in chosen else 0.0
                         for which, purpose in enumerate(purposes))
        return Cost((first, second), blocks and uniform(Purpose.ENCOUNTER, 4) < self.abort_chance)


def make_encounter_law(raw: Mapping[str, Any], where: str) -> EncounterLaw:
    """Return the :class:`EncounterLaw` in the mapping ``raw``.

    :raises ConfigurationError: if a value is missing, unknown or not allowed; the text begins with ``where``.
    """
    names = [parameter.name for parameter in TABLE]
    if not isinstance(raw, dict):
        raise ConfigurationError('{}: encounters: got {}; allowed: a mapping with {}'.format(
            where, shown(raw), ', '.join(names)))
    for wrong, found in (('unknown', [key for key in raw if key not in names]),
                         ('missing', [name for name in names if name not in raw])):
        if found:
            raise ConfigurationError('{}: encounters: {}: {}; allowed: {}'.format(
                where, wrong, ', '.join(map(shown, found[:5])), ', '.join(names)))
    values: Dict[str, Any] = read_table(raw, TABLE, '{}: encounters'.format(where))
    return EncounterLaw(
        values['source'], values['radius'], tuple((kind, values['chance_' + kind]) for kind in KINDS),
        values['both_chance'], Lognormal(values['delay_mean'], values['delay_cv']), values['block_chance'],
        Gamma(values['block_mean'], values['block_cv']), values['abort_chance'], values['narrow_below'],
        values['narrow_weight'])
