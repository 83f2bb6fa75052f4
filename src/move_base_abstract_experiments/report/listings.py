"""The page's tables: cells are texts, with units; a table has no more rows than people can read."""
from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from move_base_abstract.runs.states import STATES

from . import comparisons, endings, intervals, notable_trials
from .design import level_label
from .outcome import COMPLETE, FAILED, MISSING
from .parts import Cell, Table
from .wording import NBSP, UNKNOWN, Scale, counted, digits, estimate_texts, probability, whole, with_interval

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd

    from .design import Metric
    from .effects import Difference
    from .intervals import Estimate
    from .notable_trials import Pick
    from .outcome import Experiment, Trial

MOST_ROWS = 200  # the largest number of rows in a table of the page
_INTERVALS = {'t': 'Student', 'wilson': 'Wilson', 'newcombe': 'Newcombe', 'order': 'order statistics',
              'constant': 'all the same', 'fixed': 'the same per seed',
              'none': 'none', 'cut': 'cut off'}

#: the cells of a row of a table
Row = Tuple[Union[None, str, Cell], ...]


def listing(title: str, header: Sequence[str], rows: Sequence[Row], where: str, note: str = '',
            is_open: bool = False) -> Optional[Table]:
    """Return a Table, None if it has no rows; if it has too many, its note says that the file ``where`` has all."""
    if len(rows) > MOST_ROWS:
        note = f'The first {MOST_ROWS} of {whole(len(rows))}; all are in {where}. {note}'.strip()
    return Table(title, tuple(header), tuple(rows[:MOST_ROWS]), note, is_open) if rows else None


def means(experiment: Experiment, metric: Metric, scale: Scale,
          estimates: Sequence[Estimate]) -> Optional[Table]:
    """Return the table of a metric's means."""
    values = experiment.values(metric) * scale.factor
    rows, skewed = [], False
    picks = notable_trials.picks(experiment, metric) if metric.better else []
    chosen = {(pick.configuration, pick.role): pick for pick in picks}
    for configuration, own, estimate in zip(experiment.configurations, values, estimates):
        seen = intervals.known(own)
        is_skewed = not metric.is_share and estimate.method != 'cut' and intervals.is_skewed(seen)
        skewed = skewed or is_skewed
        cells = _of_values(seen) if estimate.method != 'cut' else (UNKNOWN,) * 4
        rows.append((configuration.label + (' *' if is_skewed else ''), whole(estimate.n),
                     with_interval(estimate, scale._replace(unit='')), _INTERVALS[estimate.method], *cells,
                     *(_link(experiment, chosen.get((configuration.place, role))) for role in ('median', 'worst')
                       if chosen)))
    header = ('configuration', 'trials', 'mean (95 % interval)', 'interval', 'sd', 'least', 'median (95 % interval)',
              'most', *(('median trial', 'worst trial') if chosen else ()))
    note = 'sd: standard deviation of the trials.'
    if any(estimate.method == 'cut' for estimate in estimates):
        note += ' Cut off: the limit of time ended trials, so there is no mean of what they would have measured.'
    if skewed:
        note += ' *: the values are skewed, so the interval of the mean is in doubt; use the median.'
    return listing(f'Means{_in(scale)}', header, rows, 'tables/means.csv', note)


def _of_values(seen: np.ndarray) -> Tuple[str, str, str, str]:
    """Return the standard deviation, least, median and most of values in the unit that is shown, as texts."""
    sd = intervals.mean_and_sd(seen)[1] if len(seen) > 1 else math.nan
    median = intervals.median_estimate(seen)
    return (digits(sd, 3), digits(min(seen, default=math.nan)), with_interval(median, Scale(1.0, '')),
            digits(max(seen, default=math.nan)))


def _in(scale: Scale) -> str:
    return f' in {scale.unit}' if scale.unit else ''


def _link(experiment: Experiment, pick: Optional[Pick]) -> Union[str, Cell]:
    return Cell(pick.trial.id, notable_trials.link(experiment, pick.trial)) if pick else ''


