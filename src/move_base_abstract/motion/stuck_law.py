"""How real robots get stuck: chances and times from the section ``stuck`` of a calibration.

Two robots that meet may touch each other and stay there; a robot may stay where its way passes an obstacle closely. A
robot that is stuck gives up each goal after some seconds, or keeps its goal and stands.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping, Optional, Tuple

from ..common.kinds import Pairs, ascending_pairs, number, string
from ..common.parameter_table import Parameter, read_mapping
from ..engine.chance import Purpose
from ..engine.factors import along

_CHANCES = ascending_pairs(number(0.0, 100.0), number(0.0, 1.0))
_SECONDS = number(0.001, 1e9, unit='s')
#: the numbers of the draws of an encounter: whether both robots get stuck, and whether each keeps its goal
_STUCK, _KEEPS = 6, (7, 8)

TABLE = (
    Parameter('source', None, string('a text')),
    Parameter('patience', None, _SECONDS),
    Parameter('by_nearest', (), _CHANCES,
              allowed='a list of [nearest distance of two robots that meet [m], chance in 0..1], the distances '
              'ascending'),
    Parameter('keep_chance', 0.0, number(0.0, 1.0)),
    Parameter('by_clearance', (), _CHANCES,
              allowed='a list of [clearance in 0..100 [m], chance in 0..1], the clearances ascending'),
    Parameter('free_mean', None, _SECONDS),
)


@dataclass(frozen=True)
class StuckLaw:
    """How robots get stuck, and how that ends.

    ``source``: a line of text that says where the law comes from; ``patience`` [s]: the time after which a robot that
    is stuck gives up a goal; ``by_nearest``: ((smallest distance of two robots that meet [m], chance that both get
    stuck), ...); ``keep_chance``: that such a robot keeps its goal instead; ``by_clearance``: ((clearance of the way
    [m], chance to get stuck there), ...); ``free_mean`` [s]: the mean time after which a robot comes free by itself,
    None: it does not. Without pairs the law says nothing of that cause.
    """

    source: str
    patience: float
    by_nearest: Pairs = ()
    keep_chance: float = 0.0
    by_clearance: Pairs = ()
    free_mean: Optional[float] = None

    def draw(self, nearest: float, uniform: Callable[[Purpose, int], float]) -> Optional[Tuple[bool, bool]]:
        """Return whether each of two robots that meet keeps its goal while it is stuck; None: they do not get stuck.

        The law needs ``by_nearest``. ``nearest`` [m]: the smallest distance between them; ``uniform(purpose, place)``
        gives the draws in (0, 1).
        """
        if uniform(Purpose.ENCOUNTER, _STUCK) >= along(self.by_nearest, nearest):
            return None
        first, second = (uniform(Purpose.ENCOUNTER, place) < self.keep_chance for place in _KEEPS)
        return first, second


def make_stuck_law(raw: Mapping[str, Any], where: str) -> StuckLaw:
    """Return the :class:`StuckLaw` in the mapping ``raw``.

    :raises ConfigurationError: if a value is missing, unknown or not allowed; the text begins with ``where``.
    """
    return StuckLaw(**read_mapping(raw, TABLE, f'{where}: stuck', ('source', 'patience')))
