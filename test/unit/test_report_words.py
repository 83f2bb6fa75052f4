"""The report's words on tables whose truth is known: none is said of what is not so."""
import json
import math
import random

import pytest

from experiment_folder import METRICS, write
from move_base_abstract_experiments.report import effects, findings, notable_trials, outcome, page
from move_base_abstract_experiments.report.design import Factor
from move_base_abstract_experiments.report.phrases import than_with_level, with_level
from move_base_abstract_experiments.report.sections import how_ended
from move_base_abstract_experiments.report.verdicts import verdict_of

MAKESPAN = {'makespan_s': METRICS['makespan_s']}
BOUND = {'makespan_s': {**METRICS['makespan_s'], 'at_limit': 'lower_bound'}}
LEVELS = {'robots': [2, 4, 8], 'method': ['greedy', 'auction']}
TWO = {'method': ['greedy', 'auction']}
FAILED = {'status': 'failed', 'error': 'segmentation fault'}


def read(folder, factors, replications, measure, metrics=None, **plan):
    return outcome.read(write(folder, factors, replications, measure, MAKESPAN if metrics is None else metrics, **plan))


def noise(*key):
    """Return a number in -0.5..0.5 that hangs on the key alone."""
    return random.Random(repr(key)).random() - 0.5


def told(experiment):
    """Return (verdict, text) of each finding about metrics."""
    analysis = page.analyse(experiment)
    found = findings.findings(experiment, analysis.scales, analysis.mains, analysis.singles, analysis.changes)
    return [(each.verdict, each.text.replace('\N{NO-BREAK SPACE}', ' ')) for each in found]


def ended(experiment):
    """Return (verdict, text) of each finding about how trials ended."""
    return [(each.verdict, each.text.replace('\N{NO-BREAK SPACE}', ' '))
            for each in how_ended.findings(experiment, *page.analyse(experiment).endings)]


def of_method(experiment):
    return next(each for each in effects.main_effects(experiment) if experiment.factors[each.factor].name == 'method')


def by_robots(changes, lost=()):
    """Return a measure in which auction changes the makespan by so much per number of robots."""
    def measure(configuration, replication):
        robots, is_auction = configuration['robots'], configuration['method'] == 'auction'
        if (robots, is_auction) in lost:
            return FAILED
        return {'makespan_s': 100.0 + 20.0 * noise(replication) + noise(replication, robots, is_auction)
                + changes[robots] * is_auction}
    return measure


def test_fewer_replications_of_a_value_do_not_turn_the_sign(tmp_path):
    found = read(tmp_path, LEVELS, lambda each: 5 if each['robots'] == 8 else 30, by_robots({2: -2, 4: -2.2, 8: 50}))
    verdict, text = next(each for each in told(found) if 'auction than with greedy' in each[1])
    assert verdict == 'average' and ' higher with auction than with greedy, on average over 2, 4 and 8 robots' in text
    assert '5 to 30 pairs with each' in text and 'But with 2 robots it is 2' in text and 'with 4 robots it is 2' in text


def test_a_combination_that_always_fails_is_named_as_left_out(tmp_path):
    found = read(tmp_path, LEVELS, 10, by_robots({2: -2, 4: -2.2, 8: 50}, lost=[(8, True)]))
    verdict, text = next(each for each in told(found) if 'auction than with greedy' in each[1])
    assert verdict == 'part' and text.startswith('With 2 and 4 robots only: ')
    assert 'It says nothing of 8 robots, where no pair has a value on both sides.' in text
    assert '10 of 30 with auction and 0 of 30 with greedy failed' in text


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
    assert ended(found) == [('fails', '15 of 30 trials failed with auction, 0 of 30 with greedy: 50 percentage points '
                             'more (95 % interval 30 to 67 percentage points; 30 pairs).')]
    (verdict, text), = told(found)
    assert verdict == 'survivors' and text.startswith('Among trials that are complete, ')
    assert '15 pairs' in text and text.endswith(
        'Only pairs of complete trials count: 15 of 30 with auction and 0 of 30 with greedy failed.')