def differences(experiment: Experiment, title: str, found: Sequence[Difference], scale: Scale,
                where: str) -> Optional[Table]:
    """Return the table of one metric's effects.Differences, or None if there are none."""
    if not found:
        return None
    unit = comparisons.difference_scale(found[0].metric, scale)
    rows, beside = [], [comparisons.asides(experiment, each, unit) for each in found]
    columns = [name for name in comparisons.ASIDES if any(name in each for each in beside)]
    for each, aside in zip(found, beside):
        first, second = comparisons.names_of(experiment, each)
        value, low, high = estimate_texts(each.estimate, unit)
        rows.append((f'{second} − {first}', comparisons.at_text(experiment, each) or 'all',
                     comparisons.pairs_text(each), value, f'{low} to {high}' if low else UNKNOWN,
                     _probability(each.p), _probability(each.p_holm),
                     comparisons.VERDICTS[comparisons.verdict_of(each)][0], *(aside.get(name, '') for name in columns)))
    header = ('difference', 'with', 'pairs', 'mean difference', '95 % interval', 'p', 'Holm p', 'verdict', *columns)
    smallest = found[0].metric.smallest
    note = f'The smallest difference that counts: {digits(smallest * scale.factor)}{scale.suffix}.' if smallest else ''
    return listing(f'{title}{_in(unit)}', header, rows, where, note)


def _probability(p: float) -> str:
    return probability(p).replace(f'={NBSP}', '')


def changes(experiment: Experiment, found: Sequence[Difference], scale: Scale) -> Optional[Table]:
    """Return the table of one metric's interactions, or None if there are none."""
    if not found:
        return None
    unit = comparisons.difference_scale(found[0].metric, scale)
    rows: List[Row] = []
    for each in found:
        first, second = comparisons.names_of(experiment, each)
        places = [level_label(experiment.factors, *place) for place in each.at]
        value, low, high = estimate_texts(each.estimate, unit)
        rows.append((f'{second} − {first}', f'{places[1]} − {places[0]}', whole(each.estimate.n), value,
                     f'{low} to {high}' if low else UNKNOWN, _probability(each.p), _probability(each.p_holm),
                     comparisons.VERDICTS[_of_change(comparisons.verdict_of(each))][0]))
    return listing(f'How differences depend on other factors{_in(unit)}', (
        'difference of', 'from', 'replications', 'change', '95 % interval', 'p', 'Holm p', 'verdict'), rows,
        'tables/interactions.csv')


def _of_change(verdict: str) -> str:
    return 'differs' if verdict in ('better', 'worse') else verdict


def configurations(experiment: Experiment) -> Optional[Table]:
    """Return the table of the configurations: the numbers of trials, their length and their speed."""
    rows: List[Row] = []
    for configuration in experiment.configurations:
        own = experiment.trials_of(configuration)
        counts = [sum(trial.status == status for trial in own) for status in (COMPLETE, FAILED, MISSING)]
        complete = [trial for trial in own if trial.status == COMPLETE]
        speed = intervals.median_estimate([trial.times_real_time for trial in complete])
        span = intervals.mean_estimate([trial.simulated_seconds for trial in complete])
        rows.append((configuration.label, *map(whole, counts), digits(span.value), digits(speed.value, 2)))
    return listing('Configurations', ('configuration', 'complete', 'failed', 'not run', 'simulated s per trial',
                                      'times real time (median)'), rows, 'trials.csv')


def factors(experiment: Experiment) -> Optional[Table]:
    """Return the table of the factors, or None if there are none."""
    return listing('Factors and levels', ('factor', 'levels'), [
        (factor.title, ', '.join(factor.levels)) for factor in experiment.factors], 'plan.json')


def worth_a_look(experiment: Experiment, metric: Metric, scale: Scale, found: Sequence[Pick]) -> Optional[Table]:
    """Return the table of the worst and the median trial of each configuration."""
    rows: List[Row] = []
    for pick in found:
        rows.append((experiment.configurations[pick.configuration].label, pick.role,
                     digits(pick.value * scale.factor) + scale.suffix + _bound(experiment, metric, pick.trial),
                     str(pick.trial.replication),
                     str(pick.trial.seed), Cell(pick.trial.id, notable_trials.link(experiment, pick.trial))))
    return listing('Worst and median trials', (
        'configuration', 'which', metric.title, 'replication', 'seed', 'trial'), rows, 'trials.csv',
        is_open=len(rows) <= 24)


def _bound(experiment: Experiment, metric: Metric, trial: Trial) -> str:
    """Return the words that follow a value which the limit of time has cut off, '' if it is complete."""
    if not endings.is_cut(experiment, metric, trial):
        return ''
    return ' or more' if metric.at_limit in endings.BOUNDS else ' (cut off)'


