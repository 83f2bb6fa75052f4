"""The report's words on few pairs, and on pairs that cancel each other: none is said of what is not so."""
import re

import pytest

from experiment_folder import METRICS, write
from move_base_abstract_experiments.report import findings, intervals, outcome, page
from move_base_abstract_experiments.report.sections import how_ended

FACTORS = {'method': ['greedy', 'auction'], 'robots': [2, 8]}
FAILED = {'status': 'failed', 'error': 'segmentation fault'}
HARD = [0.0, 30.0, 10.0, 5.0, 70.0, 20.0]  # of a replication: the same in all configurations


def told(folder, factors, replications, measure, of=r'auction( than| as| and greedy|, \d)'):
    """Return (verdict, text) of each finding whose text has the pattern ``of``."""
    found = outcome.read(write(folder, factors, replications, measure, {'makespan_s': METRICS['makespan_s']}))
    analysis = page.analyse(found)
    every = [*how_ended.findings(found, *analysis.endings),
             *findings.findings(found, analysis.scales, analysis.mains, analysis.singles, analysis.changes)]
    return [(each.verdict, text) for each in every
            for text in [each.text.replace('\N{NO-BREAK SPACE}', ' ')] if re.search(of, text)]


def by_pairs(changes):
    """Return a measure in which auction changes the makespan by so much, per number of robots and replication.

    None: that trial with auction fails.
    """
    def measure(configuration, replication):
        change = changes[configuration['robots']][replication] if configuration['method'] == 'auction' else 0.0
        return FAILED if change is None else {
            'makespan_s': 50.0 * configuration['robots'] + HARD[replication] + change}
    return measure


@pytest.mark.parametrize('changes, verdict, says', [
    ({2: [5, 5, 5], 8: [7, 7, 7]}, 'always', '6 s (2.3 %) higher with auction than with greedy, on average over 2 and '
     '8 robots (the same in every replication; 3 pairs with each).'),
    ({2: [5, 5, 5], 8: [0, 0, 0]}, 'untold', '2.5 s (0.95 %) higher with auction than with greedy, on average over 2 '
     'and 8 robots (the same in every replication; 3 pairs with each).'),
    ({2: [9, 9, 9], 8: [-5, -5, -5]}, 'untold', '2 s (0.76 %) higher with auction than with greedy, on average over 2 '
     'and 8 robots (the same in every replication; 3 pairs with each). But with 8 robots it is 5 s lower (in every '
     'pair).'),
    ({2: [5, 5, 5], 8: [-5, -5, -5]}, 'even', 'The same with auction as with greedy, on average over 2 and 8 robots '
     '(the same in every replication; 3 pairs with each). But with 2 robots it is 5 s higher (in every pair) and with '
     '8 robots it is 5 s lower (in every pair).'),
    ({2: [5, -5], 8: [-5, 5]}, 'even', 'The same with auction as with greedy, on average over 2 and 8 robots (the '
     'same in every replication; 2 pairs with each).'),
    ({2: [10, 20], 8: [20, 10]}, 'always', '15 s (5.7 %) higher with auction than with greedy, on average over 2 and 8 '
     'robots (the same in every replication; 2 pairs with each).'),
    ({2: [10, -2], 8: [-2, 10]}, 'untold', '4 s (1.5 %) higher with auction than with greedy, on average over 2 and 8 '
     'robots (the same in every replication; 2 pairs with each).'),
])
def test_in_all_pairs_is_said_of_all_pairs_only(tmp_path, changes, verdict, says):
    assert told(tmp_path, FACTORS, len(changes[2]), by_pairs(changes)) == [(verdict, says)]


@pytest.mark.parametrize('change, rest, verdict, says', [
    (5, -100, 'untold', 'With 2 robots only: 5 s (4.3 %) higher'), (5, 40, 'always', 'With 2 robots only: 5 s'),
    (0, 4, 'untold', 'With 2 robots only: the same with auction and greedy in all 2 pairs. It says nothing of 8'),
    (0, 0, 'same', 'With 2 robots only: the same with auction and greedy in all 2 pairs.')])
