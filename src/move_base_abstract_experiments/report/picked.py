"""Which trials are worth a look: the worst and the median one of each configuration, and where each can be seen."""

import math
import os
from typing import NamedTuple

from move_base_abstract.own_files import FolderKind

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

    The median one is the lower of the two in the middle.
    """
    found = []
    for configuration in experiment.configurations:
        own = [(trial.metrics.get(metric.name, math.nan), place, trial)
               for place, trial in enumerate(experiment.trials) if trial.configuration == configuration.place]
        own = [each for each in own if not math.isnan(each[0])]
        if own:
            own.sort(key=lambda each: each[:2])
            worst = min(own, key=lambda each: (-math.inf if metric.better == 'lower' and endings.is_cut(
                experiment, metric, each[2]) else -each[0] if metric.better == 'lower' else each[0], each[1]))
            median = own[(len(own) - 1) // 2]
            found += [Pick(configuration.place, role, trial, value)
                      for role, (value, _, trial) in (('worst', worst), ('median', median))]
    return found


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
