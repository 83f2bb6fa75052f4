"""The report's verdicts and sentences on tables whose truth is known: none is said of what is not so."""
import json
import math
import random

import pytest

from experiment_folder import METRICS, findings_of, plain, write
from move_base_abstract_experiments.report import (
    comparisons,
    effects,
    notable_trials,
    outcome,
    page,
)
from move_base_abstract_experiments.report.comparisons import verdict_of
from move_base_abstract_experiments.report.sections import how_ended

MAKESPAN = {'makespan_s': METRICS['makespan_s']}
BOUND = {'makespan_s': {**METRICS['makespan_s'], 'at_limit': 'lower_bound'}}
LEVELS = {'robots': [2, 4, 8], 'method': ['greedy', 'auction']}
FEW = {'method': ['greedy', 'auction'], 'robots': [2, 8]}
TWO = {'method': ['greedy', 'auction']}
FAILED = {'status': 'failed', 'error': 'segmentation fault'}
HARD = [0.0, 30.0, 10.0, 5.0, 70.0, 20.0]  # of a replication: the same in all configurations


def read(folder, factors, replications, measure, metrics=None, **plan):
    return outcome.read(write(folder, factors, replications, measure, MAKESPAN if metrics is None else metrics, **plan))


def noise(*key):
    """Return a number in -0.5..0.5 that hangs on the key alone."""
    return random.Random(repr(key)).random() - 0.5


def told(experiment):
    """Return (verdict, text) of each finding about metrics."""
    return [(each.verdict, plain(each.text)) for each in findings_of(experiment)]


def ended(experiment):
    """Return (verdict, text) of each finding about how trials ended."""
    return [(each.verdict, plain(each.text))
            for each in how_ended.findings(experiment, *page.analyse(experiment).endings)]


def of_method(experiment):
    return next(each for each in effects.main_effects(experiment) if experiment.factors[each.factor].name == 'method')


def beside(experiment):
    """Return what the row on auction and greedy says beside its figures: {header: text}."""
    difference = of_method(experiment)
    found = comparisons.asides(experiment, difference, page.analyse(experiment).scales[difference.metric.name])
    return {name: plain(text) for name, text in found.items()}


def by_robots(changes, lost=()):
    """Return a measure in which auction changes the makespan by so much per number of robots."""
    def measure(configuration, replication):
        robots, is_auction = configuration['robots'], configuration['method'] == 'auction'
        if (robots, is_auction) in lost:
            return FAILED
        return {'makespan_s': 100.0 + 20.0 * noise(replication) + noise(replication, robots, is_auction)
                + changes[robots] * is_auction}
    return measure


def by_pairs(changes):
    """Return a measure in which auction changes the makespan by so much, per number of robots and replication.

    None: that trial with auction fails.
    """
    def measure(configuration, replication):
        change = changes[configuration['robots']][replication] if configuration['method'] == 'auction' else 0.0
        return FAILED if change is None else {
            'makespan_s': 50.0 * configuration['robots'] + HARD[replication] + change}
    return measure


def test_fewer_replications_of_a_value_do_not_turn_the_sign(tmp_path):
    found = read(tmp_path, LEVELS, lambda each: 5 if each['robots'] == 8 else 30, by_robots({2: -2, 4: -2.2, 8: 50}))
    verdict, text = next(each for each in told(found) if each[1].startswith('auction − greedy: 15'))
    assert verdict == 'average' and text.endswith('; 5 to 30 pairs with each).')
    rows = beside(found)['the other way round'].split('; ')
    assert [row.partition(' (')[0].partition('.')[0] for row in rows] == ['robots 2: −2', 'robots 4: −2']


def test_a_combination_that_always_fails_is_named_as_left_out(tmp_path):
    found = read(tmp_path, LEVELS, 10, by_robots({2: -2, 4: -2.2, 8: 50}, lost=[(8, True)]))
    assert next(verdict for verdict, text in told(found) if text.startswith('auction − greedy: −2')) == 'part'
    assert beside(found) == {'not in it': 'robots 8 (no pairs)', 'without a value': '0 of 30 and 10 of 30'}


