"""How trials ended, and what that means for their values: a value that the limit of time cut off is at best a bound.

``ended_by`` of a complete trial is 'seconds' (``until: seconds``, the limit of simulated time), 'topic', 'idle',
'required NODE' or 'returned' (a function). Of a failed trial it is 'time_limit' (wall time), 'fault', 'error', or
another word of its runner.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .design import Metric
    from .outcome import Experiment, Trial

LIMIT = 'seconds'
#: what a metric means in a trial that the limit of time ended
LOWER_BOUND, VALUE, TO_LAST_GOAL = 'lower_bound', 'value', 'to_last_goal'
BOUNDS = (LOWER_BOUND, TO_LAST_GOAL)  # with these, a value that was cut off is a lower bound
_COMPLETE = 'complete'


def is_span(experiment: Experiment) -> bool:
    """Return whether trials last as long as they do by design: the limit is their only end, and all reached it."""
    if 'is_span' not in experiment.known:
        has_others = any((experiment.plan['until'] or {}).get(key) for key in ('topic', 'idle'))
        experiment.known['is_span'] = not has_others and all(
            trial.ended_by == LIMIT for trial in experiment.trials if trial.status == _COMPLETE)
    return experiment.known['is_span']


def has_limited(experiment: Experiment) -> bool:
    """Return whether the limit of time ended trials that might have ended otherwise."""
    return not is_span(experiment) and any(trial.ended_by == LIMIT for trial in experiment.trials
                                           if trial.status == _COMPLETE)


def is_cut(experiment: Experiment, metric: Metric, trial: Trial) -> bool:
    """Return whether a trial's value of a metric is cut off because the limit of time ended the trial."""
    if metric.outcome or metric.at_limit == VALUE or trial.status != _COMPLETE or trial.ended_by != LIMIT:
        return False
    if math.isnan(trial.metrics.get(metric.name, math.nan)):
        return False
    if metric.at_limit == TO_LAST_GOAL:
        return trial.open_goals != 0 and not (trial.open_goals is None and is_span(experiment))
    return not is_span(experiment)
