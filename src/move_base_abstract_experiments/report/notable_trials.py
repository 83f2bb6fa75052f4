"""Which trials are worth a look: the worst and the median one of each configuration, and where each can be seen."""

import math
import os
from typing import NamedTuple

from move_base_abstract.common.own_files import FolderKind

from . import endings

MOST_REPLAYS = 40  # pages that one report makes; what comes after leads to the event log
KIND = FolderKind("folder of an experiment's replays", ('*.html',))


class Pick(NamedTuple):
    """A trial of a configuration that is worth a look."""

    configuration: int
    role: str  # 'worst' or 'median'
    trial: object  # outcome.Trial
    value: float


def primary_metric(experiment):
    """Return the Metric by which trials are picked: the first that has a better side and values, None without one."""
    for metric in experiment.metrics:
        if metric.better and any(metric.name in trial.metrics and not math.isnan(trial.metrics[metric.name])
                                 for trial in experiment.complete):
            return metric
    return None


def picks(experiment, metric):
    """Return the Picks of a metric, worst and median of each configuration; of equals the first of the plan.

    The median one is the lower of the two in the middle. What the limit of time has cut off counts as more than all
    that is whole where it is a lower bound; then the median is known as long as it is whole. Else there is none.
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


def _worst(experiment, metric, own):
    """Return of (value, place, trial) the one of the worst; those that were cut off come first, if lower is better."""
    return min(own, key=lambda each: (-math.inf if metric.better == 'lower' and endings.is_cut(
        experiment, metric, each[2]) else -each[0] if metric.better == 'lower' else each[0], each[1]))


def _median(experiment, metric, own):
    """Return the one in the middle, or None where it is not known which one that is."""
    cut = [endings.is_cut(experiment, metric, each[2]) for each in own]
    if any(cut) and metric.at_limit not in endings.BOUNDS:
        return None
    ranked = sorted((math.inf if is_cut else each[0], each[1], each, is_cut) for each, is_cut in zip(own, cut))
    middle = (len(own) - 1) // 2
    _, _, median, is_cut = ranked[middle]
    # What was cut off would have gone on beyond its bound: only if that lies above the middle is its place known.
    is_known = not is_cut and all(each[0] >= median[0] for each, is_cut in zip(own, cut) if is_cut)
    return median if is_known else None


def event_log(experiment, trial):
    """Return where a trial's event log is, from the experiment's folder, or None."""
    path = os.path.join('trials', trial.id, 'events.jsonl')
    return path if (experiment.folder / path).is_file() else None


def node_logs(experiment, trial):
    """Return where what a trial's nodes wrote is, or None."""
    path = os.path.join('trials', trial.id, 'logs')
    return path + '/' if (experiment.folder / path).is_dir() else None


def link(experiment, trial):
    """Return where a trial can be seen: its replay, else its event log, else None."""
    return f'replays/{trial.id}.html' if trial.id in experiment.replays else event_log(experiment, trial)


def write_replays(experiment, found, write_page):
    """Write the replays of Picks; return what went wrong, a line each.

    :param write_page: called with a list of event logs and the path of the page; move_base_abstract_replay's.
    """
    wanted = dict.fromkeys(pick.trial.id for pick in found)
    by_id = {trial.id: trial for trial in experiment.trials}
    wanted = [by_id[name] for name in wanted if event_log(experiment, by_id[name])][:MOST_REPLAYS]
    problems = []
    if not wanted:
        return problems
    folder = experiment.folder / 'replays'
    marker = KIND.make(folder)
    try:
        for trial in wanted:
            try:
                write_page([experiment.folder / event_log(experiment, trial)], folder / f'{trial.id}.html')
                experiment.replays.add(trial.id)
            except Exception as error:  # a log that cannot be shown is no reason to show nothing
                text = str(error).replace(str(experiment.folder) + os.sep, '')  # the page says the same anywhere
                problems.append(f'{trial.id}: no replay: {text}')
    finally:
        os.close(marker)
    return problems