@pytest.mark.parametrize('seed', range(12))
def test_a_headline_has_the_sign_of_the_mean_over_all_that_it_names(tmp_path, seed):
    chance = random.Random(seed)
    changes = {robots: chance.choice([-1, 1]) * chance.uniform(3.0, 60.0) for robots in LEVELS['robots']}
    lost = [(robots, side) for robots in LEVELS['robots'] for side in (True, False) if chance.random() < 0.15]
    found = read(tmp_path, LEVELS, lambda each: {2: 12, 4: 3, 8: 7}[each['robots']], by_robots(changes, lost))
    difference = of_method(found)
    own = [changes[LEVELS['robots'][found.configurations[group[0]].levels[0]]] for group in difference.used]
    gone = {robots for robots, _ in lost}
    assert len(own) == len(LEVELS['robots']) - len(gone)
    if own:
        assert difference.estimate.value == pytest.approx(math.fsum(own) / len(own), abs=1.0)
        is_one_sign = len({change > 0.0 for change in own}) == 1
        assert (verdict_of(difference) in ('better', 'worse')) <= (is_one_sign and not gone)


def test_failures_come_first_and_survivors_are_not_better(tmp_path):
    def measure(configuration, replication):
        is_auction = configuration['method'] == 'auction'
        if is_auction and replication % 2:
            return FAILED
        return {'makespan_s': 100.0 + 50.0 * (replication % 2) + noise(replication, is_auction) - 5.0 * is_auction}
    found = read(tmp_path, TWO, 30, measure)
    assert ended(found) == [('worse', 'auction − greedy: 50 percentage points (95 % interval 30 to 67 percentage '
                             'points; 30 pairs).')]
    (verdict, text), = told(found)
    assert verdict == 'survivors' and '15 pairs' in text
    assert beside(found) == {'without a value': '0 of 30 and 15 of 30'}


@pytest.mark.parametrize(('lacks', 'measured', 'verdict', 'row'), [
    (('greedy', range(3, 4)), FAILED, 'better', '1 of 20 and 0 of 20'),  # who fails less may be better
    (('auction', range(4)), FAILED, 'survivors', '0 of 20 and 4 of 20'),
    (('auction', range(4)), {'makespan_s': None}, 'survivors', '0 of 20 and 4 of 20')])
def test_trials_without_a_value_count_as_those_that_failed(tmp_path, lacks, measured, verdict, row):
    found = read(tmp_path, TWO, 20, lambda c, k: measured if c['method'] == lacks[0] and k in lacks[1] else {
        'makespan_s': 100.0 + noise(k, c) - 5.0 * (c['method'] == 'auction')})
    assert told(found)[0][0] == verdict and beside(found) == {'without a value': row}


def test_few_failures_are_not_said_to_differ(tmp_path):
    found = read(tmp_path, LEVELS, 10, lambda c, k: FAILED if c == {'robots': 8, 'method': 'auction'} and k < 3 else {
        'makespan_s': 1.0 + noise(k, c)})
    verdicts = {verdict for verdict, _ in ended(found)}
    assert verdicts and verdicts <= {'none', 'weak'}


def limited(configuration, replication):
    """Return a trial that with greedy is often ended by the limit of time."""
    is_cut = configuration['method'] == 'greedy' and replication % 2
    return {'status': 'complete', 'ended_by': 'seconds' if is_cut else 'idle', 'simulated_seconds': 3600.0,
            'metrics': {'makespan_s': 3500.0 if is_cut else 600.0 + noise(replication, configuration)}}


def test_values_at_the_limit_of_time_have_no_mean_and_are_not_compared(tmp_path):
    found = read(tmp_path, TWO, 30, limited, metrics=BOUND, until={'seconds': 3600, 'idle': True})
    assert ended(found)[0][0] == 'differs'
    assert told(found) == [('cut', 'auction − greedy: the limit of time ended trials, so there is no mean; larger in '
                            '11, smaller in 19 of 30 pairs (Holm p = 0.20).')]
    assert beside(found)['ended by the limit'] == '15 of 30 and 0 of 30'
    assert [(each.method, math.isnan(each.value)) for each in effects.summary(found, found.metrics[0])] == [
        ('cut', True), ('t', False)]


def test_a_combination_at_the_limit_is_left_out_of_the_mean_over_the_others_and_named(tmp_path):
    """By hand: with 2 robots auction takes 1 s less and 2 s less, with 4 robots 3 s less and 4 s less: 2.5 s."""
    less = {(2, 0): 1.0, (2, 1): 2.0, (4, 0): 3.0, (4, 1): 4.0, (8, 0): 900.0, (8, 1): 900.0}

    def measure(configuration, replication):
        robots, is_auction = configuration['robots'], configuration['method'] == 'auction'
        is_cut = robots == 8 and not is_auction and replication == 1
        return {'status': 'complete', 'ended_by': 'seconds' if is_cut else 'idle', 'metrics': {
            'makespan_s': 100.0 * robots - is_auction * less[robots, replication]}}
    found = read(tmp_path, LEVELS, 2, measure, metrics=BOUND, until={'seconds': 3600, 'idle': True})
    difference = of_method(found)
    assert (difference.estimate.value, difference.reference, len(difference.used)) == (-2.5, 300.0, 2)
    text = next(text for _, text in told(found) if text.startswith('auction − greedy: '))
    assert '95 % interval −9 to 4 s' in text  # 12.7 times 0.5 around it
    assert beside(found)['not in it'] == 'robots 8 (limit of time)'