def test_a_pair_that_is_left_out_counts_where_all_are_named(tmp_path, change, rest, verdict, says):
    found = told(tmp_path, FACTORS, 2, by_pairs({2: [change, change], 8: [None, rest]}))
    assert [each[0] for each in found] == ['none', verdict] and found[1][1].startswith(says)


@pytest.mark.parametrize('measured, says', [
    (FAILED, '3 trials failed, 100 % of those that have run. So there are no figures.'), (None, '3 trials of the plan'),
    ({'makespan_s': None}, 'No complete trial has a value.')])
def test_trials_without_values_are_not_called_too_few(tmp_path, measured, says):
    assert told(tmp_path, {'method': ['greedy', 'auction']}, 3, lambda c, k: measured, 'auction and greedy has') == [
        ('empty', 'No pair of complete trials of auction and greedy has a value on both sides.')]
    found = outcome.read(tmp_path)
    assert says.replace('3', '6') in ' '.join(page.render(page.analyse(found), ()).split())


def test_one_pair_of_each_combination_is_not_the_only_pair(tmp_path):
    (verdict, text), = told(tmp_path, FACTORS, 1, by_pairs({2: [5], 8: [-5]}))
    assert (verdict, text) == ('untold', 'The same with auction and greedy in 1 pair with each, on average over 2 and '
                               '8 robots; no interval, so this says nothing about other seeds.')


def test_means_that_cancel_are_not_all_the_same():
    assert intervals.clustered([[10.0, 20.0], [20.0, 10.0]]).estimate.method == 'fixed'
    assert intervals.clustered([[10.0, 10.0], [10.0, 10.0]]).estimate.method == 'constant'


def test_of_levels_that_lead_one_another_in_a_circle_none_is_the_lowest(tmp_path):
    values = {('A', 1): 100, ('B', 1): 110, ('B', 2): 100, ('C', 2): 120, ('C', 3): 100, ('A', 3): 105}
    found = told(tmp_path, {'method': ['A', 'B', 'C'], 'robots': [1, 2, 3]}, 3, lambda c, k: FAILED if (
        c['method'], c['robots']) not in values else {'makespan_s': values[c['method'], c['robots']] + HARD[k]},
        '[ABC] than')
    assert [text.partition(', the second')[0].partition(' (')[0] for _, text in found] == [
        'With 1 robot only: 10 s', 'With 3 robots only: 5 s', 'With 2 robots only: 20 s']


@pytest.mark.parametrize('replications, verdict', [(8, 'part'), (3, 'always')])
def test_trials_that_a_share_of_failures_is_not_about_are_not_in_its_counts(tmp_path, replications, verdict):
    def measure(configuration, replication):
        if configuration['robots'] == 8:
            return {'makespan_s': 1.0} if replication == 0 else None
        return FAILED if configuration['method'] == 'auction' else {'makespan_s': 1.0}
    found = told(tmp_path, FACTORS, replications, measure)[0]
    assert found[0] == verdict
    assert found[1].startswith(f'{replications} of {replications} trials failed with auction, 0 of {replications} with')
    assert found[1].endswith(' It says nothing of 8 robots, where there are too few pairs for an interval.')


def test_failures_that_are_the_other_way_round_somewhere_are_told(tmp_path):
    found = told(tmp_path, FACTORS, 30, lambda c, k: FAILED if (c['method'] == 'auction') == (c['robots'] == 2) and (
        c['robots'] == 2 or k % 2) else {'makespan_s': 1.0})[0]
    assert found[0] == 'average' and '30 of 60 trials failed with auction, 15 of 60 with greedy: 25' in found[1]
    assert 'But with 8 robots it is 50 percentage points lower (95 % interval' in found[1]