def test_who_fails_less_may_be_better_and_failures_are_told(tmp_path):
    def measure(configuration, replication):
        is_auction = configuration['method'] == 'auction'
        return FAILED if not is_auction and replication == 3 else {
            'makespan_s': 100.0 + noise(replication, is_auction) - 5.0 * is_auction}
    (verdict, text), = told(read(tmp_path, TWO, 20, measure))
    assert verdict == 'better' and '0 of 20 with auction and 1 of 20 with greedy failed' in text


def test_trials_without_a_value_count_as_those_that_failed(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 20, lambda c, k: {
        'makespan_s': None if c['method'] == 'auction' and k < 4 else 50.0 + noise(k, c) - 5.0 * (
            c['method'] == 'auction')}))
    assert verdict == 'survivors' and '4 of 20 with auction and 0 of 20 with greedy have no value' in text


def test_few_failures_are_not_said_to_differ(tmp_path):
    found = read(tmp_path, LEVELS, 10, lambda c, k: FAILED if c == {'robots': 8, 'method': 'auction'} and k < 3 else {
        'makespan_s': 1.0 + noise(k, c)})
    assert {verdict for verdict, _ in ended(found)} == {'none'}
    assert all('not told apart, the difference lies between −' in text for _, text in ended(found))


def test_all_against_none_in_few_pairs_is_told_as_it_was_seen(tmp_path):
    found = read(tmp_path, TWO, 3, lambda c, k: FAILED if c['method'] == 'auction' else {'makespan_s': 1.0 + k})
    assert ended(found) == [('always', '3 of 3 trials failed with auction, 0 of 3 with greedy: in every pair, but '
                             'there are too few pairs for a test (3 pairs).')]


def limited(configuration, replication):
    """Return a trial that with greedy is often ended by the limit of time."""
    is_cut = configuration['method'] == 'greedy' and replication % 2
    return {'status': 'complete', 'ended_by': 'seconds' if is_cut else 'idle', 'simulated_seconds': 3600.0,
            'metrics': {'makespan_s': 3500.0 if is_cut else 600.0 + noise(replication, configuration)}}


def test_values_at_the_limit_of_time_have_no_mean_and_are_not_compared(tmp_path):
    found = read(tmp_path, TWO, 30, limited, metrics=BOUND, until={'seconds': 3600, 'idle': True})
    assert ended(found)[0][0] == 'differs'
    assert '15 of 30 trials were ended by the limit of time with greedy, 0 of 30 with auction' in ended(found)[0][1]
    assert told(found) == [('cut', 'Auction and greedy are not compared: the limit of time ended 0 of 30 trials with '
                            'auction and 15 of 30 trials with greedy; their values are lower bounds. Their order is '
                            'known in 30 pairs, which do not tell them apart (11 to 19; Holm p = 0.20).')]
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
    text = next(text for _, text in told(found) if 'auction and greedy' in text)
    assert text.startswith('With 2 and 4 robots only: ') and 'between −9 and 4 s' in text  # 12.7 times 0.5 around it
    assert 'It says nothing of 8 robots, where the limit of time ended trials.' in text


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


def test_older_trials_that_lasted_to_the_limit_were_ended_by_it(tmp_path):
    found = read(tmp_path, {}, 2, lambda c, k: {'status': 'complete', 'simulated_seconds': [3600.0, 12.0][k],
                                                'metrics': {}}, until={'seconds': 3600, 'idle': True})
    assert [trial.ended_by for trial in found.trials] == ['seconds', '']


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
    assert told(found) == [('same', 'The same with auction and greedy in all 20 pairs.')]


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
    (got, text), = told(found)
    assert got == verdict
    assert ('smallest difference that counts, 1 s' in text) == (verdict in ('negligible', 'small') or change == 1.1)


def test_with_a_baseline_each_level_is_compared_with_it(tmp_path):
    found = read(tmp_path, {'method': ['a', 'b', 'c', 'd']}, 12, lambda c, k: {
        'makespan_s': 100.0 + noise(k) + 0.1 * noise(k, c) + {'a': 3, 'b': 0, 'c': 1, 'd': 9}[c['method']]},
        baseline={'method': 'c'})
    best, *rest = told(found)
    assert best[0] == 'best' and best[1].startswith('Best with b: ')
    assert 'with b than with c, the second best' in best[1]
    assert [(verdict, text.partition(' with ')[2].partition(' (')[0]) for verdict, text in rest] == [
        ('worse', 'a than with c, the baseline'), ('better', 'b than with c, the baseline'),
        ('worse', 'd than with c, the baseline')]


