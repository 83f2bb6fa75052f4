"""How far a result that used calibrations can be trusted: the share of goals outside of what was recorded for them."""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, Optional, Tuple

from move_base_abstract.common.shown import listed

from ..outcome import COMPLETE
from ..wording import digits, whole

if TYPE_CHECKING:
    from ..outcome import Experiment

_WORDS = {'longer': 'were longer than any recorded leg', 'shorter': 'were shorter than any recorded leg',
          'turn': 'began with a larger turn than any recorded leg',
          'narrow': 'passed nearer to what is occupied than any recorded leg'}


def _sums(experiment: Experiment) -> Dict[str, float]:
    """Return {quantity: sum over all robots of all complete trials} for all goals and for goals outside."""
    sums: Dict[str, float] = {}
    for trial in experiment.trials:
        for quantities in trial.robots.values() if trial.status == COMPLETE else ():
            for name in ('goals_begun', 'goals_beyond', *(f'goals_beyond_{what}' for what in _WORDS)):
                if name in quantities:
                    sums[name] = sums.get(name, 0.0) + quantities[name]
    return sums


def _share(count: float, of: float) -> str:
    return f'{digits(100.0 * count / of, 2)} %'


def fact(experiment: Experiment) -> Optional[Tuple[str, str, str]]:
    """Return the fact (title, value, note) about goals outside of what was recorded, None if no trial counts them."""
    sums = _sums(experiment)
    begun, beyond = sums.get('goals_begun', 0.0), sums.get('goals_beyond', 0.0)
    if not begun:
        return None
    return ('Goals outside of what was recorded', _share(beyond, begun),
            f'{whole(int(beyond))} of {whole(int(begun))}: longer, shorter, with a larger turn or in narrower places '
            'than the legs that the calibrations were fitted to')


def warning(experiment: Experiment) -> Optional[str]:
    """Return the warning about goals outside of what was recorded, or None if all goals lay inside."""
    sums = _sums(experiment)
    begun, beyond = sums.get('goals_begun', 0.0), sums.get('goals_beyond', 0.0)
    if not beyond:
        return None
    texts = [f'{_share(sums[f"goals_beyond_{what}"], begun)} of goals {words}' for what, words in _WORDS.items()
             if sums.get(f'goals_beyond_{what}')]
    return f'Calibrations were used beyond what they were fitted to: {listed(texts)}. How long these took is ' \
           'extrapolated.'
