"""How far a result can be trusted that used calibrations: the share of goals outside of what they were fitted to."""

from ..outcome import COMPLETE
from ..wording import digits, listed, whole

_WORDS = {'longer': 'were longer than any recorded leg', 'shorter': 'were shorter than any recorded leg',
          'turn': 'began with a larger turn than any recorded leg',
          'narrow': 'passed nearer to what is occupied than any recorded leg'}


def _sums(experiment):
    """Return {quantity: its sum over all robots of all complete trials} of goals and of those that lay outside."""
    sums = {}
    for trial in experiment.trials:
        for quantities in trial.robots.values() if trial.status == COMPLETE else ():
            for name in ('goals_begun', 'goals_beyond', *(f'goals_beyond_{what}' for what in _WORDS)):
                if name in quantities:
                    sums[name] = sums.get(name, 0.0) + quantities[name]
    return sums


def _share(count, of):
    return f'{digits(100.0 * count / of, 2)} %'


def fact(experiment):
    """Return the fact (title, value, more) of an experiment in which calibrations were used that say more, or None."""
    sums = _sums(experiment)
    begun, beyond = sums.get('goals_begun', 0.0), sums.get('goals_beyond', 0.0)
    if not begun:
        return None
    return ('Goals outside of what was recorded', _share(beyond, begun),
            f'{whole(int(beyond))} of {whole(int(begun))}: longer, shorter, with a larger turn or in narrower places '
            'than the legs that the calibrations were fitted to')


def warning(experiment):
    """Return what a reader must know of goals outside of what was recorded, None where all lay inside."""
    sums = _sums(experiment)
    begun, beyond = sums.get('goals_begun', 0.0), sums.get('goals_beyond', 0.0)
    if not beyond:
        return None
    texts = [f'{_share(sums[f"goals_beyond_{what}"], begun)} of goals {words}' for what, words in _WORDS.items()
             if sums.get(f'goals_beyond_{what}')]
    return f'Calibrations were used beyond what they were fitted to: {listed(texts)}. How long these took is ' \
           'extrapolated.'
