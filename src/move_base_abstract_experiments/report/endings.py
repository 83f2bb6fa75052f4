"""How trials ended, and what that makes of their values: what the limit of time cut off is a bound at best.

``ended_by`` of a trial: 'seconds' (``until: seconds``, the limit of simulated time), 'topic', 'idle', 'required NODE',
'returned' (a function); of one that failed 'time_limit' (wall time), 'fault', 'error', or what else its runner says.
"""

import math
import sys

LIMIT = 'seconds'
#: what a metric is of a trial that the limit of time ended
LOWER_BOUND, VALUE, TO_LAST_GOAL = 'lower_bound', 'value', 'to_last_goal'
BOUNDS = (LOWER_BOUND, TO_LAST_GOAL)  # if it is cut off
_COMPLETE = 'complete'
_NEARLY = 1.0 - 1e-9


def ended_by(told, until, simulated_seconds):
    """Return how a trial ended: as its trial.json says, else, of complete older ones, whether it came to the limit."""
    if isinstance(told, str) and told.isprintable() and 0 < len(told) <= 300:
        return sys.intern(told)
    seconds = until.get('seconds') if isinstance(until, dict) else None
    if isinstance(seconds, (int, float)) and not math.isnan(simulated_seconds):
        return LIMIT if simulated_seconds >= seconds * _NEARLY else ''
    return ''


def is_span(experiment):
    """Return whether trials last as long as they do by design: the limit is their only end, and all came to it."""
    if 'is_span' not in experiment.known:
        until = experiment.plan.get('until')
        has_others = isinstance(until, dict) and any(until.get(key) for key in ('topic', 'idle'))
        experiment.known['is_span'] = not has_others and all(
            trial.ended_by == LIMIT for trial in experiment.trials if trial.status == _COMPLETE)
    return experiment.known['is_span']


def has_limited(experiment):
    """Return whether the limit of time ended trials that might have ended otherwise."""
    return not is_span(experiment) and any(trial.ended_by == LIMIT for trial in experiment.trials
                                           if trial.status == _COMPLETE)


def is_cut(experiment, metric, trial):
    """Return whether a trial's value of a metric is not the whole, since the limit of time ended the trial."""
    if metric.outcome or metric.at_limit == VALUE or trial.status != _COMPLETE or trial.ended_by != LIMIT:
        return False
    if math.isnan(trial.metrics.get(metric.name, math.nan)):
        return False
    if metric.at_limit == TO_LAST_GOAL:
        return trial.open_goals != 0 and not (trial.open_goals is None and is_span(experiment))
    return not is_span(experiment)
