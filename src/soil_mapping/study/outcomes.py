"""The complete trials of a study, in the form that the report's sections need."""
from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict

import numpy as np

from soil_mapping.mesa_models.motion import StraightTrip
from soil_mapping.results.comparison import trial_row
from soil_mapping.results.trial_folder import is_complete, read_about, read_trial

from .groups import ALL

CONFIGURATION_NAMES = {'ssi_random': 'SSI random', 'ssi_dynamic': 'SSI dynamic', 'rr_random': 'RR random',
                       'rr_dynamic': 'RR dynamic'}  # in the sections' order
FILES = 'files-'  # prefix of the names of a trial's own files in an experiment's folder


@dataclass(frozen=True)
class Trial:
    """The content of a complete trial's folder, without its maps."""

    path: Path
    group: str
    configuration: str  # a key of CONFIGURATION_NAMES
    seed: int
    row: tuple  # the metrics in the order of METRICS
    events_sha256: str
    wall_s: dict
    speed_up: dict  # overall, moving
    leg_errors: tuple  # for each leg: the time that it took too long, as a share of its time by the law of motion
    leg_errors_ns: tuple  # the same [simulated ns]
    about: dict  # the trial's own trial.json


def collect_trials(experiment: Any) -> Any:
    """Return {group: [Trial, ...]} of the complete trials of a report's Experiment, groups in a stated order."""
    groups: Dict[Any, Any] = {}
    engines = {one['id']: one['configuration'].get('engine') for one in experiment.plan['trials']}
    for one in experiment.complete:
        path = experiment.folder / 'trials' / one.id
        if is_complete(path, FILES):
            groups.setdefault(engines[one.id], []).append(read(path, engines[one.id]))
    return {name: groups[name] for name in ALL if name in groups}


def read(path: Any, group: Any) -> Any:
    """Return the Trial of a complete folder."""
    about, result = read_about(path, FILES), read_trial(path, FILES)
    errors_ns, errors = leg_errors(result)
    return Trial(path=path, group=group, configuration=f"{about['config']['allocation']}_{about['config']['sampling']}",
                 seed=result.seed, row=tuple(trial_row(result.metrics)), events_sha256=about['events_sha256'],
                 wall_s=result.wall_s, speed_up=result.speed_up, leg_errors=errors, leg_errors_ns=errors_ns,
                 about=about)


def leg_errors(result: Any) -> Any:
    """Return the errors of all finished legs of a TrialResult: (in simulated ns, as shares of the leg's own time)."""
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


def as_study(trials: Any, seeds: Any = None) -> Any:
    """Return {configuration: array (trials, metrics)} for comparison.py; only trials of these seeds, if given."""
    rows: Dict[Any, Any] = {}
    for trial in trials:
        if seeds is None or (trial.configuration, trial.seed) in seeds:
            rows.setdefault(trial.configuration, []).append(trial.row)
    return {name: np.array(rows[name]) for name in sorted(rows, key=configuration_order)}


def common_seeds(first: Any, second: Any) -> Any:
    """Return the (configuration, seed) pairs that both lists of trials have."""
    return {(trial.configuration, trial.seed) for trial in first} & {(each.configuration, each.seed) for each in second}


def configuration_order(name: str) -> Any:
    """Return a sorting key: the published order, then by name."""
    known = list(CONFIGURATION_NAMES)
    return (known.index(name) if name in known else len(known), name)


def mean(values: Any) -> Any:
    """Return the mean of the values that are not NaN; NaN if there are none."""
    known = [value for value in values if not math.isnan(value)]
    return sum(known) / len(known) if known else math.nan
