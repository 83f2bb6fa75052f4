"""How trials ended, in words: which failed, which the limit of time ended, and whether the shares of these differ."""

from .. import effects, endings, intervals
from ..findings import Finding
from ..outcome import COMPLETE, FAILED
from ..parts import Table
from ..phrases import amount, between, with_level
from ..ranking import turned
from ..sentences import difference_scale, exceptions, over_text, pairs_text, sentence_case, spoken
from ..wording import NBSP, UNKNOWN, Scale, counted, listed, probability, whole, with_interval

MOST_TOLD = 6  # the most shown differences per way of ending that have sentences; all are in tables/endings.csv
MOST_ROWS = 200
MOST_OPEN = 16  # a table with more rows is folded
SCALE = Scale(100.0, '%')
_HEADERS = {'failed': 'share that failed', 'limit': 'share ended by the limit of time'}
_ENDS = {endings.LIMIT: 'limit of time', 'time_limit': 'limit of wall time', 'topic': 'message'}
_NOTE = "Shares have Wilson's interval. The limit of time is that of simulated time (until: seconds). Its share is " \
        'of complete trials.'
_DONE = {'failed': 'failed', 'limit': 'were ended by the limit of time'}


def findings(experiment, mains, singles):
    """Return the Findings about the shares of trials that failed, or that the limit of time ended.

    :param mains, singles: effects.outcome_differences of the experiment.
    """
    found = []
    for metric in experiment.outcomes:
        own = [each for each in mains if each.metric is metric]
        shown = [each for each in own if each.is_shown]
        known = {each.factor for each in shown}
        shown += [each for each in singles if each.metric is metric and each.is_shown and each.factor not in known]
        shown.sort(key=lambda each: -abs(each.estimate.value))
        told = [_finding(experiment, each) for each in shown[:MOST_TOLD]]
        rest = [each for each in own or [each for each in singles if each.metric is metric]
                if each.factor not in {one.factor for one in shown}]
        told += [_finding(experiment, each) for each in _largest(rest)]
        found += told
    return found


def _largest(differences):
    """Return the largest Difference of each factor; differences of 0 or without an interval are left out."""
    largest = {}
    for each in differences:
        if each.estimate.has_interval and abs(each.estimate.value) > abs(
                largest[each.factor].estimate.value if each.factor in largest else 0.0):
            largest[each.factor] = each
    return list(largest.values())


def _finding(experiment, difference):
    """Return the Finding of a Difference of shares; its sentence names the larger share first."""
    if difference.estimate.value < 0.0:
        difference = turned(difference)
    metric = difference.metric
    first, second, than = spoken(experiment, difference)
    counts = [_counted(experiment, difference, side) for side in (1, 0)]
    scale = difference_scale(metric, SCALE)
    over, pairs = over_text(experiment, difference), pairs_text(difference)
    rest = exceptions(experiment, difference, scale)
    held = listed(with_level(experiment.factors, *each) for each in difference.at)
    where = f' (both with {held})' if difference.at else ''
    text = f'{counts[0]} {_DONE[metric.outcome]} with {second}, {counts[1].replace(" trials", "")} with {than}{where}'
    if difference.is_shown:
        size, interval = amount(difference.estimate, scale)
        size = size.replace('higher', 'more')
        verdict = 'average' if difference.against else 'part' if len(difference.used) < len(difference.groups) else \
            'fails' if metric.outcome == 'failed' else 'differs'
        return Finding(metric.title, verdict, sentence_case(f'{text}: {size}{over} ({interval}; {pairs}).') + rest,
                       None)
    if difference.estimate.value == 1.0:  # every pair shows it, but there are too few pairs for the test
        return Finding(metric.title, 'always', sentence_case(
            f'{text}: in every pair, but there are too few pairs for a test ({pairs}).') + rest, None)
    why = f'too weak to count (Holm p{NBSP}{probability(difference.p_holm)})' \
        if difference.is_hint else 'not told apart'
    return Finding(metric.title, 'weak' if difference.is_hint else 'none', sentence_case(
        f'{text}: {why}, the difference lies between {between(difference.estimate, scale)}'
        f'{over} (95 % interval; {pairs}).') + rest, None)


def _counted(experiment, difference, side):
    """Return the words '15 of 30 trials' about one side (0: first, 1: second) of a Difference."""
    places = sorted({group[side] for group in difference.used})
    values = intervals.known(experiment.values(difference.metric)[places])
    return f'{whole(int(values.sum()))} of {counted(len(values), "trials")}'


def table(experiment):
    """Return the table of how the trials of each configuration ended, or None if experiment.outcomes is empty."""
    outcomes = experiment.outcomes
    if not outcomes:
        return None
    shares = [effects.summary(experiment, metric) for metric in outcomes]
    rows = []
    for configuration in experiment.configurations:
        own = experiment.trials_of(configuration)
        counts = [sum(trial.status == status for trial in own) for status in (COMPLETE, FAILED)]
        cells = [with_interval(each[configuration.place], SCALE) if each[configuration.place].n else UNKNOWN
                 for each in shares]
        rows.append((configuration.label, whole(sum(counts)), whole(counts[1]), *cells, _ends_text(own)))
    header = ('configuration', 'run', 'failed', *(f'{_HEADERS[metric.outcome]} (95 % interval)' for metric in outcomes),
              'ended by')
    return Table('How trials ended, by configuration', header, tuple(rows[:MOST_ROWS]), _NOTE,
                 is_open=len(rows) <= MOST_OPEN)


def _ends_text(trials):
    """Return how trials ended, the most frequent way first: 'idle 28, limit of time 2'."""
    counts = {}
    for trial in trials:
        if trial.ended_by:
            counts[trial.ended_by] = counts.get(trial.ended_by, 0) + 1
    ordered = sorted(counts.items(), key=lambda item: -item[1])
    return ', '.join(f'{_ENDS.get(name, name)} {whole(count)}' for name, count in ordered)


def ends_text(experiment):
    """Return how all trials ended, in words: 'idle 28, limit of time 2'."""
    return _ends_text(experiment.trials)