@pytest.mark.parametrize(('whole', 'bounds', 'about', 'median'), [
    ([100.0, 200.0, 300.0], [], 'lower_bound', 200.0),
    ([100.0, 200.0, 300.0], [350.0, 350.0], 'lower_bound', 300.0),  # two of five are more than 300 in any case
    ([100.0, 200.0, 300.0], [250.0, 350.0], 'lower_bound', None),  # 250 or more: may come before 300 or after it
    ([100.0, 200.0], [350.0, 350.0, 350.0], 'lower_bound', None),  # the third of five is cut off itself
    ([100.0, 200.0, 300.0], [350.0, 350.0], None, None), ([100.0, 200.0, 300.0], [250.0], 'value', 200.0)])
def test_the_median_trial_is_named_if_it_is_known_which_one_it_is(tmp_path, whole, bounds, about, median):
    values = [*whole, *bounds]
    found = read(tmp_path, {}, len(values), lambda c, k: {
        'status': 'complete', 'ended_by': 'seconds' if k >= len(whole) else 'idle', 'metrics': {
            'makespan_s': values[k]}},
        metrics={'makespan_s': {'better': 'lower', **({'at_limit': about} if about else {})}},
        until={'seconds': 3600, 'idle': True})
    assert [pick.value for pick in notable_trials.picks(found, found.metrics[0]) if pick.role == 'median'] == (
        [] if median is None else [median])


def test_values_at_the_limit_are_compared_if_the_experiment_calls_them_values(tmp_path):
    found = read(tmp_path, TWO, 30, limited, metrics=BOUND, until={'seconds': 3600, 'idle': True},
                 at_limit={'makespan_s': 'value'})
    assert told(found)[0][0] == 'better'


@pytest.mark.parametrize(('about', 'open_goals', 'until', 'is_cut'), [
    ('lower_bound', 0, {'seconds': 3600}, False),  # trials of an hour, all of them
    ('lower_bound', 0, {'seconds': 3600, 'idle': True}, True), (None, 0, {'seconds': 3600, 'topic': '/done'}, True),
    ('to_last_goal', 2, {'seconds': 3600}, True), ('to_last_goal', 0, {'seconds': 3600, 'idle': True}, False),
    ('to_last_goal', None, {'seconds': 3600}, False), ('to_last_goal', None, {'seconds': 3600, 'idle': True}, True),
    ('value', 2, {'seconds': 3600, 'idle': True}, False)])
def test_what_the_limit_makes_of_a_value(tmp_path, about, open_goals, until, is_cut):
    found = read(tmp_path, {}, 3, lambda c, k: {
        'status': 'complete', 'ended_by': 'seconds', 'open_goals': open_goals, 'metrics': {'makespan_s': 5.0 + k}},
        metrics={'makespan_s': {'better': 'lower', 'at_limit': about}}, until=until)
    assert found.cut(found.metrics[0]).all() == is_cut
    assert (told(found)[0][0] == 'cut') == is_cut


def test_sums_in_another_order_are_no_difference(tmp_path):
    def measure(configuration, replication):
        values = [noise(replication, place) + 0.6 for place in range(200)]
        ordered = sorted(values, reverse=configuration['method'] == 'auction')
        total = 0.0
        for value in ordered:
            total += value
        return {'makespan_s': total}
    found = read(tmp_path, TWO, 20, measure)
    assert len({trial.metrics['makespan_s'] for trial in found.trials}) > 20
    assert told(found) == [('same', 'auction − greedy: 0 s (in every pair; 20 pairs).')]


def test_whole_numbers_are_not_rounded(tmp_path):
    found = read(tmp_path, TWO, 20, lambda c, k: {'makespan_s': 1_700_000_000_000_000 + k + 2 * (
        c['method'] == 'auction')}, metrics={'makespan_s': {'better': 'lower'}})
    assert told(found)[0][0] == 'worse'


@pytest.mark.parametrize(('change', 'spread', 'verdict'), [
    (0.5, 0.2, 'negligible'), (0.0, 0.2, 'negligible'), (5.0, 0.2, 'worse'), (0.9, 2.0, 'small'), (1.1, 0.6, 'worse'),
    (0.0, 30.0, 'none')])
