"""The pictures as numbers: scales, rows of trials with their means, means over levels. The templates draw them.

Positions are percentages of a row's width, or units of a plot's own size, so that text keeps its size on any screen.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, List, NamedTuple, Optional, Sequence, Tuple

from . import effects
from .design import level_label
from .outcome import FAILED
from .wording import counted, fixed, shortened, with_interval

if TYPE_CHECKING:
    from .colours import Look, Looks
    from .design import Factor, Metric
    from .effects import Level
    from .intervals import Estimate
    from .outcome import Experiment
    from .wording import Scale

TICK_STEPS = 1000  # the number of positions in a row at which a trial can be drawn
PLOT_WIDTH, PLOT_HEIGHT = 360.0, 230.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 52.0, 350.0, 10.0, 196.0  # the area of the lines
_LETTER = 6.4  # the largest width of a letter
_DODGE = 7.0  # the distance between the marks of two lines at one level
_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)  # the steps between the numbers beside a scale, times powers of ten


class Axis(NamedTuple):
    """A range of values, and the texts beside it."""

    low: float
    high: float
    ticks: tuple  # of (value, text)

    def share(self, value: float) -> float:
        """Return where a value lies: 0 at the low end, 1 at the high end."""
        return (value - self.low) / (self.high - self.low)


def axis(values: Sequence[float], parts: int = 5, pad: float = 0.04, with_zero: bool = False) -> Axis:
    """Return the Axis that shows all these values.

    :param values: finite numbers, at least one. :param parts: the largest number of steps between ticks.
    :param pad: the share of the range that is added at each end. :param with_zero: whether the axis must show 0.
    """
    low, high = min(values), max(values)
    if with_zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low <= 1e-9 * max(abs(low), abs(high)):  # all the same: room on both sides
        room = abs(high) * 0.1 or 1.0
        low, high = low - room, high + room
    room = pad * (high - low)
    low, high = low - room, high + room
    step = _step((high - low) / parts)
    decimals = _decimals(step)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return Axis(low, high, tuple((each * step, fixed(each * step, decimals)) for each in range(first, last + 1)))


def _step(least: float) -> float:
    """Return the smallest round step that is at least ``least``."""
    size = 10.0 ** math.floor(math.log10(least))
    return next(each * size for each in _STEPS if each * size >= least * (1.0 - 1e-9))


def _decimals(step: float) -> int:
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return decimals if abs(round(step, decimals) - step) < 1e-6 * step else decimals + 1


class Row(NamedTuple):
    """One configuration: its trials as ticks, its mean with the interval; positions in per cent."""

    label: str
    look: Look
    ticks: str  # an SVG path, x in 0..TICK_STEPS, y in 0..10
    mid: Optional[float]  # None if there is no mean
    low: Optional[float]  # low and high are None if there is no interval
    high: Optional[float]
    text: str
    note: str


class Strips(NamedTuple):
    """Rows over one axis."""

    rows: tuple
    ticks: tuple  # of (per cent, text)


class Point(NamedTuple):
    """A mean in a plot, in the plot's units; low and high are None where there is no interval."""

    x: float
    y: Optional[float]
    low: Optional[float]
    high: Optional[float]
    tip: str


class Line(NamedTuple):
    """The means of one level of a factor, or of all trials."""

    label: str
    look: Optional[Look]
    path: str
    points: tuple  # of (colours.Look, Point)
    dash: str


class Plot(NamedTuple):
    """Means over the levels of a factor; with two factors one line per level of the second."""

    title: str
    y_ticks: tuple  # of (y, text)
    x_ticks: tuple  # of (x, text, whole text)
    lines: tuple
    note: str


def strips(experiment: Experiment, metric: Metric, scale: Scale, looks: Looks,
           estimates: Sequence[Estimate]) -> Optional[Strips]:
    """Return the Strips of a metric, or None if no trial has a value."""
    values = [[value * scale.factor for value in row if not math.isnan(value)]
              for row in experiment.values(metric)]
    seen = [value for row in values for value in row]
    if not seen:
        return None
    for estimate in estimates:
        seen += [bound * scale.factor for bound in estimate[1:3] if estimate.has_interval]
    along = axis(seen)
    rows = tuple(_row(configuration.label, looks.of_levels(configuration.levels), row, estimate, scale, along)
                 for configuration, row, estimate in zip(experiment.configurations, values, estimates))
    rows = tuple(row._replace(text=f'{row.text}; {int(failed)} failed') if failed else row
                 for row, failed in zip(rows, experiment.count(FAILED)))
    return Strips(rows, tuple((_percent(along.share(value)), text) for value, text in along.ticks))


