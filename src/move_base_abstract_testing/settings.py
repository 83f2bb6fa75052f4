"""The keywords of ``@pytest.mark.lockstep`` and of ``lockstep.start``, by which a test says what to start."""
import os
from dataclasses import dataclass, replace
from typing import Any, Dict, List, Optional, Tuple, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import FLAG, SCALAR, Kind, list_of, map_of, number, one_of, one_of_types, text
from move_base_abstract.common.old_names import warn_of_old
from move_base_abstract.common.options import option, read
from move_base_abstract.common.shown import shown
from move_base_abstract.lockstep.run_options import (
    ADDED,
    LARGEST_CHAOS_SEED,
    LAST_INSTANT_S,
    PARAMETERS,
    ROS_VALUE,
    RunOptions,
)
from move_base_abstract.runs import built_in

DEPARTURE, IDLE = 'test', 'idle'
#: keywords of the marker that ``lockstep.start`` ignores
OF_TESTS = ('chaos_seeds', 'wall_limit')
#: options of a run that mean nothing here, and why
REFUSED = {'crashes': "lockstep.allow('no_crash') allows crashes",
           'no_respawn': 'nodes with respawn are started once in any case'}
_MOST_SEEDS = 100_000  # each seed is a test
_INSTANT = number(1e-9, LAST_INSTANT_S, unit='s, simulated')
_PATH = Kind(lambda where, value: text().check(where, os.fspath(value) if isinstance(value, os.PathLike) else value),
             text().schema)


@dataclass(frozen=True)
class Settings(RunOptions):
    """The settings of one run: the options of a run, and those of a test. Paths are relative to the test's file."""

    folder: str = ''
    scenario: str = option(_PATH, None, 'the file of a [fleet](fleet.md)')
    launch: str = option(_PATH, None, 'a launch file')
    args: Dict[str, Any] = option(map_of(SCALAR), {}, 'arguments of the launch file')
    nodes: Tuple[str, ...] = option(list_of(ADDED), [], 'nodes that are started: `PACKAGE/TYPE [ARGUMENTS]`')
    time_master: Dict[str, Any] = option(map_of(ROS_VALUE), {}, 'parameters of the '
                                         '[time master](time_master.md#parameters)')
    parameters: Dict[str, Any] = option(PARAMETERS, {}, '`param` by its name of earlier releases')
    log_messages: bool = option(FLAG, True, 'the log has a hash of each message between participants, so '
                                '`assert_identical` compares messages too')
    properties: Tuple[str, ...] = option(list_of(built_in.KIND), [built_in.ALL], 'the [properties](properties.md) that '
                                         'the run must keep')
    until: Union[str, float] = option(
        one_of_types(one_of(DEPARTURE, IDLE), (float, float, _INSTANT), (int, float, _INSTANT)), DEPARTURE, '`test`: '
        'the run ends with the test; `idle`: when no participant has anything left to do; a number: at this instant '
        '[s, simulated]. `lockstep.log`, `lockstep.finish()` and the end of the test wait for the end of the run')

    @property
    def end(self) -> Dict[str, Any]:
        """The parameters of the time master that end the run, besides the test's own departure."""
        return {} if self.until == DEPARTURE else {'end_when_idle': True} if self.until == IDLE else {
            'end_at': self.until}


def chaos_seeds(given: Any) -> List[int]:
    """Return the seeds that a marker asks for. 4 gives 0 to 3; ``range(2, 9)`` and ``[1, 7]`` give their numbers.

    :raises ConfigurationError: if ``given`` is not a number, or a list, tuple or range of numbers, or one is too large.
    """
    seeds = range(given) if type(given) is int else given  # a bool is not a number here
    if not (isinstance(seeds, (range, list, tuple)) and 0 < len(seeds[:_MOST_SEEDS + 1]) <= _MOST_SEEDS
            and all(type(one) is int and 0 <= one <= LARGEST_CHAOS_SEED for one in seeds)):
        raise ConfigurationError('lockstep: chaos_seeds: must be a number of seeds, or the seeds in a list or range '
                                 '(1 to {} of them, each 0 to {}), got {}'.format(
                                     _MOST_SEEDS, LARGEST_CHAOS_SEED, shown(given)))
    return list(seeds)


def settings_of(given: Dict[str, Any], folder: str, seed: Optional[int] = None) -> Settings:
    """Return the Settings of the keywords ``given``; ``folder`` is the one to which paths are relative.

    ``seed``: one of the marker's chaos_seeds, or None. With 0, the stated order, no message is late.

    :raises ConfigurationError: if a keyword is not known, a value is not allowed, or a file is not there.
    """
    for key in given:
        if key in REFUSED:
            raise ConfigurationError('lockstep: {}: not here; {}'.format(key, REFUSED[key]))
    given = {key: value for key, value in given.items() if key not in OF_TESTS}
    found = read(Settings, 'lockstep', given if seed is None else _with_seed(given, seed), folder=folder)
    if found.parameters:
        warn_of_old('lockstep: parameters', 'lockstep: param')
        found = replace(found, param={**found.parameters, **found.param}, parameters={})
    for key in ('scenario', 'launch'):
        if getattr(found, key):
            path = os.path.join(folder, getattr(found, key))
            if not os.path.isfile(path):
                raise ConfigurationError('lockstep: {}: {} is not there'.format(key, path))
            found = replace(found, **{key: path})  # type: ignore[arg-type]
    return found


def _with_seed(given: Dict[str, Any], seed: int) -> Dict[str, Any]:
    """Return the keywords of a test with a seed of chaos, also in the place of that of its ``time_master``."""
    def is_kept(name: str) -> bool:
        return name != 'chaos_seed' if seed else not str(name).startswith('chaos_')
    found = {key: value for key, value in given.items() if is_kept(key)}
    own = found.get('time_master', {})
    if isinstance(own, dict):
        stated = {} if seed else {'chaos_seed': 0}  # takes precedence over the launch file's
        found['time_master'] = {**{name: value for name, value in own.items() if is_kept(name)}, **stated}
    return {**found, 'chaos_seed': seed}