def failures(experiment: Experiment) -> Optional[Table]:
    """Return the table of trials with an error, failed or complete, grouped by the error; None if there are none."""
    groups: Dict[Tuple[str, str], List[Trial]] = {}
    for trial in experiment.trials:
        if trial.error:
            groups.setdefault((trial.error, trial.status), []).append(trial)
    rows: List[Row] = []
    for (error, status), trials in sorted(groups.items(), key=lambda item: -len(item[1])):
        first = trials[0]
        where = notable_trials.node_logs(experiment, first) or notable_trials.event_log(experiment, first)
        labels = list(dict.fromkeys(experiment.configurations[trial.configuration].label for trial in trials))
        rows.append((error, status, whole(len(trials)), '; '.join(labels[:3]) + ('; ...' if len(labels) > 3 else ''),
                     Cell(first.id, where), whole(max(trial.attempts for trial in trials))))
    header = ('error', 'status', 'trials', 'configurations', 'first of them', 'attempts')
    return listing('Trials by the first line of their error', header, rows, 'trials.csv', is_open=True)


def error_lines(experiment: Experiment) -> Optional[Table]:
    """Return the table of the ERROR and FATAL lines of participants, or None if there are none."""
    groups: Dict[Tuple[str, str], List[Trial]] = {}
    for trial in experiment.trials:
        for line in trial.error_lines:
            groups.setdefault(line, []).append(trial)
    rows: List[Row] = [(node, first, whole(len(trials)), Cell(trials[0].id, notable_trials.event_log(
        experiment, trials[0]))) for (node, first), trials in sorted(groups.items(), key=lambda one: -len(one[1]))]
    return listing('ERROR and FATAL lines', ('participant', 'its first such line', 'trials', 'first of them'), rows,
                   'trials/*/trial.json')


def labels(experiment: Experiment) -> Optional[Table]:
    """Return the table of the reasons why trials may not be repeatable, or None if there are none."""
    counts: Dict[str, int] = {}
    for trial in experiment.complete:
        for label in dict.fromkeys(trial.labels):
            counts[label] = counts.get(label, 0) + 1
    return listing('Why trials may not be repeatable, or are of another program', ('label', 'trials'), [
        (label, whole(count)) for label, count in sorted(counts.items(), key=lambda item: -item[1])], 'trials.csv')


def not_identical(experiment: Experiment) -> Optional[Table]:
    """Return the table of trials whose second run was different, or None if there are none."""
    rows: List[Row] = [(experiment.configurations[trial.configuration].label,
                        Cell(trial.id, notable_trials.event_log(experiment, trial)),
                        trial.difference or 'not recorded')
                       for trial in experiment.complete if trial.verified == 'different']
    return listing('Trials that were different when run again', ('configuration', 'trial', 'first difference'), rows,
                   'trials.csv', is_open=True)


def robots(frame: pd.DataFrame) -> Optional[Table]:
    """Return the table of a frame of frames.robots, or None if it is empty."""
    names = {'distance_m': 'distance [m]', **{state.key: f'{state.name} [s]' for state in STATES},
             'goals_begun': 'goals begun', 'goals_beyond': 'goals outside of what was recorded'}
    columns = [name for name in dict.fromkeys(frame['quantity']) if not name.startswith('goals_beyond_')]
    factors_of = [name for name in frame.columns if name.startswith('factor.')]
    rows: Dict[Any, Dict[str, str]] = {}
    for record in frame.to_dict('records'):
        key = tuple(record[name] for name in factors_of), record['robot']
        rows.setdefault(key, {})[record['quantity']] = digits(record['value'])
    cells: List[Row] = [
        (', '.join(filter(None, levels)) or UNKNOWN, robot, *(values.get(name, '') for name in columns))
        for (levels, robot), values in rows.items()]
    header = ('configuration', 'robot', *(names.get(name, name) for name in columns))
    return listing('Each robot', header, cells, 'tables/robots.csv',
                   'Means over the complete trials; a trial that the limit of time ended counts until then.')


def provenance(experiment: Experiment) -> Optional[Table]:
    """Return the table of versions, machine and seeds with which the trials were run."""
    rows = list(_flat('', experiment.plan.get('provenance') or {}))
    seeds = list(dict.fromkeys(str(trial.seed) for trial in experiment.trials))
    shown = ', '.join(seeds[:12]) + (f', ... ({counted(len(seeds), "seeds")})' if len(seeds) > 12 else '')
    rows.append(('seeds', shown or 'none'))
    return listing('Versions, machine, seeds', ('what', 'value'), rows, 'plan.json', is_open=True)


def _flat(name: str, value: Mapping[str, Union[Dict[str, str], int]]) -> Iterator[Tuple[str, str]]:
    """Yield (name, text) for each value in nested mappings; the name joins the keys by commas."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from _flat(f'{name}, {key}' if name else str(key), inner)
    else:
        yield (name or 'provenance', value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)[:1000])
