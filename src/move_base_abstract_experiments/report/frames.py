"""The tables behind the page, as data frames and as CSV text: one row per fact, numbers in the metrics' own units."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Sequence, Tuple, Union

import pandas as pd

from . import comparisons, effects, intervals
from .outcome import COMPLETE

if TYPE_CHECKING:
    from .design import Levels
    from .effects import Difference
    from .intervals import Estimate
    from .outcome import Experiment

DIGITS = '%.10g'  # further digits may be errors of rounding
_ESTIMATE = ('n', 'value', 'low_95', 'high_95', 'interval')
_TRIAL_COLUMNS = ('simulated_seconds', 'wall_seconds', 'times_real_time', 'repeatable', 'verified', 'ended_by', 'error')


def trials(experiment: Experiment) -> pd.DataFrame:
    """Return a frame with a row per planned trial: ID, factors, replication, seed, status, metrics, ...

    If a metric has the name of another column, its column is metric.NAME; that of a factor is factor.NAME.
    """
    fixed = ('id', 'replication', 'seed', 'status', 'labels', *_TRIAL_COLUMNS)
    trials, places = experiment.trials, [trial.configuration for trial in experiment.trials]
    # by columns: a mapping per row takes ten times as long
    columns: Dict[str, List[Any]] = {'id': [trial.id for trial in trials]}
    for number, factor in enumerate(experiment.factors):
        levels = [configuration.levels[number] for configuration in experiment.configurations]
        shown = ['' if level is None else factor.levels[level] for level in levels]
        columns[_free(factor.name, fixed, 'factor')] = [shown[place] for place in places]
    columns.update((name, [getattr(trial, name) for trial in trials]) for name in ('replication', 'seed', 'status'))
    taken = (*fixed, *columns)
    for metric in experiment.metrics:
        columns[_free(metric.name, taken, 'metric')] = [trial.metrics.get(metric.name, math.nan) for trial in trials]
    columns.update((name, [getattr(trial, name) for trial in trials]) for name in _TRIAL_COLUMNS)
    return pd.DataFrame({**columns, 'labels': ['; '.join(trial.labels) for trial in trials]})


def _free(name: str, taken: Sequence[str], kind: str) -> str:
    return f'{kind}.{name}' if name in taken else name


def means(experiment: Experiment) -> pd.DataFrame:
    """Return a frame with a row per metric and configuration: n, mean, its interval, sd, median, least, most."""
    rows = []
    for metric in experiment.metrics:
        values = experiment.values(metric)
        cut = experiment.cut(metric).sum(axis=1)
        for configuration, own, estimate in zip(experiment.configurations, values, effects.summary(experiment, metric)):
            seen = intervals.known(own if estimate.method != 'cut' else [])
            median = intervals.median_estimate(seen)
            rows.append({
                'metric': metric.name, 'unit': metric.unit, **_levels(experiment, configuration.levels),
                **_estimate(estimate), 'sd': intervals.mean_and_sd(seen)[1] if len(seen) > 1 else math.nan,
                'least': min(seen, default=math.nan), 'median': median.value, 'median_low': median.low,
                'median_high': median.high, 'most': max(seen, default=math.nan),
                'skewed': intervals.is_skewed(seen), 'cut': int(cut[configuration.place])})
    return _framed(rows, ('metric', 'unit', *_ESTIMATE))


def _levels(experiment: Experiment, levels: Levels) -> Dict[str, str]:
    return {f'factor.{factor.name}': '' if level is None else factor.levels[level]
            for factor, level in zip(experiment.factors, levels)}


def _estimate(estimate: Estimate) -> Dict[str, Union[float, str]]:
    return dict(zip(_ESTIMATE, (estimate.n, estimate.value, estimate.low, estimate.high, estimate.method)))


def differences(experiment: Experiment, found: Sequence[Difference]) -> pd.DataFrame:
    """Return a frame with a row per effects.Difference."""
    rows = []
    for each in found:
        first, second = comparisons.names_of(experiment, each)
        rows.append({
            'metric': each.metric.name, 'unit': each.metric.unit,
            'factor': '' if each.factor is None else experiment.factors[each.factor].name,
            'first': first, 'second': second, 'at': comparisons.at_text(experiment, each), **_estimate(each.estimate),
            'p': each.p, 'p_holm': each.p_holm, 'verdict': comparisons.verdict_of(each),
            'mean_of_first': each.reference, 'configurations_used': len(each.used),
            'configurations_possible': len(each.groups), 'fewest_pairs': each.fewest,
            **{f'{what}_{name}': getattr(side, what) for name, side in zip(('first', 'second'), each.sides)
               for what in ('run', 'failed', 'without', 'cut')},
            **{f'order_{what}': getattr(each.order, what, '') for what in ('larger', 'smaller', 'same', 'unknown')},
            'median': each.median.value if each.median else math.nan,
            'median_low': each.median.low if each.median else math.nan,
            'median_high': each.median.high if each.median else math.nan})
    return _framed(rows, ('metric', 'unit', 'factor', 'first', 'second', 'at', *_ESTIMATE, 'p', 'p_holm', 'verdict'))


def robots(experiment: Experiment) -> pd.DataFrame:
    """Return a frame with a row per configuration, robot and quantity: the mean over complete trials."""
    sums: Dict[Tuple[int, str, str], List[float]] = {}
    for trial in experiment.trials:
        if trial.status == COMPLETE:
            for robot, quantities in trial.robots.items():
                for quantity, value in quantities.items():
                    sums.setdefault((trial.configuration, robot, quantity), []).append(value)
    rows = []
    for (place, robot, quantity), values in sorted(sums.items(), key=lambda item: item[0][0]):
        levels = _levels(experiment, experiment.configurations[place].levels)
        rows.append({**levels, 'robot': robot, 'quantity': quantity, **_estimate(intervals.mean_estimate(values))})
    return _framed(rows, ('robot', 'quantity', *_ESTIMATE))


def waits(experiment: Experiment) -> pd.DataFrame:
    """Return a frame with the mean wait [s] over complete trials.

    It has a row per configuration and place, zone or lane where robots waited.
    """
    found: Dict[int, Dict[str, None]] = {}
    for trial in experiment.complete:
        for where in trial.waits:
            found.setdefault(trial.configuration, {}).setdefault(where)
    rows = []
    for place in sorted(found):
        own = [trial for trial in experiment.complete if trial.configuration == place]
        levels = _levels(experiment, experiment.configurations[place].levels)
        means_of = {where: intervals.mean_estimate([trial.waits.get(where, 0.0) for trial in own])
                    for where in found[place]}
        rows += [{**levels, 'where': where, **_estimate(estimate)}
                 for where, estimate in sorted(means_of.items(), key=lambda item: (-item[1].value, item[0]))]
    return _framed(rows, ('where', *_ESTIMATE))


def estimate_of(row: Mapping[str, Any]) -> Estimate:
    """Return the intervals.Estimate in a row (a mapping) of such a frame."""
    return intervals.Estimate(row['value'], row['low_95'], row['high_95'], row['n'], row['interval'])


def _framed(rows: Sequence[Dict[str, Union[float, str]]], columns: Sequence[str]) -> pd.DataFrame:
    """Return rows as a frame; without rows it has these columns."""
    return pd.DataFrame(rows) if rows else pd.DataFrame(columns=list(columns))


def csv_text(frame: pd.DataFrame) -> str:
    """Return a frame as CSV text: numbers with ten digits, NaN as an empty field."""
    return frame.to_csv(index=False, float_format=DIGITS, **_line_end())


def _line_end() -> Dict[str, str]:
    """Return pandas' option for the end of lines, which pandas renamed in 1.5."""
    return {'lineterminator' if tuple(map(int, pd.__version__.split('.')[:2])) >= (1, 5) else 'line_terminator': '\n'}
