"""The trials of a study that are complete, as the report needs them."""

import filecmp
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from soil_mapping.comparison import METRICS, trial_row
from soil_mapping.motion import StraightTrip
from soil_mapping.trial_folder import OLD, UNFINISHED, is_complete, read_about, read_trial

from .study_folder import belongs

CONFIGURATION_NAMES = {'ssi_random': 'SSI random', 'ssi_dynamic': 'SSI dynamic', 'rr_random': 'RR random',
                       'rr_dynamic': 'RR dynamic'}  # in the report's order
MESA, LOCKSTEP = 'mesa', 'ros-lockstep'


@dataclass(frozen=True)
class Trial:
    """What a complete folder says, without its maps."""

    path: Path
    group: str
    configuration: str  # a key of CONFIGURATION_NAMES, or another folder's name
    seed: int
    row: tuple  # the metrics in the order of METRICS
    events_sha256: str
    wall_s: dict
    speed_up: dict  # overall, moving
    leg_errors: tuple  # per leg: how much longer it took than by the law of motion, as a share of that
    leg_errors_ns: tuple  # the same [simulated ns]
    about: dict  # trial.json


def collect_trials(folder):
    """Return the complete trials below the folder of a study, by group, in a stated order.

    Trials of other parameters than the study was last run with, of another content of its field's file or of another
    version of this package are left out.

    :raises FileNotFoundError: if there is none.
    """
    paths = sorted(path.parent for path in Path(folder).glob('trials/*/*/seed_*/trial.json'))
    is_own = belongs(Path(folder))
    trials = [read(path) for path in paths if is_complete(path) and not path.name.endswith((UNFINISHED, OLD))
              and is_own(read_about(path))]
    if not trials:
        raise FileNotFoundError(f'{folder}: there is no complete trial; `study run` makes them')
    groups = {}
    for trial in trials:
        groups.setdefault(trial.group, []).append(trial)
    return {name: groups[name] for name in sorted(groups, key=_group_order)}


def read(path):
    """Return the Trial of a complete folder."""
    about, result = read_about(path), read_trial(path)
    errors_ns, errors = leg_errors(result)
    return Trial(path=path, group=path.parts[-3], configuration=path.parts[-2], seed=result.seed,
                 row=tuple(trial_row(result.metrics)), events_sha256=about['events_sha256'], wall_s=result.wall_s,
                 speed_up=result.speed_up, leg_errors=errors, leg_errors_ns=errors_ns,
                 about=about)


def leg_errors(result):
    """Return the errors of all finished legs of a TrialResult: ([simulated ns], as shares of the leg's own time)."""
    places = {way.robot: (way.x, way.y) for way in reversed(result.waypoints)}  # the first of each robot
    departed, errors_ns, errors = {}, [], []
    for event in result.events:
        if event.event == 'drive':
            departed[event.robot] = event.time_ns
        if event.event in ('arrive', 'sample', 'fail'):
            here = (event.x_m, event.y_m)
            if event.event == 'arrive':
                begin_ns = departed[event.robot]
                trip = StraightTrip.between(places[event.robot], here, result.config['speed'], begin_ns)
                errors_ns.append(event.time_ns - trip.arrive_ns)
                errors.append(errors_ns[-1] / max(1, trip.arrive_ns - begin_ns))
            places[event.robot] = here
    return tuple(errors_ns), tuple(errors)


def as_study(trials, seeds=None):
    """Return {configuration: array (trials, metrics)} as comparison.py takes it; only of these seeds, if given."""
    rows = {}
    for trial in trials:
        if seeds is None or (trial.configuration, trial.seed) in seeds:
            rows.setdefault(trial.configuration, []).append(trial.row)
    return {name: np.array(rows[name]) for name in sorted(rows, key=configuration_order)}


def common_seeds(first, second):
    """Return the (configuration, seed) pairs that both lists of trials have."""
    return {(trial.configuration, trial.seed) for trial in first} & {(each.configuration, each.seed) for each in second}


def is_identical(trial, other):
    """Return whether two trials are the same run: same events and, where there are two, the same robots' log."""
    logs = [each.path / 'lockstep_events.jsonl' for each in (trial, other)]
    if trial.events_sha256 != other.events_sha256:
        return False
    return not all(log.is_file() for log in logs) or filecmp.cmp(*logs, shallow=False)


def configuration_order(name):
    """Return a sorting key: the published order, then by name."""
    known = list(CONFIGURATION_NAMES)
    return (known.index(name) if name in known else len(known), name)


def mean(values):
    """Return the mean of those that are not NaN; NaN if there is none."""
    known = [value for value in values if not math.isnan(value)]
    return sum(known) / len(known) if known else math.nan


def metric_column(trials, metric):
    """Return the values of one metric."""
    return [trial.row[METRICS.index(metric)] for trial in trials]


def _group_order(name):
    first = [MESA, 'mesa-eight', LOCKSTEP]
    if name in first:
        return first.index(name), 0.0, name
    factor = name.removeprefix('ros-').removesuffix('x')
    try:
        return len(first), float(factor), name
    except ValueError:
        return len(first) + 1, 0.0, name
