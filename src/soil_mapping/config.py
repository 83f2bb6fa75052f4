"""What a trial is made of: the mission's parameters, checked at birth."""

import math
import re
from dataclasses import asdict, dataclass, fields
from difflib import get_close_matches
from enum import Enum

from move_base_abstract.errors import ConfigurationError

PUBLISHED_CONFIGURATIONS = (('ssi', 'random'), ('ssi', 'dynamic'), ('rr', 'random'), ('rr', 'dynamic'))

OWN_CLASS = re.compile(r'[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*')  # a user's class by its name


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


class Crs(str, Enum):
    """In what a field's readings give their places: lat and lon (WGS84), or x and y, such as UTM's."""

    DEGREES = 'degrees'
    METRES = 'metres'


@dataclass(frozen=True)
class TrialConfig:
    """The mission of one trial, the same for every engine. Texts are turned into the enums.

    :raises ConfigurationError: if a value cannot be used; the text names the field and what is allowed.
    """

    field: str = 'synthetic'  # 'synthetic', 'meuse' or 'csv:PATH'
    robots: int = 3  # >= 1
    allocation: Allocation = Allocation.AUCTION  # or a text 'module:Class'; so sampling; own_code.py
    sampling: Sampling = Sampling.DYNAMIC
    budget_s: float = 240.0  # simulated s from the start of the mission, > 0
    dwell_s: float = 1.0  # simulated s that taking a sample lasts, >= 0
    dwell_spread_s: float = 0.0  # a dwell is drawn uniformly from dwell_s -+ this; 0..dwell_s
    speed: float = 2.0  # m/s, > 0: what engines drive at
    cell_m: float = 1  # edge of a cell of truth and map, > 0; synthetic and stretched fields: 1 or 2
    coarse_cells: CoarseCells = CoarseCells.SQUARES
    coarse_m: float = 33.0  # edge of a square coarse cell, > 0
    crs: Crs = Crs.DEGREES  # of csv:PATH
    size: str = ''  # 'WIDTHxHEIGHT' [m] over which a csv field's bounding box is stretched; '' = its own size

    def __post_init__(self):
        for name, kind in (('allocation', Allocation), ('sampling', Sampling), ('coarse_cells', CoarseCells),
                           ('crs', Crs)):
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
        if not _finite(self.cell_m) or not self.cell_m > 0.0:
            raise ConfigurationError(f'cell_m must be > 0 m and finite, got {self.cell_m!r}')
        if self.cell_m == int(self.cell_m):
            object.__setattr__(self, 'cell_m', int(self.cell_m))
        parse_size(self.size)

    def to_dict(self):
        """Return the fields as plain values for JSON."""
        return {name: value.value if isinstance(value, Enum) else value for name, value in asdict(self).items()}

    @property
    def label(self):
        """The allocation and the sampling as a text that is fit for a file's name, such as 'ssi_dynamic'."""
        return '_'.join((each.value if isinstance(each, Enum) else each).replace(':', '.')
                        for each in (self.allocation, self.sampling))

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


def parse_size(text):
    """Return (width, height) [m] of 'WIDTHxHEIGHT', None of ''. :raises ConfigurationError: if it is neither."""
    if text == '':
        return None
    found = re.fullmatch(r'([0-9.]{1,12})x([0-9.]{1,12})', text) if isinstance(text, str) else None
    try:
        width, height = map(float, found.groups())
    except (AttributeError, ValueError):
        width = height = 0.0
    if not (width >= 1.0 and height >= 1.0):
        raise ConfigurationError(f"size must be 'WIDTHxHEIGHT' in metres such as '324x220', each >= 1, got {text!r}")
    return width, height


def _member(kind, name, value):
    try:
        return kind(value)
    except ValueError:
        allowed = ', '.join(member.value for member in kind)
        own = ''
        if kind in (Allocation, Sampling):
            if isinstance(value, str) and OWN_CLASS.fullmatch(value):
                return value
            own = "; or a class of your own as 'my_package.module:Class'"
        raise ConfigurationError(f'{name} must be one of {allowed}, got {value!r}{own}') from None


def _finite(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
