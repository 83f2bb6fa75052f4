"""The tables of the report, with texts in their cells. Other modules decide how they look."""
from __future__ import annotations

import math
from typing import Any, Dict, List

import numpy as np

from move_base_abstract_experiments.report.parts import Table
from soil_mapping.results.comparison import (
    METRICS,
    PUBLISHED_TABLE,
    bootstrap_interval,
    cosine_similarity,
    differences,
    metric_cosines,
    noise_floor,
    similarity_interval,
)

from .groups import EIGHT, FACTORS, LOCKSTEP, MESA, REAL_TIME
from .outcomes import CONFIGURATION_NAMES, as_study, common_seeds, mean
from .wording import (
    NOT_MEASURED,
    ROUNDING,
    UNKNOWN,
    change,
    duration,
    in_deviations,
    number,
    percent,
    range_of_similarity,
    similarity,
    span,
)

UNITS = {'rmse_kpa': 'RMSE [kPa]', 'mean_variance_kpa2': 'mean kriging variance [kPa²]', 'samples': 'samples',
         'distance_m': 'distance [m]', 'idle_s': 'idle time [s]', 'task_s': 'mean task time [s]'}
ENOUGH_PAIRS = 5  # with fewer pairs a bootstrap interval is too narrow to show a difference
SCALE_NOTE = (
    'Relative error of the means; 95 % interval of the difference within a pair of trials, in the unit of the column, '
    'by bootstrap of the pairs, corrected for the number of cells in the table; standardised difference (sd: standard '
    f'deviations of the trials). *: at least {ENOUGH_PAIRS} pairs, and 0 lies outside the interval: a difference is '
    'shown. With fewer pairs the interval is too narrow.')
COSINE_NOTE = (
    'Mean over six metrics of the cosine between vectors of configuration means, of pairs of trials with the same '
    'seeds. The pairs of the published table come first. Interval: by bootstrap of the pairs. Noise '
    'floor: the range of the scores of two runs of the first study that differ by chance only, by bootstrap of its '
    'trials; a score within it shows neither a difference nor that there is none. A metric that is 0 in one study only '
    'scores 0. '
    'Standardised difference: that of the means, in standard deviations of the trials (sd); it depends on scale.')


def group_title(name: str) -> Any:
    """Return the title of a group, for people."""
    titles = {MESA: 'Mesa', EIGHT: 'Mesa, eight directions', LOCKSTEP: 'ROS, lockstep'}
    return titles.get(name) or f'ROS, {name.partition("-")[2]}'


def published_pairs(groups: Any) -> Any:
    """Return the pairs of groups of the published Table 1; both kinds of Mesa stand for its Mesa (eight directions)."""
    mesa = [name for name in (MESA, EIGHT) if name in groups] or [MESA]
    return [*((name, 'ros-10x') for name in mesa), ('ros-1x', 'ros-10x'), ('ros-1x', 'ros-15x')]


def pairs(groups: Any) -> Any:
    """Return the pairs of names of groups that are compared: those of the published Table 1 first, then all others."""
    scaled = [name for name in groups if name in FACTORS]
    wanted = published_pairs(groups)
    wanted += [(MESA, LOCKSTEP), (EIGHT, LOCKSTEP), (MESA, EIGHT)]
    wanted += [(LOCKSTEP, name) for name in scaled]
    wanted += [(REAL_TIME, name) for name in scaled if name != REAL_TIME]
    return [pair for pair in dict.fromkeys(wanted) if all(name in groups for name in pair)]


def overview(groups: Any) -> Any:
    """Return the table of the groups that ran, with their speeds."""
    rows = []
    for name, trials in groups.items():
        wall = [sum(trial.wall_s.get(part, 0.0) for part in ('start_up', 'mission', 'end')) for trial in trials]
        rows.append((group_title(name), str(len(trials)), number(mean([trial.speed_up['moving'] for trial in trials])),
                     number(mean([trial.speed_up['overall'] for trial in trials])), number(mean(wall)),
                     *(number(mean([trial.wall_s.get(part, math.nan) for trial in trials]), NOT_MEASURED)
                       for part in ('start_up', 'mission', 'kriging', 'allocation', 'messages', 'end'))))
    return Table('What was run', ('trials of', 'number', 'speed-up moving', 'speed-up overall', 'wall s per trial',
                                  'start-up', 'mission', 'kriging', 'allocation', 'messages', 'end'), tuple(rows),
                 'Means. Speed-up: simulated seconds per wall second, while the mission runs and with start-up. '
                 'Kriging, allocation and messages are parts of the mission. Output is not counted. '
                 f'{NOT_MEASURED}: these trials have no such part.')


def cosines(groups: Any) -> Any:
    """Return the published table, and below it, in the same form, its pairs of studies and then all others."""
    rows = [(first, second, f'{value:.9f}', '', '', '', 'published') for first, second, value in PUBLISHED_TABLE]
    wanted = list(dict.fromkeys([*published_pairs(groups), *pairs(groups)]))
    for first, second in wanted:
        lacking = [group_title(name) for name in (first, second) if name not in groups]
        seeds = common_seeds(groups.get(first, []), groups.get(second, []))
        if lacking:
            hint = '; real time runs with STUDY_1X=1' if 'ros-1x' in (first, second) and 'ros-1x' not in groups else ''
            cells = ('', '', '', '', f'not run: {", ".join(lacking)}{hint}')
        elif not seeds:
            cells = ('', '', '', '', 'no common seeds')
        else:
            cells = _compared(groups[first], groups[second], seeds)
        rows.append((group_title(first), group_title(second), *cells))
    return Table('Similarity of studies', ('first', 'second', 'mean_cosine_similarity', '95 % interval',
                                           'noise floor (95 %)', 'largest standardised difference', 'source'),
                 tuple(rows), COSINE_NOTE)


