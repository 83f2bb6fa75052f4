"""The keywords of ``@pytest.mark.lockstep`` and of ``lockstep.start``, by which a test says what to start."""
import os
from dataclasses import dataclass, field, fields
from typing import Any, Dict, List, Optional, Tuple, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown
from move_base_abstract.runs import built_in

DEPARTURE, IDLE = 'test', 'idle'
#: keywords of the marker that ``lockstep.start`` ignores
OF_TESTS = ('chaos_seeds', 'wall_limit')
_MOST_SEEDS = 100_000  # each seed is a test


@dataclass
class Settings:
    """The settings of one run. Paths are relative to the folder of the test's file."""

    scenario: Optional[str] = None  # path of a fleet's file
    launch: Optional[str] = None  # path of a launch file
    args: Dict[str, Any] = field(default_factory=dict)  # arguments of the launch file
    nodes: List[str] = field(default_factory=list)  # 'PACKAGE/TYPE', optionally followed by arguments
    replace: Dict[str, str] = field(default_factory=dict)  # 'PACKAGE/TYPE': the 'PACKAGE/TYPE' started instead
    parameters: Dict[str, Any] = field(default_factory=dict)  # ROS parameters, by full name
    time_master: Dict[str, Any] = field(default_factory=dict)  # parameters of the time master
    seed: int = 0  # seed of the programs' global random generators
    sleep: str = 'wall'  # the time that time.sleep() takes in programs: 'wall' or 'simulated'
    log_messages: bool = True  # whether the log has a hash of each message between participants
    properties: Tuple[str, ...] = (built_in.ALL,)  # the properties that the run must keep
    until: str = DEPARTURE  # 'test': the run ends with the test; 'idle': when no participant has anything left to do

    def __post_init__(self) -> None:
        self.properties = tuple(built_in.KIND.check('lockstep: properties', name) for name in self.properties)
        _check('until', [self.until] if self.until not in (DEPARTURE, IDLE) else [], (DEPARTURE, IDLE))
        _check('sleep', [self.sleep] if self.sleep not in ('wall', 'simulated') else [], ('wall', 'simulated'))
        for name in [*self.nodes, *self.replace, *self.replace.values()]:
            if not isinstance(name, str) or name.split()[:1] == [] or name.split()[0].count('/') != 1:
                raise ConfigurationError('lockstep: nodes, replace: must be PACKAGE/TYPE, got '
                                         + shown(name))


def chaos_seeds(given: Any) -> List[int]:
    """Return the seeds that a marker asks for. 4 gives 0 to 3; ``range(2, 9)`` and ``[1, 7]`` give their numbers.

    :raises ConfigurationError: if ``given`` is not a number, or a list, tuple or range of numbers, 0 to 2**32 - 1.
    """
    seeds = range(given) if type(given) is int else given  # a bool is not a number here
    if not (isinstance(seeds, (range, list, tuple)) and 0 < len(seeds[:_MOST_SEEDS + 1]) <= _MOST_SEEDS
            and all(type(one) is int and 0 <= one < 1 << 32 for one in seeds)):
        raise ConfigurationError('lockstep: chaos_seeds: must be a number of seeds, or the seeds in a list or range '
                                 '(1 to {} of them, each 0 to 2**32 - 1), got {}'.format(_MOST_SEEDS, shown(given)))
    return list(seeds)


def _check(what: str, wrong: List[Any], allowed: Tuple[str, ...]) -> None:
    if wrong:
        raise ConfigurationError('lockstep: {}: must be one of {}, got {}'.format(
            what, ', '.join(allowed), shown(wrong[0])))


def settings_of(given: Dict[str, Any], folder: str) -> Settings:
    """Return the Settings of the keywords ``given``; ``folder`` is the one to which paths are relative.

    :raises ConfigurationError: if a keyword is not known, a value is not allowed, or a file is not there.
    """
    known = {one.name for one in fields(Settings)}
    unknown = sorted(set(given) - known - set(OF_TESTS))
    if unknown:
        raise ConfigurationError('lockstep: there is no {}; there are {}'.format(
            shown(unknown[0]), ', '.join(sorted({*known, *OF_TESTS}))))
    found = Settings(**{key: value for key, value in given.items() if key in known})
    for key in ('scenario', 'launch'):
        path: Union[str, os.PathLike, None] = getattr(found, key)
        if path is not None:
            full = os.path.join(folder, os.fspath(path))
            if not os.path.isfile(full):
                raise ConfigurationError('lockstep: {}: {} is not there'.format(key, full))
            setattr(found, key, full)
    return found