def test_a_level_that_is_not_told_apart_from_the_best_is_named(tmp_path):
    found = read(tmp_path, {'method': ['a', 'b', 'c']}, 12, lambda c, k: {
        'makespan_s': 100.0 + noise(k, c) + 9.0 * (c['method'] == 'c')})
    (verdict, text), = told(found)
    assert verdict == 'among' and 'are not told apart: the difference lies between −' in text
    assert 'It is better than c (' in text and 'Best' not in text


def test_of_one_replication_nothing_is_the_best(tmp_path):
    (verdict, text), = told(read(tmp_path, {'method': ['a', 'b', 'c']}, 1, lambda c, k: {
        'makespan_s': float(ord(c['method']))}))
    assert verdict == 'untold' and 'est with' not in text.replace('Lowest', '') and 'no interval' in text


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
    assert [line.partition(':')[0] for line in told_first] == ['primary', 'smallest_difference', 'baseline']


@pytest.mark.parametrize('size', [1e-200, 1e-9, 1.0, 1e90])
def test_sizes_of_values_change_no_verdict(tmp_path, size):
    found = read(tmp_path, TWO, 10, lambda c, k: {'makespan_s': size * (100.0 + noise(k, c) - 5.0 * (
        c['method'] == 'auction'))})
    (verdict, text), = told(found)
    assert verdict == 'better' and '95 % interval' in text


def test_few_that_differ_among_many_are_too_weak(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 30, lambda c, k: {
        'makespan_s': 1.0 + (c['method'] == 'auction' and k in (2, 5, 9, 11))}))
    assert verdict == 'weak' and 'Holm p = 0.12' in text  # by a t test 0.04


def test_a_change_that_is_not_over_all_says_so(tmp_path):
    factors = {**LEVELS, 'load': ['low', 'high']}
    lost = {'robots': 8, 'method': 'auction', 'load': 'low'}
    found = read(tmp_path, factors, 10, lambda c, k: FAILED if c == lost else {
        'makespan_s': noise(k, c) + 30.0 * (c['method'] == 'auction') * (c['load'] == 'high')})
    text = next(text for verdict, text in told(found) if verdict == 'depends' and 'depends on load' in text)
    assert 'on average over 2 combinations of the other factors' in text
    assert 'It says nothing of 1 of 3 combinations' in text


def factor(title, *levels):
    return Factor(title, title, tuple(map(str, levels)), tuple(map(str, levels)),
                  all(not isinstance(level, str) for level in levels))


@pytest.mark.parametrize(('about', 'level', 'text', 'than'), [
    (factor('robots', 1, 3), 0, '1 robot', '1'), (factor('robots', 1, 3), 1, '3 robots', '3'),
    (factor('batteries', 1), 0, '1 battery', '1'), (factor('pause s', 5), 0, 'a pause of 5 s', '5 s'),
    (factor('arrival rate', 0.1), 0, 'an arrival rate of 0.1', '0.1'), (factor('radius', 2), 0, 'a radius of 2', '2'),
    (factor('w 2', 3), 0, 'w 2 3', 'w 2 3'), (factor('speed', 2), 0, 'a speed of 2', '2')])
def test_levels_in_sentences(about, level, text, than):
    assert (with_level((about,), 0, level), than_with_level((about,), 0, level)) == (text, than)


def test_what_is_counted_is_more_or_fewer(tmp_path):
    metrics = {'goals': {'title': 'Goals reached', 'unit': 'goals', 'better': 'higher'}}
    found = read(tmp_path, {'robots': [1, 3]}, 20, lambda c, k: {'goals': 12 * c['robots'] + k % 3 * (c['robots'] > 1)},
                 metrics=metrics)
    (verdict, text), = told(found)
    assert verdict == 'better' and text.startswith('24.9 more goals (208 %) with 3 robots than with 1 (95 % interval ')


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
    assert 'were kept from before: what they are made of has changed since' in said
    assert 'kept from before: a.py has changed since' in said
