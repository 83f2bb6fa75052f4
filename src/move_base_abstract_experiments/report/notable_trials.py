"""The trials worth a look: the worst and the median one of each configuration, with their replays and logs."""
from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any, Callable, List, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.common.own_files import FolderKind

from . import endings

if TYPE_CHECKING:
    from .design import Metric
    from .outcome import Experiment, Trial

MOST_REPLAYS = 40  # the number of replays that one report writes; the links of other trials lead to the event log
KIND = FolderKind("folder of an experiment's replays", ('*.html',))


class Pick(NamedTuple):
    """A trial of a configuration that is worth a look."""

    configuration: int
    role: str  # 'worst' or 'median'
    trial: Trial
    value: float


def primary_metric(experiment: Experiment) -> Optional[Metric]:
    """Return the Metric by which trials are picked: the first with a better side and values; None if there is none."""
    for metric in experiment.metrics:
        if metric.better and any(metric.name in trial.metrics and not math.isnan(trial.metrics[metric.name])
                                 for trial in experiment.complete):
            return metric
    return None


def picks(experiment: Experiment, metric: Metric) -> List[Pick]:
    """Return the Picks of a metric: the worst and the median trial of each configuration.

    Of trials with equal values the first one in the plan is picked. Of two trials in the middle, the median is the one
    with the lower value. Lower bounds, of trials that the limit of time ended, count as larger than all complete
    values. If the trial in the middle has a complete value, and no bound lies below it, it is the median; otherwise,
    and if values that were cut off are no lower bounds, there is no median.
    """
    found = []
    for configuration in experiment.configurations:
        own = [(trial.metrics.get(metric.name, math.nan), place, trial)
               for place, trial in enumerate(experiment.trials_of(configuration))]
        own = [each for each in own if not math.isnan(each[0])]
        if own:
            picked = ('worst', _worst(experiment, metric, own)), ('median', _median(experiment, metric, own))
            found += [Pick(configuration.place, role, one[2], one[0]) for role, one in picked if one is not None]
    return found


def _worst(experiment: Experiment, metric: Metric, own: Sequence[Tuple[float, int, Trial]]) -> Tuple[float, int, Trial]:
    """Return the worst of the tuples (value, place, trial). If lower is better, values that were cut off are worst."""
    return min(own, key=lambda each: (-math.inf if metric.better == 'lower' and endings.is_cut(
        experiment, metric, each[2]) else -each[0] if metric.better == 'lower' else each[0], each[1]))


def _median(experiment: Experiment, metric: Metric,
            own: Sequence[Tuple[float, int, Trial]]) -> Optional[Tuple[float, int, Trial]]:
    """Return the tuple in the middle, or None if it is not known which one that is."""
    cut = [endings.is_cut(experiment, metric, each[2]) for each in own]
    if any(cut) and metric.at_limit not in endings.BOUNDS:
        return None
    ranked = sorted((math.inf if is_cut else each[0], each[1], each, is_cut) for each, is_cut in zip(own, cut))
    middle = (len(own) - 1) // 2
    _, _, median, is_cut = ranked[middle]
    # A value that was cut off would have become larger than its bound. So its place is known only if its bound lies
    # above the middle.
    is_known = not is_cut and all(each[0] >= median[0] for each, is_cut in zip(own, cut) if is_cut)
    return median if is_known else None


def event_log(experiment: Experiment, trial: Trial) -> Optional[str]:
    """Return the path of a trial's event log, relative to the experiment's folder, or None."""
    path = os.path.join('trials', trial.id, 'events.jsonl')
    return path if (experiment.folder / path).is_file() else None


def node_logs(experiment: Experiment, trial: Trial) -> Optional[str]:
    """Return the path of the folder with the logs of a trial's nodes, relative to the experiment's folder, or None."""
    path = os.path.join('trials', trial.id, 'logs')
    return path + '/' if (experiment.folder / path).is_dir() else None


def link(experiment: Experiment, trial: Trial) -> Optional[str]:
    """Return the path of a trial's replay; if there is none, that of its event log, otherwise None."""
    return f'replays/{trial.id}.html' if trial.id in experiment.replays else event_log(experiment, trial)


def write_replays(experiment: Experiment, found: Sequence[Pick], write_page: Callable[..., Any]) -> List[str]:
    """Write the replays of Picks; return a line for each that could not be written.

    :param write_page: the function of move_base_abstract_replay, called with a list of event logs and the page's path.
    """
    names = dict.fromkeys(pick.trial.id for pick in found)
    by_id = {trial.id: trial for trial in experiment.trials}
    logs = {name: event_log(experiment, by_id[name]) for name in names}
    wanted = [(by_id[name], log) for name, log in logs.items() if log is not None][:MOST_REPLAYS]
    problems: List[str] = []
    if not wanted:
        return problems
    folder = experiment.folder / 'replays'
    marker = KIND.make(folder)
    try:
        for trial, log in wanted:
            try:
                write_page([experiment.folder / log], folder / f'{trial.id}.html')
                experiment.replays.add(trial.id)
            except Exception as error:  # if one log cannot be shown, the report still shows the rest
                text = str(error).replace(str(experiment.folder) + os.sep, '')  # the page is the same anywhere
                problems.append(f'{trial.id}: no replay: {text}')
    finally:
        os.close(marker)
    return problems
