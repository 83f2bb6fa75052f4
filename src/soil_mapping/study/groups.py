"""The groups of trials of the study: the engines and clocks on which each mission runs."""
from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING, Any, List, Optional, Sequence

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

from .field_cache import truth_of
from .spec import TrialSpec

if TYPE_CHECKING:
    from ..config import Crs, TrialConfig

MESA, EIGHT, LOCKSTEP = 'mesa', 'mesa-eight', 'ros-lockstep'
SCALED = {f'ros-{factor:g}x': factor for factor in (100.0, 15.0, 10.0)}
REAL_TIME = 'ros-1x'
FACTORS = {**SCALED, REAL_TIME: 1.0}  # simulated s per wall s
ALL = (MESA, EIGHT, LOCKSTEP, *SCALED, REAL_TIME)


def specs_of(groups: Sequence[str], config: TrialConfig) -> List[TrialSpec]:
    """Return the TrialSpec of each named group, with a TrialConfig and seed 0."""
    return [_spec_of(group, config) for group in groups]


def _spec_of(group: str, config: TrialConfig) -> TrialSpec:
    if group == MESA:
        return TrialSpec(config=config, engine='mesa')
    if group == EIGHT:
        return TrialSpec(config=replace(config, cell_m=2, coarse_cells=_coarse_cells(config)), engine='mesa',
                         motion='eight')
    if group == LOCKSTEP:
        return TrialSpec(config=config)
    return TrialSpec(config=config, clock='scaled', factor=FACTORS[group])


def _coarse_cells(config: TrialConfig) -> Any:
    """Return the coarse cells for eight directions: the published ones, if the field has the published size."""
    return 'clusters' if _is_published(config.field, config.cell_m, config.crs, config.size) else 'squares'


@functools.lru_cache(maxsize=4)
def _is_published(field: str, cell_m: float, crs: Crs, size: str) -> bool:
    from soil_mapping.config import TrialConfig
    return truth_of(TrialConfig(field=field, cell_m=cell_m, crs=crs, size=size)).grid.is_published


def chosen(names: Optional[Sequence[str]], with_1x: bool = False) -> List[str]:
    """Return the groups of these names, by default all of a study. :raises ConfigurationError: for other names."""
    known = [group for group in ALL if with_1x or group != REAL_TIME]
    for name in names or ():
        if name not in known:
            raise ConfigurationError(f'--groups: there is no group {shown(name)}; there are {", ".join(known)}')
    return [group for group in known if not names or group in names]