def _compared(first: Any, second: Any, seeds: Any) -> Any:
    """Return similarity, interval, noise floor, largest difference and source of two studies, for these seeds."""
    a, b = as_study(first, seeds), as_study(second, seeds)
    trials = max(1, len(seeds) // len(a))
    interval = floor = f'{UNKNOWN} (one trial each)'
    if trials > 1:
        interval = range_of_similarity(*similarity_interval(a, b))
        floor = range_of_similarity(*noise_floor(as_study(first), trials))
    found = [each for each in differences(a, b) if not math.isnan(each.standardised)]
    largest = UNKNOWN
    if found:
        most = max(found, key=lambda each: abs(each.standardised))
        place = f'{CONFIGURATION_NAMES.get(most.configuration, most.configuration)}, {UNITS[most.metric]}'
        largest = f'{in_deviations(most)} ({place})' if most.standardised else '0'
    return similarity(cosine_similarity(a, b)), interval, floor, largest, f'{len(seeds)} pairs of trials'


def cosines_per_metric(groups: Any) -> Any:
    """Return the cosine of each metric for each pair of studies."""
    rows = []
    for first, second in pairs(groups):
        seeds = common_seeds(groups[first], groups[second])
        if seeds:
            found = metric_cosines(as_study(groups[first], seeds), as_study(groups[second], seeds))
            rows.append((group_title(first), group_title(second),
                         *(UNKNOWN if math.isnan(value) else f'{value:.6f}' for value in found)))
    return Table('Cosine per metric', ('first', 'second', *(UNITS[name] for name in METRICS)), tuple(rows))


def scale_errors(groups: Any) -> Any:
    """Return a table for each pair of studies: relative errors of means, intervals, standardised differences."""
    tables: List[Any] = []
    for first, second in pairs(groups):
        seeds = common_seeds(groups[first], groups[second])
        if seeds:
            a, b = as_study(groups[first], seeds), as_study(groups[second], seeds)
            found = differences(a, b)
            cells: Dict[Any, Any] = {}
            for each in found:
                cells.setdefault(each.configuration, []).append(_scale_cell(each, a, b, len(found)))
            tables.append(Table(f'{group_title(second)} against {group_title(first)}',
                                ('configuration', *(UNITS[name] for name in METRICS)),
                                tuple((CONFIGURATION_NAMES.get(name, name), *row) for name, row in cells.items()),
                                '' if tables else SCALE_NOTE))
    return tables


def _scale_cell(each: Any, first: Any, second: Any, comparisons: Any) -> str:
    """Return relative error, interval of the difference and standardised difference of one Difference."""
    column = METRICS.index(each.metric)
    paired = second[each.configuration][:, column] - first[each.configuration][:, column]
    paired = paired[~np.isnan(paired)]
    if len(paired) < 2:
        return f'{change(each)}; pairs with a value: {len(paired)}'
    low, high = bootstrap_interval([0.0], paired, comparisons)
    shown = ' *' if len(paired) >= ENOUGH_PAIRS and (low > ROUNDING or high < -ROUNDING) else ''
    return f'{change(each)}; {span(low, high)}; {in_deviations(each)}{shown}'


def legs(groups: Any) -> Any:
    """Return the table of the times that legs took too long."""
    rows = []
    for name, trials in groups.items():
        errors = np.array([error for trial in trials for error in trial.leg_errors])
        errors_ns = np.array([error for trial in trials for error in trial.leg_errors_ns])
        if name != EIGHT and len(errors):
            largest = int(np.abs(errors_ns).max())
            rows.append((group_title(name), str(len(errors)), percent(float(errors.mean())),
                         percent(float(np.abs(errors).max())), duration(float(errors_ns.mean())),
                         duration(largest) if largest else '0: exact'))
    return Table('Error of the legs', ('trials of', 'legs', 'mean, share of the leg', 'largest, share of the leg',
                                       'mean, simulated', 'largest, simulated'), tuple(rows),
                 'The time that a leg took too long, from the command to the arrival as the coordinator sees them, '
                 'against distance over speed. The published system: 12 to 19 % at nominal 10x, 17 to 28 % at 15x, '
                 '60 to 196 % at 100x.')


def identities(groups: Any) -> Any:
    """Return the table that says whether runs that must be identical are identical."""
    reference = {(trial.configuration, trial.seed): trial for trial in groups.get(LOCKSTEP, [])}
    pairs_of_both = [(trial, reference[trial.configuration, trial.seed]) for trial in groups.get(MESA, [])
                     if (trial.configuration, trial.seed) in reference]
    same = sum(one.events_sha256 == other.events_sha256 for one, other in pairs_of_both)
    rows = [(f'{group_title(MESA)} and {group_title(LOCKSTEP)}', str(len(pairs_of_both)), str(same),
             'yes' if same == len(pairs_of_both) else 'no')] if pairs_of_both else []
    return Table('Identical runs', ('runs', 'pairs', 'identical', 'identical: yes/no'), tuple(rows),
                 'The same mission on both engines: its event log, to the byte. Trials that ran twice on one engine '
                 'are under Repeatability.', True)