def test_the_smallest_difference_that_counts(tmp_path, change, spread, verdict):
    found = read(tmp_path, TWO, 30, lambda c, k: {'makespan_s': 600.0 + 9.0 * noise(k) + (c['method'] == 'auction') * (
        change + 2.0 * spread * noise(k, 'own'))}, smallest_difference={'makespan_s': 1.0})
    assert told(found)[0][0] == verdict


def test_with_a_baseline_each_level_is_compared_with_it(tmp_path):
    found = read(tmp_path, {'method': ['a', 'b', 'c', 'd']}, 12, lambda c, k: {
        'makespan_s': 100.0 + noise(k) + 0.1 * noise(k, c) + {'a': 3, 'b': 0, 'c': 1, 'd': 9}[c['method']]},
        baseline={'method': 'c'})
    assert [(verdict, text.partition(': ')[0]) for verdict, text in told(found)] == [
        ('worse', 'a − c'), ('better', 'b − c'), ('worse', 'd − c')]


def test_of_one_replication_nothing_is_better(tmp_path):
    found = read(tmp_path, {'method': ['a', 'b', 'c']}, 1, lambda c, k: {'makespan_s': float(ord(c['method']))})
    assert told(found)[0] == (
        'untold', 'a − b: −1 s (−1 %; no interval, so this says nothing about other seeds; 1 pair).')


def test_the_primary_metric_comes_first_and_by_itself(tmp_path):
    metrics = {f'm{number}': {'title': f'M{number}', 'better': 'lower'} for number in range(40)}
    found = read(tmp_path, TWO, 6, lambda c, k: {name: noise(k, c, name) - 0.9 * (
        name == 'm7' and c['method'] == 'auction') for name in metrics}, metrics=metrics, primary='m7')
    assert found.metrics[0].name == 'm7'
    first, *others = effects.main_effects(found)
    assert first.p_holm == first.p < 0.05 and all(each.p_holm > each.p for each in others if each.p < 0.5)


def test_names_that_nothing_goes_by_are_told(tmp_path):
    found = read(tmp_path, TWO, 2, lambda c, k: {'makespan_s': 1.0 + k}, primary='make', smallest_difference={'x': 1},
                 baseline={'method': 'market'})
    told_first = page._warnings(found)
    assert [line.partition(':')[0] for line in told_first] == ['Trials that failed', 'primary', 'smallest_difference',
                                                               'baseline']
    assert found.trials[0].error == 'no value of make, the primary metric: it has makespan_s'


@pytest.mark.parametrize('size', [1e-200, 1e-9, 1.0, 1e90])
def test_sizes_of_values_change_no_verdict(tmp_path, size):
    found = read(tmp_path, TWO, 10, lambda c, k: {'makespan_s': size * (100.0 + noise(k, c) - 5.0 * (
        c['method'] == 'auction'))})
    (verdict, text), = told(found)
    assert verdict == 'better' and '95 % interval' in text


def test_few_that_differ_among_many_are_too_weak(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 30, lambda c, k: {
        'makespan_s': 1.0 + (c['method'] == 'auction' and k in (2, 5, 9, 11))}))
    assert verdict == 'weak'  # p is 0.12, by a t test 0.04


def test_a_change_that_is_not_over_all_says_so(tmp_path):
    factors = {**LEVELS, 'load': ['low', 'high']}
    lost = {'robots': 8, 'method': 'auction', 'load': 'low'}
    found = read(tmp_path, factors, 10, lambda c, k: FAILED if c == lost else {
        'makespan_s': noise(k, c) + 30.0 * (c['method'] == 'auction') * (c['load'] == 'high')})
    text = next(text for verdict, text in told(found) if verdict == 'depends' and 'depends on load' in text)
    assert text.startswith('auction − greedy depends on load: with high minus with low it is 29.9')
    change = next(each for each in effects.interactions(found) if each.is_shown)
    assert (len(change.used), len(change.groups)) == (2, 3)


