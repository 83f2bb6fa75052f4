"""The content of the page report.html, from an experiment and its statistics. The markup is in the Jinja2 templates."""
from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Any,
    Dict,
    Iterable,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Union,
)
from urllib.parse import quote

import jinja2

from move_base_abstract.common.shown import listed
from move_base_abstract.runs.states import STATES

from . import (
    design,
    effects,
    endings,
    findings,
    frames,
    intervals,
    listings,
    notable_trials,
    pictures,
)
from .colours import Looks
from .outcome import FAILED, MISSING
from .parts import Section, there
from .sections import fleet, how_ended, properties, validity
from .wording import MINUS, NBSP, UNKNOWN, counted, digits, duration, scale_of, whole

if TYPE_CHECKING:
    from .design import Metric
    from .effects import Difference
    from .findings import Finding
    from .outcome import Experiment
    from .parts import Table
    from .pictures import Plot
    from .wording import Scale

MARK = 'report of an experiment of move_base_abstract'
MOST_ROWS = 16  # the number of configurations that are shown unfolded; with more, all of them are folded
MOST_PLOTTED = 5  # the number of factors that are plotted in pairs
_TEMPLATES = Path(__file__).with_name('templates')
_NUMBER = re.compile(f'[{MINUS}+<{NBSP}]*[0-9][0-9,.]*(·10.*)?|{UNKNOWN}|')


class Analysis(NamedTuple):
    """An experiment, and the statistics of it that the page and the tables share."""

    experiment: Experiment
    scales: Dict[str, Scale]  # by the name of the metric
    looks: Looks
    mains: List[Difference]
    singles: List[Difference]
    changes: List[Difference]
    endings: Tuple[List[Difference], List[Difference]]  # (between levels, between configurations) of how trials ended


class Shares(NamedTuple):
    """A section with bars that show how the robots spent their time."""

    heading: str
    states: tuple  # names of those in which any robot was
    shares: tuple  # of (label, look, (name, per cent) pairs, text)
    parts: tuple


def analyse(experiment: Experiment) -> Analysis:
    """Return the Analysis of an Experiment."""
    scales = {}
    for metric in experiment.metrics:
        values = intervals.known(experiment.values(metric))
        scales[metric.name] = scale_of(metric, max(map(abs, values), default=0.0))
    return Analysis(experiment, scales, Looks(experiment), effects.main_effects(experiment),
                    effects.single_differences(experiment), effects.interactions(experiment),
                    effects.outcome_differences(experiment))


def render(analysis: Analysis, added: Sequence[Section], problems: Sequence[str] = ()) -> str:
    """Return the page as text.

    :param added: parts.Sections that the study adds. :param problems: lines about parts that could not be made.
    """
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(str(_TEMPLATES)), trim_blocks=True,
                                     lstrip_blocks=True, autoescape=True, undefined=jinja2.StrictUndefined)
    environment.filters['address'] = lambda text: quote(str(text), safe="/:#?&=%@!$'()*+,;~-._")
    environment.filters['columns'] = _columns
    text = environment.get_template('report.html.j2').render(
        page=_page(analysis, added, problems), mark=MARK, states=STATES, colours=analysis.looks.colours)
    return '\n'.join(line for line in (each.rstrip() for each in text.splitlines()) if line) + '\n'


def _columns(table: Table) -> List[str]:
    """Return the class of the cells for each column of a parts.Table: 'n' for numbers, which are aligned right."""
    columns = [[getattr(row[place], 'text', row[place]) for row in table.rows if place < len(row)]
               for place in range(len(table.header))]
    return ['n' if texts and all(_NUMBER.fullmatch(str(text)) for text in texts) else '' for texts in columns]


def _page(analysis: Analysis, added: Sequence[Section],
          problems: Sequence[str]) -> Dict[str, Any]:
    experiment = analysis.experiment
    told = findings.findings(experiment, analysis.scales, analysis.mains, analysis.singles, analysis.changes)
    others = [each for each in told if not each.is_primary] if any(each.is_primary for each in told) else []
    told = [each for each in told if each not in others]
    with_result = {each.metric for each in told if each.is_result}  # the findings of other metrics are never folded
    return dict(
        title=experiment.name, lede=_lede(experiment), warnings=_warnings(experiment), most_rows=MOST_ROWS,
        ended=_by_metric(how_ended.findings(experiment, *analysis.endings)),
        ended_tables=there((
            how_ended.table(experiment), *how_ended.tables(experiment, *analysis.endings),
            listings.failures(experiment), listings.error_lines(experiment))),
        results=_by_metric(each for each in told if each.is_result or each.metric not in with_result),
        no_results=_by_metric(each for each in told if not each.is_result and each.metric in with_result),
        other_results=_by_metric(others),
        findings_notes=_findings_notes(analysis), facts=_facts(experiment),
        run_tables=there((listings.factors(experiment), listings.configurations(experiment))),
        metrics_notes=_metrics_notes(experiment),
        metrics=[_metric(analysis, metric) for metric in experiment.metrics],
        sections=there((
            properties.section(experiment), _robots(analysis), fleet.section(experiment), *added, _looks(analysis),
            _repeatable(experiment), _method(analysis), _provenance(experiment, problems))))


