"""One trial to run: its mission, seed and engine, and the options of the engine."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown
from move_base_abstract.lockstep.charge import check_charge
from soil_mapping.config import TrialConfig
from soil_mapping.mesa_models.motion import motion_named

from .field_cache import digests

ENGINES = ('ros', 'mesa')
CLOCKS = ('lockstep', 'scaled')
MAX_SEED = 2**63 - 1


@dataclass(frozen=True)
class TrialSpec:
    """All that identifies a trial. :raises ConfigurationError: if a value is not allowed, or values contradict."""

    config: TrialConfig = field(default_factory=TrialConfig)
    seed: int = 0
    engine: str = 'ros'
    clock: str = 'lockstep'  # for ROS
    factor: float = 10.0  # simulated s per wall s, for the scaled clock
    limit: float = 0.0  # upper limit of simulated s per wall s, for lockstep; 0 = no limit
    charge: str = 'none'  # simulated time of computing, for lockstep: none, fixed:SECONDS, measured[:FILE], ...
    motion: str = 'euclidean'  # for Mesa

    def __post_init__(self) -> None:
        for name, allowed in (('engine', ENGINES), ('clock', CLOCKS)):
            if getattr(self, name) not in allowed:
                raise ConfigurationError(f'{name} must be one of {", ".join(allowed)}, got {getattr(self, name)!r}')
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or not 0 <= self.seed <= MAX_SEED:
            raise ConfigurationError(f'seed must be a whole number in 0..2^63-1, got {shown(self.seed)}')
        if not 0.01 <= self.factor <= 1e6:
            raise ConfigurationError(f'factor must lie in 0.01..1e6, got {self.factor!r}')
        if self.limit != 0.0 and not 0.01 <= self.limit <= 1e6:
            raise ConfigurationError(f'limit must be 0 (none) or lie in 0.01..1e6, got {self.limit!r}')
        check_charge(self.charge)
        if self.engine == 'mesa':
            motion_named(self.motion, self.config)

    @property
    def about_engine(self) -> Dict[str, Union[float, str]]:
        """The engine and its options, as in trial.json; options that do not apply are left out."""
        if self.engine == 'mesa':
            return {'name': 'mesa', 'motion': self.motion}
        if self.clock == 'scaled':
            return {'name': 'ros', 'clock': 'scaled', 'factor': self.factor}
        return {'name': 'ros', 'clock': 'lockstep', 'limit': self.limit, 'charge': self.charge}

    @property
    def inputs(self) -> Any:
        """The digests of the files that the trial reads, as in TrialResult; computed once in each process."""
        return digests(self.config.field, self.about_engine.get('charge', 'none'))