def test_trials_of_two_programs_are_never_a_pair_and_never_silently_in_one_table(tmp_path):
    def measured(configuration, replication):
        is_greedy = configuration['method'] == 'greedy'
        return {'status': 'complete', 'made_of': 'old' if replication < 3 and is_greedy else 'new',
                'metrics': {'makespan_s': 10.0 + replication + 5.0 * is_greedy}}
    write(tmp_path, TWO, 6, measured, MAKESPAN)
    plan = json.loads((tmp_path / 'plan.json').read_text())
    for place, one in enumerate(plan['trials']):
        one['made_of'] = 'new'
        if place < 2:  # two old ones of the one method; a third one is to run again
            one.update(made_of='old', program='p1', kept='kept from before: a.py has changed since')
    (tmp_path / 'plan.json').write_text(json.dumps(plan))
    experiment = outcome.read(tmp_path)
    assert [trial.status for trial in experiment.trials] == ['complete'] * 2 + ['not run'] + ['complete'] * 9
    values = experiment.values(experiment.metrics[0])
    assert [sum(math.isfinite(value) for value in column) for column in values.T].count(2) == 3  # pairs
    said = page.render(page.analyse(experiment), ())
    assert 'Trials that were kept from before: 2: what they are made of has changed since' in said
    assert 'kept from before: a.py has changed since' in said


@pytest.mark.parametrize('changes, verdict, size', [
    ({2: [5, 5, 5], 8: [7, 7, 7]}, 'always', '6 s (2.3 %; the same in every replication; 3 pairs with each)'),
    ({2: [5, 5, 5], 8: [0, 0, 0]}, 'untold', '2.5 s (0.95 %; the same in every replication; 3 pairs with each)'),
    ({2: [9, 9, 9], 8: [-5, -5, -5]}, 'untold', '2 s (0.76 %; the same in every replication; 3 pairs with each)'),
    ({2: [5, 5, 5], 8: [-5, -5, -5]}, 'even', '0 s (the same in every replication; 3 pairs with each)'),
    ({2: [5, -5], 8: [-5, 5]}, 'even', '0 s (the same in every replication; 2 pairs with each)'),
    ({2: [10, 20], 8: [20, 10]}, 'always', '15 s (5.7 %; the same in every replication; 2 pairs with each)'),
    ({2: [10, -2], 8: [-2, 10]}, 'untold', '4 s (1.5 %; the same in every replication; 2 pairs with each)'),
    ({2: [5], 8: [-5]}, 'untold', '0 s (no interval, so this says nothing about other seeds; 1 pair with each)'),
    ({2: [5, 5], 8: [None, -100]}, 'untold', '5 s (4.3 %; in every pair; 2 pairs)'),
    ({2: [5, 5], 8: [None, 40]}, 'always', '5 s (4.3 %; in every pair; 2 pairs)'),
    ({2: [0, 0], 8: [None, 4]}, 'untold', '0 s (in every pair; 2 pairs)'),
    ({2: [0, 0], 8: [None, 0]}, 'same', '0 s (in every pair; 2 pairs)')])
def test_in_all_pairs_is_said_of_all_pairs_only(tmp_path, changes, verdict, size):
    found = read(tmp_path, FEW, len(changes[2]), by_pairs(changes))
    assert (verdict, f'auction − greedy: {size}.') in told(found)


@pytest.mark.parametrize('measured, says', [
    (FAILED, 'Trials that failed: 6 (100 % of those that have run). So there are no figures.'),
    (None, 'that have not run yet: 6.'),
    ({'makespan_s': None}, 'No complete trial has a value.')])
def test_trials_without_values_are_not_called_too_few(tmp_path, measured, says):
    found = read(tmp_path, TWO, 3, lambda c, k: measured)
    assert told(found) == [('empty', 'auction − greedy: no pair of complete trials has a value on both sides.')]
    assert says in ' '.join(page.render(page.analyse(found), ()).split())


def test_of_levels_that_lead_one_another_in_a_circle_none_is_chosen(tmp_path):
    values = {('A', 1): 100, ('B', 1): 110, ('B', 2): 100, ('C', 2): 120, ('C', 3): 100, ('A', 3): 105}
    found = read(tmp_path, {'method': ['A', 'B', 'C'], 'robots': [1, 2, 3]}, 3, lambda c, k: FAILED if (
        c['method'], c['robots']) not in values else {'makespan_s': values[c['method'], c['robots']] + HARD[k]})
    assert {text.partition(' (')[0] for _, text in told(found) if text[0] in 'ABC'} == {
        'B − A: 10 s', 'C − A: −5 s', 'C − B: 20 s'}


def test_failures_that_are_the_other_way_round_somewhere_are_told(tmp_path):
    found = read(tmp_path, FEW, 30, lambda c, k: FAILED if (c['method'] == 'auction') == (c['robots'] == 2) and (
        c['robots'] == 2 or k % 2) else {'makespan_s': 1.0})
    assert ended(found)[0][0] == 'average'
    tables = how_ended.tables(found, *page.analyse(found).endings)
    assert tables[0].header[-1] == 'the other way round' and tables[0].rows[0][-1].startswith('robots 8: −50')