def _by_metric(told: Iterable[Finding]) -> List[Tuple[str, List[Finding]]]:
    """Return pairs (title of a metric, its Findings)."""
    groups: Dict[str, List[Finding]] = {}
    for each in told:
        groups.setdefault(each.metric, []).append(each)
    return list(groups.items())


def _lede(experiment: Experiment) -> str:
    varied = [factor.title for factor in experiment.factors if len(factor.levels) > 1]
    what = f'{counted(len(experiment.configurations), "configurations")}'
    by = f' of {listed(varied)}' if varied else ''
    trials = f'{counted(len(experiment.complete), "trials")} complete of {whole(len(experiment.trials))} planned'
    return f'{what}{by}; {trials}.'


def _warnings(experiment: Experiment) -> List[str]:
    """Return the warnings that a reader must see before the findings."""
    complete = experiment.complete
    failed, missing = (sum(trial.status == status for trial in experiment.trials) for status in (FAILED, MISSING))
    share = 100.0 * failed / max(1, len(experiment.trials) - missing)
    found = (
        ('Trials that failed', failed, f' ({digits(share, 2)} % of those that have run). ' + (
            'The figures of all metrics are of the other trials only: if it is the hard trials that failed, the '
            'figures look too good. A pair counts in a comparison only if both of its trials are complete.'
            if complete else 'So there are no figures.')),
        ('Trials that were kept from before', sum(bool(trial.kept) for trial in complete),
         ': what they are made of has changed since (see Repeatability). Means are over the trials of all programs; '
         'the two trials of a pair are always of the same program.'),
        ('Complete trials with an error', sum(bool(trial.error) for trial in complete),
         ', for example in the metrics: see How trials ended.'),
        ('Complete trials that the limit of time ended',
         endings.has_limited(experiment) and sum(trial.ended_by == endings.LIMIT for trial in complete),
         '. Their values are cut off: they have no mean and are compared by order at most, except for metrics whose '
         'at_limit says that the value is complete.'),
        ('Trials of the plan that have not run yet', missing, '.'),
        ('Trials that were different when run again', sum(trial.verified == 'different' for trial in complete),
         ': see Repeatability.'))
    return [*(f'{what}: {whole(count)}{says}' for what, count, says in found if count),
            *there((properties.warning(experiment), validity.warning(experiment))),
            *design.unknown_names(experiment.plan, experiment.factors, experiment.metrics)]


def _findings_notes(analysis: Analysis) -> List[str]:
    found = analysis.mains or analysis.singles
    primary = sum(each.metric.is_primary for each in found)
    counts = f'all {whole(len(found))} comparisons' if not primary else \
        f'all {whole(primary)} comparisons by the primary metric, or all {whole(len(found) - primary)} by the others,'
    return ['Differences are taken within replications (same seed), and count as shown only if a test at the 5 % '
            f'level shows them with {counts} counted (Holm). Each interval holds by itself, not all of them together. '
            'Not told apart does not mean equal: the interval says which differences are still possible. The little '
            'pictures of one metric and factor have the same scale, with a dashed line at 0.'] if found else []


def _metrics_notes(experiment: Experiment) -> List[str]:
    if not experiment.complete:
        return []
    return ['Each tick is a trial. The mark is the mean, and its bar is the 95 % interval of the mean. In plots over '
            'factors, a mean is over all levels of the factors that the plot does not name, the levels have equal '
            'distances, and bars are 95 % intervals. Even if two bars overlap, the difference within replications may '
            'be clear: see the tables.']


