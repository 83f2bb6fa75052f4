"""The tables of the report, as text in cells: what they say is decided here, how they look elsewhere."""

import math
from dataclasses import dataclass

import numpy as np

from soil_mapping.comparison import (
    METRICS,
    PUBLISHED_TABLE,
    cosine_similarity,
    differences,
    metric_cosines,
    noise_floor,
)

from .collection import (
    CONFIGURATION_NAMES,
    LOCKSTEP,
    MESA,
    as_study,
    common_seeds,
    configuration_order,
    is_identical,
    mean,
    metric_column,
)

UNITS = {'rmse_kpa': 'RMSE [kPa]', 'mean_variance_kpa2': 'mean kriging variance [kPa²]', 'samples': 'samples',
         'distance_m': 'distance [m]', 'idle_s': 'idle time [s]', 'task_s': 'mean task time [s]'}


@dataclass(frozen=True)
class Table:
    """A heading, a row of column titles, rows of cells, and a paragraph that says how to read it."""

    title: str
    header: tuple
    rows: tuple
    note: str = ''


def group_title(name):
    """Return a group's name for people."""
    titles = {MESA: 'Mesa', 'mesa-eight': 'Mesa, eight directions', LOCKSTEP: 'ROS, lockstep'}
    if name in titles:
        return titles[name]
    kind, _, rest = name.partition('-')
    return f'{kind.upper()}, {rest.replace("-", " ")}' if rest else name


def pairs(groups):
    """Return the pairs of groups that are compared, as names: what there is of the ones that the study asks about."""
    scaled = [name for name in groups if name.startswith('ros-') and name.endswith('x') and name.count('-') == 1]
    wanted = [(MESA, LOCKSTEP), ('mesa-eight', LOCKSTEP), (MESA, 'mesa-eight')]
    wanted += [(LOCKSTEP, name) for name in scaled]
    wanted += [('ros-1x', name) for name in scaled if name != 'ros-1x']
    return [pair for pair in wanted if all(name in groups for name in pair)]


def overview(groups):
    """Return what was run, and how fast."""
    rows = []
    for name, trials in groups.items():
        wall = [sum(trial.wall_s.get(part, 0.0) for part in ('start_up', 'mission', 'end')) for trial in trials]
        rows.append((group_title(name), str(len(trials)), number(mean([trial.speed_up['moving'] for trial in trials])),
                     number(mean([trial.speed_up['overall'] for trial in trials])), number(mean(wall)),
                     *(number(mean([trial.wall_s.get(part, math.nan) for trial in trials]))
                       for part in ('start_up', 'mission', 'kriging', 'allocation', 'messages', 'end'))))
    return Table('What was run', ('trials of', 'number', 'speed-up moving', 'speed-up overall', 'wall s per trial',
                                  'start-up', 'mission', 'kriging', 'allocation', 'messages', 'end'), tuple(rows),
                 'Means. Speed-up: simulated seconds per wall second, while the mission runs and with start-up. '
                 'Kriging, allocation and messages are parts of the mission. Output is not counted.')


def cosines(groups):
    """Return the published table with ours below it, each of ours with its noise floor."""
    rows = [(first, second, f'{value:.9f}', '', '', 'published') for first, second, value in PUBLISHED_TABLE]
    for first, second in pairs(groups):
        seeds = common_seeds(groups[first], groups[second])
        if seeds:
            rows.append((group_title(first), group_title(second), *_compared(groups[first], groups[second], seeds)))
    return Table('Similarity of studies', ('first', 'second', 'mean_cosine_similarity', 'noise floor (95 %)',
                                           'largest standardised difference', 'source'), tuple(rows),
                 'Mean over six metrics of the cosine between vectors of configuration means. It is blunt: two halves '
                 'of one study score 0.97 to 0.98, and a metric that is 0 in one study alone scores 0. Noise floor: '
                 'the range in which two runs of the first study lie that differ by chance only (bootstrap of its '
                 'trials). Standardised difference: of the means, in standard deviations of the trials; it feels scale '
                 '(unknown with one trial per configuration). Pairs of trials with the same seeds only.')


