"""How trials ended, in words: which failed, which the limit of time ended, and whether the shares of these differ."""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Optional, Sequence

from .. import effects, endings, listings
from ..findings import of_differences
from ..outcome import COMPLETE, FAILED
from ..wording import UNKNOWN, Scale, whole, with_interval

if TYPE_CHECKING:
    from ..effects import Difference
    from ..findings import Finding
    from ..outcome import Experiment, Trial
    from ..parts import Table

MOST_OPEN = 16  # a table with more rows is folded
SCALE = Scale(100.0, '%')
_HEADERS = {'failed': 'share that failed', 'limit': 'share ended by the limit of time'}
_ENDS = {endings.LIMIT: 'limit of time', 'time_limit': 'limit of wall time', 'topic': 'message'}
_NOTE = "Shares have Wilson's interval. The limit of time is that of simulated time (until: seconds). Its share is " \
        'of complete trials.'


def findings(experiment: Experiment, mains: Sequence[Difference], singles: Sequence[Difference]) -> List[Finding]:
    """Return the Findings about the shares of trials that failed, or that the limit of time ended.

    :param mains, singles: effects.outcome_differences of the experiment.
    """
    return [finding for metric in experiment.outcomes
            for finding in of_differences(experiment, effects.of_metric(metric, mains, singles), SCALE)
            if finding.verdict != 'same']


def tables(experiment: Experiment, mains: Sequence[Difference], singles: Sequence[Difference]) -> List[Optional[Table]]:
    """Return the tables of the same differences."""
    return [listings.differences(experiment, f'{metric.title}: differences', effects.of_metric(metric, mains, singles),
                                 SCALE, 'tables/endings.csv') for metric in experiment.outcomes]


def table(experiment: Experiment) -> Optional[Table]:
    """Return the table of how the trials of each configuration ended, or None if experiment.outcomes is empty."""
    outcomes = experiment.outcomes
    shares = [effects.summary(experiment, metric) for metric in outcomes]
    rows: List[listings.Row] = []
    for configuration in experiment.configurations if outcomes else ():
        own = experiment.trials_of(configuration)
        counts = [sum(trial.status == status for trial in own) for status in (COMPLETE, FAILED)]
        cells = [with_interval(each[configuration.place], SCALE) if each[configuration.place].n else UNKNOWN
                 for each in shares]
        rows.append((configuration.label, whole(sum(counts)), whole(counts[1]), *cells, _ends_text(own)))
    header = ('configuration', 'run', 'failed', *(f'{_HEADERS[metric.outcome]} (95 % interval)' for metric in outcomes),
              'ended by')
    return listings.listing('How trials ended, by configuration', header, rows, 'trials.csv', _NOTE,
                            len(rows) <= MOST_OPEN)


def _ends_text(trials: Sequence[Trial]) -> str:
    """Return how trials ended, the most frequent way first: 'idle 28, limit of time 2'."""
    counts: Dict[str, int] = {}
    for trial in trials:
        if trial.ended_by:
            counts[trial.ended_by] = counts.get(trial.ended_by, 0) + 1
    ordered = sorted(counts.items(), key=lambda item: -item[1])
    return ', '.join(f'{_ENDS.get(name, name)} {whole(count)}' for name, count in ordered)


def ends_text(experiment: Experiment) -> str:
    """Return how all trials ended, in words: 'idle 28, limit of time 2'."""
    return _ends_text(experiment.trials)
