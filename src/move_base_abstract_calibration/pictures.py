"""The pictures of a calibration's page, as PNG bytes."""
from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import matplotlib

matplotlib.use('Agg')
import matplotlib.pyplot as plt
import numpy as np

from .fit import succeeded
from .law import Durations

if TYPE_CHECKING:
    from .check import Predicted
    from .law import Values
    from .legs import Pairs

_BLUE, _GREY, _RED = '#1f6fb4', '#9a9a9a', '#c0392b'


def draw(values: Values, pairs: Pairs,
         predicted: Predicted) -> bytes:
    """Return the PNG of four plots: three of ``predicted`` (Predicted, by cross-validation), one of the tail.

    ``values``: {parameter of a calibration: value}; ``pairs``: [(leg, way)] for the plot of the tail.
    """
    figure, ((scatter, errors), (chances, tail)) = plt.subplots(2, 2, figsize=(11.0, 9.0))
    try:
        _scatter(scatter, predicted)
        _errors(errors, predicted)
        _chances(chances, predicted)
        _tail(tail, values, pairs)
        figure.tight_layout()
        stream = io.BytesIO()
        figure.savefig(stream, format='png', dpi=90, metadata={'Software': None})
    finally:
        plt.close(figure)
    return stream.getvalue()


def _scatter(axes: Any, predicted: Predicted) -> None:
    most = 1.05 * max(predicted.measured.max(), predicted.median.max())
    axes.plot([0, most], [0, most], color='black', linewidth=0.8)
    axes.scatter(predicted.straight, predicted.measured, s=9, color=_GREY, label='straight line at nominal speed')
    axes.scatter(predicted.median, predicted.measured, s=9, color=_BLUE, label='calibrated: median, held out')
    axes.set(xlabel='predicted [s]', ylabel='measured [s]', xlim=(0, most), ylim=(0, most),
             title='Durations of legs')
    axes.legend(loc='lower right', frameon=False)


def _errors(axes: Any, predicted: Predicted) -> None:
    levels = np.arange(1, len(predicted.measured) + 1) / len(predicted.measured)
    for guess, colour, label in ((predicted.straight, _GREY, 'straight line at nominal speed'),
                                 (predicted.median, _BLUE, 'calibrated, held out')):
        wrong = np.sort(np.abs(guess - predicted.measured) / predicted.measured)
        axes.plot(100.0 * wrong, levels, color=colour, label=label)
    axes.axhline(0.5, color='black', linewidth=0.5)
    axes.set(xscale='log', xlim=(0.1, 100.0), ylim=(0.0, 1.0), xlabel='error of the duration [%]',
             ylabel='share of legs with at most that', title='Errors')
    axes.legend(loc='upper left', frameon=False)


def _chances(axes: Any, predicted: Predicted) -> None:
    axes.hist(predicted.below, bins=np.linspace(0.0, 1.0, 21), color=_BLUE)
    axes.axhline(len(predicted.below) / 20.0, color='black', linewidth=0.8)
    axes.set(xlim=(0.0, 1.0), xlabel='predicted chance of at most the measured duration', ylabel='legs',
             title='Even where the distributions are right')


def _tail(axes: Any, values: Values, pairs: Pairs) -> None:
    used = succeeded(pairs)
    law = Durations(values, [way for _, way in used])
    excess = np.array([leg.duration for leg, _ in used]) - law.least
    turns = np.degrees(np.abs([way.start_turn for _, way in used]))
    axes.scatter(turns, excess, s=9, color=_BLUE)
    axes.set(xlabel='turn at the start [degrees]', ylabel='measured later than by the phases alone [s]', xlim=(0, 180),
             title='The tail')
    share = axes.twinx()
    share.plot(*np.transpose([[np.degrees(turn), 100.0 * chance] for turn, chance in values['tail_chance_by_turn']]),
               color=_RED)
    share.set(ylim=(0, 100))
    share.set_ylabel('fitted chance of the tail by the turn [%]', color=_RED)
