"""The charts in the study's sections of the report."""
from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from soil_mapping.results.comparison import PUBLISHED_OVERALL_SPEED_UPS, PUBLISHED_TABLE, cosine_similarity

from .groups import FACTORS, LOCKSTEP
from .outcomes import as_study, common_seeds, mean
from .tables import group_title

# nominal factor, achieved speed-ups, errors of the legs [%]: the published system on a machine with 2 cores
PUBLISHED_LEGS = ((10, (4.9, 5.6), (12.0, 19.0)), (15, (4.8, 6.8), (17.0, 28.0)), (100, (15.0, 20.0), (60.0, 196.0)))
COLOUR = '#4c72b0'


def error_against_speed(groups: Any) -> Any:
    """Return a matplotlib Figure: error of the legs, and dissimilarity, against the achieved speed-up."""
    figure = Figure(figsize=(13.0, 5.0), constrained_layout=True)
    left, right = figure.subplots(1, 2)
    _draw_legs(left, groups)
    _draw_cosines(right, groups)
    return figure


def _draw_legs(axes: Any, groups: Any) -> None:
    for number, (nominal, speeds, errors) in enumerate(PUBLISHED_LEGS):
        axes.fill_between(speeds, *([error] * 2 for error in errors), color='0.6', alpha=0.5,
                          label='published system' if number == 0 else None)
        axes.annotate(f'{nominal}x', (speeds[1], errors[1]), color='0.4')
    for name, trials in groups.items():
        found = [error for trial in trials for error in trial.leg_errors]
        if (name in FACTORS or name == LOCKSTEP) and found:
            speed, error = mean([trial.speed_up['moving'] for trial in trials]), 100.0 * mean(found)
            axes.plot(speed, error, 'o', color=COLOUR)
            axes.annotate(group_title(name), (speed, error), xytext=(4, 4), textcoords='offset points')
    axes.set(xscale='log', xlabel='speed-up while moving [simulated s per wall s]', ylabel='mean error of the legs [%]',
             title='Legs too long')
    axes.set_yscale('symlog', linthresh=0.1)
    _make_room(axes, (-0.02, 1000.0))


def _draw_cosines(axes: Any, groups: Any) -> None:
    published = {f'{factor:g}x': (speed, value) for (factor, speed), (_, _, value)
                 in zip(PUBLISHED_OVERALL_SPEED_UPS, PUBLISHED_TABLE[1:])}
    for number, (label, (speed, value)) in enumerate(published.items()):
        axes.plot(speed, 1.0 - value, 's', color='0.5', label='published (against 1x)' if number == 0 else None)
        axes.annotate(label, (speed, 1.0 - value), color='0.4', xytext=(4, 4), textcoords='offset points')
    for name, trials in groups.items():
        seeds = common_seeds(trials, groups.get(LOCKSTEP, []))
        if (name in FACTORS or name == LOCKSTEP) and seeds:
            distance = 1.0 - cosine_similarity(as_study(groups[LOCKSTEP], seeds), as_study(trials, seeds))
            speed = mean([trial.speed_up['overall'] for trial in trials])
            axes.plot(speed, max(0.0, distance), 'o', color=COLOUR)
            axes.annotate(group_title(name), (speed, max(0.0, distance)), xytext=(4, 4), textcoords='offset points')
    axes.set(xscale='log', xlabel='speed-up over all [simulated s per wall s]',
             ylabel='1 - mean cosine similarity to lockstep', title='Dissimilarity')
    axes.set_yscale('symlog', linthresh=1e-4)
    _make_room(axes, (-2e-5, 1.0))


def _make_room(axes: Any, limits: Any) -> None:
    """Leave room for texts at the right, for the legend, and for points at 0."""
    left, right = axes.get_xlim()
    axes.set(xlim=(left, 3.0 * right), ylim=limits)
    axes.legend(loc='lower left')
