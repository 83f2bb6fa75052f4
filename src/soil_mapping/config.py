"""What a trial is made of: the mission's parameters, checked at birth."""

import math
from dataclasses import asdict, dataclass, fields
from difflib import get_close_matches
from enum import Enum

from move_base_abstract.errors import ConfigurationError

PUBLISHED_CONFIGURATIONS = (('ssi', 'random'), ('ssi', 'dynamic'), ('rr', 'random'), ('rr', 'dynamic'))


class Allocation(str, Enum):
    """How tasks come to robots: in turn, or to the lowest bid."""

    ROUND_ROBIN = 'rr'
    AUCTION = 'ssi'


class Sampling(str, Enum):
    """Where tasks are made: anywhere, where the map is least certain, or on a 10 x 10 grid at the start."""

    RANDOM = 'random'
    DYNAMIC = 'dynamic'
    GRID = 'grid'


class CoarseCells(str, Enum):
    """What the dynamic sampling calls a coarse cell: a square, or a cluster of grid cells."""

    SQUARES = 'squares'
    CLUSTERS = 'clusters'


@dataclass(frozen=True)
class TrialConfig:
    """The mission of one trial, the same for every engine. Texts are turned into the enums.

    :raises ConfigurationError: if a value cannot be used; the text names the field and what is allowed.
    """

    field: str = 'synthetic'  # 'synthetic', 'meuse' or 'csv:PATH'
    robots: int = 3  # >= 1
    allocation: Allocation = Allocation.AUCTION
    sampling: Sampling = Sampling.DYNAMIC
    budget_s: float = 240.0  # simulated s from the start of the mission, > 0
    dwell_s: float = 1.0  # simulated s that taking a sample lasts, >= 0
    dwell_spread_s: float = 0.0  # a dwell is drawn uniformly from dwell_s -+ this; 0..dwell_s
    speed: float = 2.0  # m/s, > 0: what engines drive at
    cell_m: int = 1  # edge of a cell of truth and map: 1 (324 x 220 cells) or 2 (162 x 110)
    coarse_cells: CoarseCells = CoarseCells.SQUARES
    coarse_m: float = 33.0  # edge of a square coarse cell, > 0

    def __post_init__(self):
        for name, kind in (('allocation', Allocation), ('sampling', Sampling), ('coarse_cells', CoarseCells)):
            object.__setattr__(self, name, _member(kind, name, getattr(self, name)))
        if not isinstance(self.field, str):
            raise ConfigurationError(f"field must be a text such as 'synthetic' or 'csv:PATH', got {self.field!r}")
        if isinstance(self.robots, bool) or not isinstance(self.robots, int) or self.robots < 1:
            raise ConfigurationError(f'robots must be a whole number >= 1, got {self.robots!r}')
        for name, unit in (('budget_s', 's'), ('speed', 'm/s'), ('coarse_m', 'm')):
            if not _finite(getattr(self, name)) or not getattr(self, name) > 0.0:
                raise ConfigurationError(f'{name} must be > 0 {unit} and finite, got {getattr(self, name)!r}')
        if not _finite(self.dwell_s) or self.dwell_s < 0.0:
            raise ConfigurationError(f'dwell_s must be >= 0 s and finite, got {self.dwell_s!r}')
        if not _finite(self.dwell_spread_s) or not 0.0 <= self.dwell_spread_s <= self.dwell_s:
            raise ConfigurationError(f'dwell_spread_s must lie in 0..dwell_s, {self.dwell_s:g} s, '
                                     f'got {self.dwell_spread_s!r}')
        if self.cell_m not in (1, 2) or isinstance(self.cell_m, bool):
            raise ConfigurationError(f'cell_m must be 1 or 2 m, got {self.cell_m!r}')

    def to_dict(self):
        """Return the fields as plain values for JSON."""
        return {name: value.value if isinstance(value, Enum) else value for name, value in asdict(self).items()}

    @classmethod
    def from_dict(cls, values):
        """Return the configuration of a mapping; an unknown key is an error that names the nearest one."""
        known = [field.name for field in fields(cls)]
        for key in values:
            if key not in known:
                close = get_close_matches(str(key), known, n=1)
                hint = f"did you mean '{close[0]}'?" if close else f'known keys: {", ".join(known)}'
                raise ConfigurationError(f'trial configuration: {key}: unknown key; {hint}')
        return cls(**values)


def _member(kind, name, value):
    try:
        return kind(value)
    except ValueError:
        allowed = ', '.join(member.value for member in kind)
        raise ConfigurationError(f'{name} must be one of {allowed}, got {value!r}') from None


def _finite(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
