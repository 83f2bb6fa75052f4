"""One trial to run: its mission, seed and engine, and the options of the engine."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Union

from move_base_abstract.common.kinds import integer, number, one_of
from move_base_abstract.lockstep.charge import check_charge
from soil_mapping.config import TrialConfig
from soil_mapping.mesa_models.motion import motion_named

from .field_cache import digests

ENGINES = ('ros', 'mesa')
CLOCKS = ('lockstep', 'scaled')
#: {field of TrialSpec: its Kind}
KINDS = {'engine': one_of(*ENGINES), 'clock': one_of(*CLOCKS), 'seed': integer(0, 2**63 - 1),
         'factor': number(0.01, 1e6), 'limit': number(0.01, 1e6, or_zero=True)}


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
        for name, kind in KINDS.items():
            object.__setattr__(self, name, kind.check(name, getattr(self, name)))
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