def _facts(experiment: Experiment) -> List[Tuple[str, str, str]]:
    complete = experiment.complete
    plan = experiment.plan
    varied = [f'{factor.title}: {counted(len(factor.levels), "levels")}' for factor in experiment.factors
              if len(factor.levels) > 1]
    simulated = intervals.known([trial.simulated_seconds for trial in complete])
    wall = intervals.known([trial.wall_seconds for trial in complete])
    speeds = intervals.known([trial.times_real_time for trial in complete])
    ends = how_ended.ends_text(experiment)
    facts = [('Trials complete', f'{whole(len(complete))} of {whole(len(experiment.trials))}', ''),
             ('Configurations', whole(len(experiment.configurations)), '; '.join(varied)),
             ('Replications', whole(len({trial.replication for trial in experiment.trials})),
              'replication k has the same seed in every configuration'),
             ('A trial lasts', until_text(plan.get('until')), f'ended by: {ends}' if ends else '')]
    if len(simulated):
        facts.append(('Simulated time', duration(math.fsum(simulated)), 'all complete trials together'))
    if len(speeds):
        median = intervals.median_estimate(speeds).value
        slow, fast = (digits(each, 2) for each in (min(speeds), max(speeds)))
        facts.append(('Speed', f'{digits(median, 2)} times real time',
                      f'median; {slow} to {fast}' if slow != fast else ''))
    facts += there([validity.fact(experiment)])
    if len(wall):
        facts.append(('Wall time of the trials', duration(math.fsum(wall)), 'all complete trials, one after the other'))
    return facts


def until_text(until: Optional[Dict[str, Any]]) -> str:
    """Return in words when a trial ends, from the ``until`` of the plan."""
    forms = {'seconds': '{} s simulated', 'topic': 'until a message on {}', 'idle': 'until all are idle'}
    words = [forms.get(key, f'{key} {{}}').format(digits(value, 6) if isinstance(value, (int, float))
                                                  else design.level_text(value))
             for key, value in (until or {}).items() if value not in (None, False)]
    return ', or '.join(words) or 'until it ends'


def _metric(analysis: Analysis, metric: Metric) -> Dict[str, Any]:
    """Return the part of the page about a metric, as a mapping for the template."""
    experiment, looks = analysis.experiment, analysis.looks
    scale = analysis.scales[metric.name]
    estimates = effects.summary(experiment, metric)
    shown = pictures.strips(experiment, metric, scale, looks, estimates)
    better = {'lower': 'lower is better', 'higher': 'higher is better'}.get(metric.better or '', '')
    if metric.is_share:
        better = ', '.join(filter(None, ('share of trials with yes', better)))
    unit = '' if scale.unit == metric.title.lower() else scale.in_brackets
    about: Dict[str, Any] = dict(title=metric.title, unit=unit, better=better, strips=shown, plots=[], tables=[],
                                 problem='' if shown else 'No complete trial has a value.')
    if shown is None:
        return about
    if findings.is_constant(experiment, metric):
        return dict(about, strips=None, problem=findings.constant_text(experiment, metric, scale))
    lacking = sum(math.isnan(trial.metrics.get(metric.name, math.nan)) for trial in experiment.complete)
    if lacking:
        about['problem'] = f'Complete trials without a value: {whole(lacking)} of {whole(len(experiment.complete))}; ' \
                           'they do not count.'
    cut = int(experiment.cut(metric).sum())
    if cut:
        about['problem'] += f' The limit of time ended {counted(cut, "trials")} of those that have a value: their ' \
                            'values are cut off, and configurations with such trials have no mean.'
    else:
        about['plots'] = _plots(experiment, metric, scale, looks)
    own = [[each for each in found if each.metric is metric]
           for found in (analysis.mains, analysis.singles, analysis.changes)]
    is_one = len([factor for factor in experiment.factors if len(factor.levels) > 1]) < 2
    about['tables'] = there((
        listings.means(experiment, metric, scale, estimates),
        listings.differences(experiment, 'Differences between levels', own[0], scale, 'tables/main_effects.csv'),
        None if is_one and own[0] else listings.differences(
            experiment, 'Differences between configurations', own[1], scale, 'tables/differences.csv'),
        listings.changes(experiment, own[2], scale)))
    return about


def _plots(experiment: Experiment, metric: Metric, scale: Scale, looks: Looks) -> List[Plot]:
    varied = [place for place, factor in enumerate(experiment.factors) if len(factor.levels) > 1]
    plots = [pictures.factor_plot(experiment, metric, scale, looks, place) for place in varied]
    plots += [pictures.pair_plot(experiment, metric, scale, looks, pair)
              for pair in itertools.combinations(varied[:MOST_PLOTTED], 2)]
    return [plot for plot in plots if plot is not None]


