"""The charts of the report, as PNG bytes."""

import io
import math

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from soil_mapping.comparison import METRICS, PUBLISHED_OVERALL_SPEED_UPS, PUBLISHED_TABLE, cosine_similarity

from .collection import CONFIGURATION_NAMES, LOCKSTEP, as_study, common_seeds, configuration_order, mean, metric_column
from .tables import UNITS, group_title

DPI = 90
# nominal factor, achieved speed-ups, errors of the legs [%] of the published system on a 2-core machine
PUBLISHED_LEGS = ((10, (4.9, 5.6), (12.0, 19.0)), (15, (4.8, 6.8), (17.0, 28.0)), (100, (15.0, 20.0), (60.0, 196.0)))
COLOURS = ('#4c72b0', '#dd8452', '#55a868', '#c44e52', '#8172b3', '#937860', '#da8bc3', '#8c8c8c', '#ccb974')


def box_plots(groups):
    """Return a chart of all metrics: a box per group and configuration, whiskers to the extremes within 1.5 boxes."""
    shown = {name: trials for name, trials in groups.items() if not name.startswith(LOCKSTEP + '-')}
    names = sorted({trial.configuration for trials in shown.values() for trial in trials}, key=configuration_order)
    figure = Figure(figsize=(13.0, 8.0))
    for axes, metric in zip(figure.subplots(2, 3).flat, METRICS):
        for at, (group, trials) in enumerate(shown.items()):
            columns = [metric_column([trial for trial in trials if trial.configuration == name], metric)
                       for name in names]
            columns = [[value for value in column if not math.isnan(value)] for column in columns]
            places = np.arange(len(names)) + (at + 0.5) / len(shown) * 0.8 - 0.4
            boxes = axes.boxplot(columns, positions=places, widths=0.7 / len(shown), patch_artist=True,
                                 manage_ticks=False, medianprops={'color': 'black'}, flierprops={'markersize': 3})
            for box in boxes['boxes']:
                box.set_facecolor(COLOURS[at % len(COLOURS)])
            axes.plot([], [], 's', color=COLOURS[at % len(COLOURS)], label=group_title(group))
        axes.set_xticks(range(len(names)))
        axes.set_xticklabels([CONFIGURATION_NAMES.get(name, name) for name in names])
        axes.set_title(UNITS[metric])
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc='lower center', ncol=min(6, len(shown)))
    # Room for the legend; its place 'outside' would come with matplotlib 3.7 only.
    figure.tight_layout(rect=(0.0, 0.02 + 0.03 * math.ceil(len(shown) / 6), 1.0, 1.0))
    return _png(figure)


def error_against_speed(groups):
    """Return a chart: error of the legs, and dissimilarity, against the speed-up that was achieved."""
    figure = Figure(figsize=(13.0, 5.0), constrained_layout=True)
    left, right = figure.subplots(1, 2)
    _draw_legs(left, groups)
    _draw_cosines(right, groups)
    return _png(figure)


def _draw_legs(axes, groups):
    for number, (nominal, speeds, errors) in enumerate(PUBLISHED_LEGS):
        axes.fill_between(speeds, *([error] * 2 for error in errors), color='0.6', alpha=0.5,
                          label='published system' if number == 0 else None)
        axes.annotate(f'{nominal}x', (speeds[1], errors[1]), color='0.4')
    for name, trials in groups.items():
        errors = [error for trial in trials for error in trial.leg_errors]
        if name.startswith('ros-') and errors and not name.startswith(LOCKSTEP + '-'):
            speed, error = mean([trial.speed_up['moving'] for trial in trials]), 100.0 * mean(errors)
            axes.plot(speed, error, 'o', color=COLOURS[0])
            axes.annotate(group_title(name), (speed, error), xytext=(4, 4), textcoords='offset points')
    axes.set(xscale='log', xlabel='speed-up while moving [simulated s per wall s]', ylabel='mean error of the legs [%]',
             title='Legs too long')
    axes.set_yscale('symlog', linthresh=0.1)
    _make_room(axes, (-0.02, 1000.0))


def _draw_cosines(axes, groups):
    published = {f'{factor:g}x': (speed, value) for (factor, speed), (_, _, value)
                 in zip(PUBLISHED_OVERALL_SPEED_UPS, PUBLISHED_TABLE[1:])}
    for number, (label, (speed, value)) in enumerate(published.items()):
        axes.plot(speed, 1.0 - value, 's', color='0.5', label='published (against 1x)' if number == 0 else None)
        axes.annotate(label, (speed, 1.0 - value), color='0.4', xytext=(4, 4), textcoords='offset points')
    for name, trials in groups.items():
        seeds = common_seeds(trials, groups.get(LOCKSTEP, []))
        if name.startswith('ros-') and seeds and not name.startswith(LOCKSTEP + '-'):
            distance = 1.0 - cosine_similarity(as_study(groups[LOCKSTEP], seeds), as_study(trials, seeds))
            speed = mean([trial.speed_up['overall'] for trial in trials])
            axes.plot(speed, max(0.0, distance), 'o', color=COLOURS[0])
            axes.annotate(group_title(name), (speed, max(0.0, distance)), xytext=(4, 4), textcoords='offset points')
    axes.set(xscale='log', xlabel='speed-up over all [simulated s per wall s]',
             ylabel='1 - mean cosine similarity to lockstep', title='Dissimilarity')
    axes.set_yscale('symlog', linthresh=1e-4)
    _make_room(axes, (-2e-5, 1.0))


def _make_room(axes, limits):
    """Leave room for texts at the right, the legend and what lies at 0."""
    left, right = axes.get_xlim()
    axes.set(xlim=(left, 3.0 * right), ylim=limits)
    axes.legend(loc='lower left')


def _png(figure):
    stream = io.BytesIO()
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(DPI)
    canvas.print_png(stream, metadata={'Software': None})
    return stream.getvalue()
