"""Choose the verdict of a difference: a word that its interval and the outcomes of the trials justify."""

#: verdict: the words before the sentence
VERDICTS = {
    'best': 'best', 'among': 'among the best', 'better': 'better', 'worse': 'worse', 'differs': 'differs',
    'fails': 'fails more', 'survivors': 'of the complete', 'part': 'in part', 'average': 'on average',
    'even': 'the same on average', 'depends': 'depends', 'always': 'in all pairs', 'small': 'may be negligible',
    'negligible': 'negligible', 'weak': 'too weak', 'none': 'not told apart', 'same': 'the same',
    'untold': 'too few trials', 'empty': 'no values', 'cut': 'not compared', 'order': 'by order', 'mean': 'mean'}
ORDER = {'best': 0, 'among': 0, 'better': 0, 'worse': 0, 'differs': 0, 'fails': 0, 'mean': 0, 'survivors': 1, 'part': 1,
         'average': 1, 'even': 1, 'depends': 1, 'always': 1, 'order': 1, 'cut': 2, 'small': 2, 'weak': 2,
         'negligible': 3, 'none': 3, 'same': 3, 'untold': 4, 'empty': 4}
_LAST_RESULT = 1


def is_result(verdict):
    """Return whether a verdict says that something differs, or is a mean without any comparison."""
    return ORDER[verdict] <= _LAST_RESULT


def verdict_of(difference):
    """Return the verdict of an effects.Difference, a key of VERDICTS."""
    estimate, smallest = difference.estimate, difference.metric.smallest
    if difference.is_cut:
        return 'order' if difference.is_ordered else 'cut'
    if not estimate.has_interval:
        return 'untold' if estimate.n else 'empty'
    if estimate.method == 'constant' and estimate.value == 0.0:
        return 'same' if difference.is_everywhere else 'untold'
    if smallest and -smallest < estimate.low and estimate.high < smallest and _is_whole(difference):
        return 'negligible'
    if difference.is_shown:
        return _of_shown(difference)
    if estimate.method in ('constant', 'fixed'):  # the same in each replication; the test of signs needs more of them
        return 'always' if difference.is_everywhere else 'untold' if estimate.value else 'even'
    return 'weak' if difference.is_hint else 'none'


def _is_whole(difference):
    """Return whether a difference leaves nothing out and has an interval with a width."""
    return difference.estimate.method not in ('constant', 'fixed') and not difference.against \
        and len(difference.used) == len(difference.groups) and not any(side.lacking for side in difference.sides)


def _of_shown(difference):
    estimate, metric = difference.estimate, difference.metric
    if difference.against:
        return 'average'
    if len(difference.used) < len(difference.groups):
        return 'part'
    if abs(estimate.value) < metric.smallest:
        return 'small'
    if metric.better is None:
        return 'differs' if difference.sides[0].lacking == difference.sides[1].lacking == 0.0 else 'survivors'
    is_better = (estimate.value < 0.0) == (metric.better == 'lower')
    first, second = difference.sides
    favoured, other = (second, first) if is_better else (first, second)
    if favoured.lacking > other.lacking:  # the better side has lost more trials, which may be the hard ones
        return 'survivors'
    return 'better' if is_better else 'worse'