def _row(label: str, look: Look, values: Sequence[float], estimate: Estimate, scale: Scale, along: Axis) -> Row:
    places = sorted({round(TICK_STEPS * along.share(value)) for value in values})
    mid, low, high = (None if math.isnan(value) else _percent(along.share(value * scale.factor))
                      for value in estimate[:3])
    return Row(label, look, ''.join(f'M{place} 0v10' for place in places), mid, low, high,
               with_interval(estimate, scale) if estimate.method != 'cut' else 'no mean: cut off by the limit of time',
               counted(estimate.n, 'trials'))


def _percent(share: float) -> float:
    return round(100.0 * share, 2)


def factor_plot(experiment: Experiment, metric: Metric, scale: Scale, looks: Looks, factor: int) -> Optional[Plot]:
    """Return the Plot of a metric over the levels of a factor, or None if no level has a value."""
    levels, is_like_for_like = effects.levels_of(experiment, metric, factor)
    about = experiment.factors[factor]
    lines = [('', None, levels)]
    note = '' if is_like_for_like else 'Not all levels were run with the same levels of the other factors.'
    return _plot(f'by {about.title}', about, lines, scale, note,
                 lambda level: looks.of_level(factor, level))


def pair_plot(experiment: Experiment, metric: Metric, scale: Scale, looks: Looks,
              pair: Tuple[int, int]) -> Optional[Plot]:
    """Return the Plot of a metric over two factors, or None if there is no value.

    Each line is a level of one of the two factors: of the one that gives the colours, if it is among them.
    """
    across, along = _roles(experiment.factors, pair, looks)
    lines = []
    for level in range(len(experiment.factors[across].levels)):
        found, _ = effects.levels_of(experiment, metric, along, ((across, level),))
        if found:
            lines.append((level_label(experiment.factors, across, level), looks.of_level(across, level), found))
    about = experiment.factors[along]
    return _plot(f'by {about.title} and {experiment.factors[across].title}', about, lines, scale, '')


def _roles(factors: Sequence[Factor], pair: Tuple[int, int], looks: Looks) -> Tuple[int, int]:
    """Return which of two factors makes the lines, and which lies along the axis."""
    if looks.colour_factor in pair:
        across = looks.colour_factor
    else:
        across = min(pair, key=lambda place: (factors[place].is_numeric, len(factors[place].levels)))
    return across, pair[0] if pair[1] == across else pair[1]


def _plot(title: str, about: Factor, lines: Sequence[Tuple[str, Optional[Look], List[Level]]], scale: Scale, note: str,
          look_of: Callable[[int], Optional[Look]] = lambda level: None) -> Optional[Plot]:
    """Return the Plot of lines, or None if there is no value.

    :param lines: tuples (label, look, effects.Levels). :param look_of: returns the look of a level, for a line whose
        own look is None.
    """
    seen = [bound * scale.factor for _, _, levels in lines for each in levels for bound in each.estimate[:3]
            if not math.isnan(bound)]
    if not seen:
        return None
    up = axis(seen, parts=5, pad=0.06)
    count = len(about.levels)
    drawn = []
    for number, (label, look, levels) in enumerate(lines):
        shift = _DODGE * (number - (len(lines) - 1) / 2.0) * min(1.0, 5.0 / len(lines))
        points = [(look or look_of(each.level), _point(each, about, label, scale, up, count, shift))
                  for each in levels if not math.isnan(each.estimate.value)]
        is_joined = len(points) > 1 and (about.is_numeric or label)
        path = 'M' + 'L'.join(f'{point.x:g} {point.y:g}' for _, point in points) if is_joined else ''
        drawn.append(Line(label, look, path, tuple(points), _dash(number, look)))
    wide = max(4, int((_RIGHT - _LEFT) / count / _LETTER))
    every = max(1, math.ceil(count / 12))
    x_ticks = tuple((_x(place, count), shortened(text, wide) if place % every == 0 else '', text)
                    for place, text in enumerate(about.levels))
    return Plot(title, tuple((_y(up, value), text) for value, text in up.ticks), x_ticks, tuple(drawn), note)


def _dash(number: int, look: Optional[Look]) -> str:
    """Return the dash pattern of a line. Lines without a colour of their own need one, to be told apart."""
    if look is None or look.colour is not None:
        return ''
    return ('', '6 3', '2 3', '8 3 2 3', '1 2', '10 4')[number % 6]


def _point(level: Level, about: Factor, label: str, scale: Scale, up: Axis, count: int, shift: float) -> Point:
    value, low, high = (None if math.isnan(each) else _y(up, each * scale.factor) for each in level.estimate[:3])
    where = ', '.join(filter(None, (f'{about.title} {about.levels[level.level]}', label)))
    return Point(round(_x(level.level, count) + shift, 1), value, low, high,
                 f'{where}: {with_interval(level.estimate, scale)}')


def _x(place: int, count: int) -> float:
    return round(_LEFT + (_RIGHT - _LEFT) * (place + 0.5) / count, 1)


def _y(up: Axis, value: float) -> float:
    return round(_BOTTOM - (_BOTTOM - _TOP) * up.share(value), 1)
