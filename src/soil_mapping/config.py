"""The parameters of a trial's mission, checked when they are made."""
from __future__ import annotations

import re
from dataclasses import asdict, dataclass, fields
from enum import Enum
from typing import Any, Dict, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import Kind, check_keys, error, integer, made_by, number, string

PUBLISHED_CONFIGURATIONS = (('ssi', 'random'), ('ssi', 'dynamic'), ('rr', 'random'), ('rr', 'dynamic'))

_OWN_CLASS = re.compile(r'[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*')  # the name of a user's class


class Allocation(str, Enum):
    """How tasks are assigned to robots: in turn, or to the lowest bid."""

    ROUND_ROBIN = 'rr'
    AUCTION = 'ssi'


class Sampling(str, Enum):
    """Where tasks are made: at random, where the map is least certain, or on a 10 x 10 grid at the start."""

    RANDOM = 'random'
    DYNAMIC = 'dynamic'
    GRID = 'grid'


class CoarseCells(str, Enum):
    """The coarse cells of the dynamic sampling: squares, or clusters of grid cells."""

    SQUARES = 'squares'
    CLUSTERS = 'clusters'


class Crs(str, Enum):
    """The coordinates of a field's readings: lat and lon (WGS84), or x and y in metres, such as UTM."""

    DEGREES = 'degrees'
    METRES = 'metres'


def _member_of(members: Any, or_own: bool = False) -> Kind:
    """Return the kind of the members of an enum, or with ``or_own`` of names of a user's classes."""
    def made(value: Any) -> Any:
        return value if or_own and isinstance(value, str) and _OWN_CLASS.fullmatch(value) else members(value)
    return made_by(made, ', '.join(each.value for each in members) + (
        ", or a class of your own as 'my_package.module:Class'" if or_own else ''))


#: {field of TrialConfig: its Kind}
KINDS = {'field': string("a text such as 'synthetic' or 'csv:PATH'"), 'robots': integer(1, 1000),
         'allocation': _member_of(Allocation, True), 'sampling': _member_of(Sampling, True),
         'budget_s': number(1e-3, 1e7, unit='s'), 'dwell_s': number(0.0, 1e7, unit='s'),
         'dwell_spread_s': number(0.0, 1e7, unit='s', note='at most dwell_s'), 'speed': number(1e-3, 1e3, unit='m/s'),
         'cell_m': number(1e-3, 1e6, unit='m'), 'coarse_cells': _member_of(CoarseCells),
         'coarse_m': number(1.0, 1e6, unit='m'), 'crs': _member_of(Crs)}


@dataclass(frozen=True)
class TrialConfig:
    """The mission of one trial, the same for every engine. Texts are converted into the enums.

    :raises ConfigurationError: if a value cannot be used; the text names the field and what is allowed.
    """

    field: str = 'synthetic'  # 'synthetic', 'meuse' or 'csv:PATH'
    robots: int = 3  # 1..1000
    allocation: Allocation = Allocation.AUCTION  # or a text 'module:Class', as sampling: mission/own_code.py
    sampling: Sampling = Sampling.DYNAMIC
    budget_s: float = 240.0  # simulated s from the start of the mission, > 0, at most 1e7 (116 days)
    dwell_s: float = 1.0  # simulated s that taking a sample lasts, 0..1e7
    dwell_spread_s: float = 0.0  # dwells are uniform in dwell_s -+ this; 0..dwell_s
    speed: float = 2.0  # m/s, 0.001..1000: the robots' speed
    cell_m: float = 1  # m, edge of a cell of truth and map, > 0; synthetic and stretched fields: 1 or 2
    coarse_cells: CoarseCells = CoarseCells.SQUARES
    coarse_m: float = 33.0  # m, edge of a square coarse cell, > 0
    crs: Crs = Crs.DEGREES  # for csv:PATH
    size: str = ''  # 'WIDTHxHEIGHT' [m] to which a csv field's bounding box is stretched; '' = its own size

    def __post_init__(self) -> None:
        for name, kind in KINDS.items():
            object.__setattr__(self, name, kind.check(name, getattr(self, name)))
        if self.dwell_spread_s > self.dwell_s:
            raise error('dwell_spread_s', self.dwell_spread_s, f'at most dwell_s, {self.dwell_s:g} s')
        if self.cell_m == int(self.cell_m):
            object.__setattr__(self, 'cell_m', int(self.cell_m))
        parse_size(self.size)

    def to_dict(self) -> Dict[str, Union[float, str]]:
        """Return the fields as plain values for JSON."""
        return {name: value.value if isinstance(value, Enum) else value for name, value in asdict(self).items()}

    @property
    def label(self) -> str:
        """The allocation and the sampling as a text for names of files, such as 'ssi_dynamic'."""
        return '_'.join((each.value if isinstance(each, Enum) else each).replace(':', '.')
                        for each in (self.allocation, self.sampling))

    @classmethod
    def from_dict(cls, values: Any) -> TrialConfig:
        """Return the configuration that a mapping describes.

        :raises ConfigurationError: for an unknown key, with the most similar known one, or a value that cannot be used.
        """
        known = [field.name for field in fields(cls)]
        check_keys(values, known, 'trial configuration', '')
        return cls(**values)


def parse_size(text: Union[int, str]) -> Any:
    """Return (width, height) [m] of 'WIDTHxHEIGHT', or None for ''. :raises ConfigurationError: for any other text."""
    if text == '':
        return None
    found: Any = re.fullmatch(r'([0-9.]{1,12})x([0-9.]{1,12})', text) if isinstance(text, str) else None
    try:
        width, height = map(float, found.groups())
    except (AttributeError, ValueError):
        width = height = 0.0
    if not (width >= 1.0 and height >= 1.0):
        raise ConfigurationError(f"size must be 'WIDTHxHEIGHT' in metres such as '324x220', each >= 1, got {text!r}")
    return width, height