def _compared(first, second, seeds):
    a, b = as_study(first, seeds), as_study(second, seeds)
    trials = max(1, len(seeds) // len(a))
    low, high = noise_floor(as_study(first), trials)
    sizes = [abs(each.standardised) for each in differences(a, b)]
    largest = 'unknown' if any(map(math.isnan, sizes)) else number(max(sizes))
    return f'{cosine_similarity(a, b):.9f}', f'{low:.4f} to {high:.4f}', largest, f'{len(seeds)} pairs of trials'


def cosines_per_metric(groups):
    """Return the cosine of each metric, per pair of studies."""
    rows = []
    for first, second in pairs(groups):
        seeds = common_seeds(groups[first], groups[second])
        if seeds:
            found = metric_cosines(as_study(groups[first], seeds), as_study(groups[second], seeds))
            rows.append((group_title(first), group_title(second), *(f'{value:.6f}' for value in found)))
    return Table('Cosine per metric', ('first', 'second', *(UNITS[name] for name in METRICS)), tuple(rows))


def scale_errors(groups):
    """Return one table per pair of studies: relative error of the means, and standardised difference."""
    tables = []
    for first, second in pairs(groups):
        seeds = common_seeds(groups[first], groups[second])
        if not seeds:
            continue
        cells = {}
        for each in differences(as_study(groups[first], seeds), as_study(groups[second], seeds)):
            cells.setdefault(each.configuration, []).append(f'{percent(each.relative)} ({number(each.standardised)})')
        tables.append(Table(f'{group_title(second)} against {group_title(first)}',
                            ('configuration', *(UNITS[name] for name in METRICS)),
                            tuple((CONFIGURATION_NAMES.get(name, name), *row) for name, row in cells.items()),
                            'Relative error of the means; in brackets the standardised difference.'))
    return tables


def metric_tables(groups):
    """Return one table per metric: mean and standard deviation of each group and configuration."""
    names = sorted({trial.configuration for trials in groups.values() for trial in trials}, key=configuration_order)
    tables = []
    for metric in METRICS:
        rows = []
        for group, trials in groups.items():
            own = [metric_column([trial for trial in trials if trial.configuration == name], metric) for name in names]
            rows.append((group_title(group), *(mean_and_sd(values) for values in own)))
        tables.append(Table(UNITS[metric], ('trials of', *(CONFIGURATION_NAMES.get(name, name) for name in names)),
                            tuple(rows), 'Mean ± standard deviation (number of trials).'))
    return tables


def legs(groups):
    """Return how much too long the legs took."""
    rows = []
    for name, trials in groups.items():
        errors = np.array([error for trial in trials for error in trial.leg_errors])
        errors_ns = np.array([error for trial in trials for error in trial.leg_errors_ns])
        if name != 'mesa-eight' and len(errors):
            rows.append((group_title(name), str(len(errors)), percent(float(errors.mean())),
                         percent(float(np.abs(errors).max())), f'{int(np.abs(errors_ns).max())} ns'))
    return Table('Error of the legs', ('trials of', 'legs', 'mean', 'largest', 'largest, simulated'), tuple(rows),
                 'How much longer a leg took, from the command to the arrival as the coordinator sees them, than '
                 'distance over speed. The published system: 12 to 19 % at nominal 10x, 17 to 28 % at 15x, 60 to 196 % '
                 'at 100x.')


def identities(groups):
    """Return, for runs that must be the same run, whether they are."""
    rows = []
    reference = {(trial.configuration, trial.seed): trial for trial in groups.get(LOCKSTEP, [])}
    for name, trials in groups.items():
        if name == LOCKSTEP or not (name == MESA or name.startswith(LOCKSTEP)):
            continue
        both = [(trial, reference[trial.configuration, trial.seed]) for trial in trials
                if (trial.configuration, trial.seed) in reference]
        same = sum(is_identical(*pair) for pair in both)
        if both:
            rows.append((f'{group_title(name)} and {group_title(LOCKSTEP)}', str(len(both)), str(same),
                         'yes' if same == len(both) else 'no'))
    return Table('Identical runs', ('runs', 'pairs', 'identical', 'identical: yes/no'), tuple(rows),
                 'The same seed again, limited to a speed, and on loaded cores: event logs of the mission and of the '
                 'robots, to the byte. Mesa: the event log of the mission, to the byte.')


def mean_and_sd(values):
    """Return 'mean ± sd (n)' of those values that are not NaN."""
    known = np.array([value for value in values if not math.isnan(value)])
    if not len(known):
        return 'none'
    spread = number(float(known.std(ddof=1))) if len(known) > 1 else 'unknown'
    return f'{number(float(known.mean()))} ± {spread} ({len(known)})'


def number(value):
    """Return a number with four digits that say something."""
    if math.isnan(value):
        return 'none'
    return f'{value:.4g}' if abs(value) < 1e4 else f'{value:.0f}'


def percent(share):
    """Return a share as per cent."""
    return 'none' if math.isnan(share) else f'{100.0 * share:.3g} %'
