"""One trial to run: the mission, its seed, and the engine with what only that engine knows."""

from dataclasses import dataclass, field

from move_base_abstract.errors import ConfigurationError
from move_base_abstract.lockstep.charge import check_charge
from move_base_abstract.shown import shown
from soil_mapping.config import TrialConfig
from soil_mapping.motion import motion_named
from soil_mapping.own_code import own_code
from soil_mapping.provenance import package_version

from .truth import digests

ENGINES = ('ros', 'mesa')
CLOCKS = ('lockstep', 'scaled')
MAX_SEED = 2**63 - 1


@dataclass(frozen=True)
class TrialSpec:
    """What makes a trial the trial it is. :raises ConfigurationError: if values do not go together."""

    config: TrialConfig = field(default_factory=TrialConfig)
    seed: int = 0
    engine: str = 'ros'
    clock: str = 'lockstep'  # of ROS
    factor: float = 10.0  # simulated s per wall s; of the scaled clock
    limit: float = 0.0  # at most so many simulated s per wall s in lockstep; 0 = no limit
    charge: str = 'none'  # what computing costs in lockstep: none, fixed:SECONDS, measured[:FILE], replay:FILE, ...
    motion: str = 'euclidean'  # of Mesa
    load: int = 0  # so many processes that only burn time run beside it
    again: int = 0  # number of the repetition: a trial that is to be the same as the one before

    def __post_init__(self):
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
    def about_engine(self):
        """The engine and its options, as they stand in trial.json; what does not apply is left out."""
        if self.engine == 'mesa':
            about = {'name': 'mesa', 'motion': self.motion}
        elif self.clock == 'scaled':
            about = {'name': 'ros', 'clock': 'scaled', 'factor': self.factor}
        else:
            about = {'name': 'ros', 'clock': 'lockstep', 'limit': self.limit, 'charge': self.charge}
        about.update({name: getattr(self, name) for name in ('load', 'again') if getattr(self, name)})
        return about

    @property
    def group(self):
        """A name for trials of the same engine and clock, fit for a folder: 'mesa', 'ros-lockstep', 'ros-10x', ..."""
        if self.engine == 'mesa':
            parts = ['mesa'] if self.motion == 'euclidean' else ['mesa', self.motion]
        elif self.clock == 'scaled':
            parts = [f'ros-{self.factor:g}x']
        else:
            parts = ['ros-lockstep', *([f'limit-{self.limit:g}x'] if self.limit else [])]
            parts += ['charge'] if self.charge != 'none' else []
        parts += [f'load-{self.load}'] if self.load else []
        return '-'.join(parts + ([f'again-{self.again}'] if self.again else []))

    @property
    def name(self):
        """Where the trial belongs below a study's folder of trials."""
        return f'{self.group}/{self.config.label}/seed_{self.seed:03d}'

    @property
    def inputs(self):
        """What the trial reads, as in TrialResult; looked at once per process."""
        return digests(self.config.field, self.about_engine.get('charge', 'none'))

    def is_of(self, about):
        """Return whether trial.json's content (a mapping) is of this trial: parameters, files read, package version."""
        own = self.config.to_dict(), self.seed, self.about_engine, own_code(self.config), self.inputs, package_version()
        return (about['config'], about['seed'], about['engine'], about.get('own_code', {}), about.get('inputs'),
                about.get('package')) == own