def _robots(analysis: Analysis) -> Union[Section, Shares, None]:
    """Return the section about how the robots spent their time, or None if no trial recorded it."""
    experiment = analysis.experiment
    table = listings.robots(frames.robots(experiment))
    sums = [[math.fsum(intervals.known([robot.get(state.key, math.nan) for trial in experiment.complete
                                        if trial.configuration == configuration.place
                                        for robot in trial.robots.values()])) for state in STATES]
            for configuration in experiment.configurations]
    seen = [number for number in range(len(STATES)) if any(each[number] for each in sums)]
    rows = []
    for configuration, times in zip(experiment.configurations, sums):
        if any(times):
            shares = [100.0 * times[number] / math.fsum(times) for number in seen]
            rows.append((configuration.label, analysis.looks.of_levels(configuration.levels),
                         tuple((STATES[number].name, round(share, 2)) for number, share in zip(seen, shares)),
                         ' / '.join(f'{share:.0f}' for share in shares) + f'{NBSP}%'))
    if table is None:
        return None
    if not rows:
        return Section('What the robots did', (table,))
    return Shares('What the robots did', tuple(STATES[number].name for number in seen),
                  tuple(rows[:listings.MOST_ROWS]),
                  (f'Shares of the time of all robots in all complete trials{_cut_text(rows)}.', table))


def _cut_text(rows: Sequence[Any]) -> str:
    return f'; the first {listings.MOST_ROWS} configurations' if len(rows) > listings.MOST_ROWS else ''


def _looks(analysis: Analysis) -> Optional[Section]:
    experiment = analysis.experiment
    metric = notable_trials.primary_metric(experiment)
    if metric is None:
        return None
    picks = notable_trials.picks(experiment, metric)
    table = listings.worth_a_look(experiment, metric, analysis.scales[metric.name], picks)
    return Section('Trials worth a look', (
        f'The worst and the median complete trial of each configuration, by {metric.title}. Links lead to the replay, '
        'or to the event log if there is no replay.', table))


def _repeatable(experiment: Experiment) -> Optional[Section]:
    complete = experiment.complete
    again = [trial for trial in complete if trial.verified]
    parts = []
    if again:
        same = sum(trial.verified == 'identical' for trial in again)
        low = intervals.share_estimate([trial.verified == 'identical' for trial in again]).low
        parts.append('Trials were run again under other conditions, and compared by their event logs, recorded '
                     'messages and bags, or by the numbers that a function returns: '
                     f'identical: {whole(same)} of {whole(len(again))}. So at least '
                     f'{digits(math.floor(1000.0 * low) / 10.0, 3)} % of such trials repeat (Wilson, 95 % interval).')
    else:
        parts.append('No trial was run again to see whether it repeats.')
    parts.append('Trials whose run says that it is repeatable: '
                 f'{whole(sum(trial.repeatable for trial in complete))} of {whole(len(complete))}.')
    parts += there((listings.not_identical(experiment), listings.labels(experiment)))
    return Section('Repeatability', tuple(parts)) if complete else None


def _method(analysis: Analysis) -> Optional[Section]:
    """Return the section that explains the intervals and tests."""
    parts = [
        "Means of configurations have Student's 95 % interval, shares of yes and no Wilson's, and medians that between "
        'two order statistics. Comparisons are of pairs: replication k has the same seed in every configuration, so '
        "the difference within each replication is taken first. The mean of these differences has Student's interval "
        "and test; shares have Newcombe's interval and an exact test (McNemar's). If all differences are the same, the "
        'test is the test of signs.',
        'In a mean over several combinations of other factors each combination has the same weight, and the test has '
        'the degrees of freedom of the combination with the fewest pairs. A combination with fewer than two pairs, or '
        'with trials that the limit of time ended, is left out, and the table says so.',
        'p is the probability of a difference at least as large if nothing differed, for one comparison by itself. '
        'Holm p takes all comparisons of the same kind on this page into account. These kinds are: between levels; '
        'between configurations; how a difference depends on another factor; the primary metric, if one is named; '
        'each way in which trials ended.',
        'Values that are not whole numbers and differ by less than 1e-11 of their size count as the same. Figures are '
        'rounded to one or two digits of the half width of their interval; the files in tables/ have ten digits.']
    return Section('How the figures were made', tuple(parts)) if analysis.experiment.metrics else None


def _provenance(experiment: Experiment, problems: Sequence[str]) -> Section:
    parts = [listings.provenance(experiment), *problems]
    return Section('Provenance', tuple(parts))
