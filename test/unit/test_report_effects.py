"""What the report compares, on tables whose effects are known because they were put in."""

import json
import math

import pytest

from experiment_folder import findings_of, plain, write
from move_base_abstract_experiments.report import effects, outcome

NOISE = [3.0, -1.0, 0.5, -2.5, 0.0, 4.0]  # of a replication: the same in all configurations
OWN = [0.1, -0.1, 0.05, -0.05, 0.0, 0.02]


def experiment(folder, factors, measure, replications=6, **plan):
    return outcome.read(write(folder, factors, replications, measure, **plan))


def without(folder, *configurations):
    """Return the experiment of a folder as if these configurations had not been planned."""
    plan = json.loads((folder / 'plan.json').read_text())
    plan['trials'] = [each for each in plan['trials'] if each['configuration'] not in configurations]
    (folder / 'plan.json').write_text(json.dumps(plan))
    return outcome.read(folder)


def two_by_two(configuration, replication):
    auction, many = configuration['method'] == 'auction', configuration['robots'] == 8
    sign = 1.0 if auction else -1.0
    return {'makespan_s': 600.0 + NOISE[replication] - 12.0 * auction - 200.0 * many - 6.0 * auction * many
            + sign * OWN[replication] + many * auction * OWN[replication - 1], 'goals': 40.0}


def of(differences, metric, factor, first=0, second=1):
    return next(each for each in differences
                if (each.metric.name, each.factor, each.first, each.second) == (metric, factor, first, second))


FACTORS = {'method': ['greedy', 'auction'], 'robots': [2, 8]}


def test_main_effects_are_what_was_put_in_without_the_noise_of_replications(tmp_path):
    found = effects.main_effects(experiment(tmp_path, FACTORS, two_by_two))
    method = of(found, 'makespan_s', 0)
    assert method.estimate.value == pytest.approx(-15.0 + 2.5 * sum(OWN) / 6.0)  # half of the interaction is in it
    assert method.estimate.n == 6 and method.used == method.groups and len(method.used) == 2 and method.is_shown
    assert method.estimate.high - method.estimate.low < 0.4
    assert of(found, 'makespan_s', 1).estimate.value == pytest.approx(-203.0 + sum(OWN) / 12.0)


def test_an_interaction_is_what_was_put_in(tmp_path):
    change = of(effects.interactions(experiment(tmp_path, FACTORS, two_by_two)), 'makespan_s', 0)
    assert change.estimate.value == pytest.approx(-6.0 + sum(OWN) / 6.0)
    assert change.at == ((1, 0), (1, 1)) and change.is_shown


def test_single_differences_are_of_configurations_that_differ_in_one_factor(tmp_path):
    found = effects.single_differences(experiment(tmp_path, FACTORS, two_by_two))
    own = [(each.factor, each.at) for each in found if each.metric.name == 'makespan_s']
    assert own == [(0, ((1, 0),)), (0, ((1, 1),)), (1, ((0, 0),)), (1, ((0, 1),))]


def test_a_failed_trial_costs_its_own_pair_and_no_other(tmp_path):
    def measure(configuration, replication):
        if replication == 2 and configuration == {'method': 'auction', 'robots': 8}:
            return {'status': 'failed', 'error': 'x'}
        return two_by_two(configuration, replication)
    method = of(effects.main_effects(experiment(tmp_path, FACTORS, measure)), 'makespan_s', 0)
    assert (method.counts, method.fewest, len(method.used)) == ((6, 5), 5, 2)
    means = [-12.0 + 2.0 * sum(OWN) / 6.0,
             -18.0 + sum(2.0 * OWN[k] + OWN[k - 1] for k in range(6) if k != 2) / 5.0]
    assert method.estimate.value == pytest.approx(sum(means) / 2.0)


def test_findings_are_sentences_with_intervals(tmp_path):
    texts = [(each.metric, each.verdict, plain(each.text))
             for each in findings_of(experiment(tmp_path, {'method': ['greedy', 'auction']},
                                         lambda c, k: {'makespan_s': 150.0 - 12.0 * (c['method'] == 'auction')
                                                       + NOISE[k] + (c['method'] == 'auction') * 10.0 * OWN[k],
                                                       'goals': 40.0 + 0.1 * (c['method'] == 'auction') * NOISE[k]}))]
    assert texts == [
        ('Makespan', 'better', 'auction − greedy: −12.0 s (−7.9 %; 95 % interval −12.7 to −11.2 s; 6 pairs).'),
        ('Goals reached', 'none', 'auction − greedy: 0.07 goals (0.17 %; 95 % interval −0.19 to 0.32 goals; 6 pairs).')]


def test_what_is_the_same_everywhere_is_told_once(tmp_path):
    found = [each for each in findings_of(experiment(tmp_path, FACTORS, two_by_two)) if each.metric == 'Goals reached']
    assert [(each.verdict, each.text) for each in found] == [
        ('same', '40\N{NO-BREAK SPACE}goals in all 24 trials of all configurations.')]


def test_among_many_comparisons_a_weak_one_is_called_weak(tmp_path):
    metrics = {f'm{number}': {'unit': 's', 'title': f'M{number}', 'better': 'lower'} for number in range(30)}
    drift = [0.5, 1.0, 0.0, 0.9, 0.1, 0.6]

    def measure(configuration, replication):
        second = configuration['method'] == 'auction'
        return {name: NOISE[replication] + second * (drift[replication] if name == 'm0' else OWN[replication])
                for name in metrics}
    found = findings_of(experiment(tmp_path, {'method': ['greedy', 'auction']}, measure, metrics=metrics))
    assert found[0].verdict == 'weak'
    assert {each.verdict for each in found[1:]} == {'none'}


def test_yes_and_no_are_shares_and_differ_by_percentage_points(tmp_path):
    metrics = {'done': {'unit': 'yes/no', 'title': 'All done', 'better': 'higher'}}
    found = experiment(tmp_path, {'method': ['greedy', 'auction']},
                       lambda c, k: {'done': int(c['method'] == 'auction' or k < 2)}, replications=20, metrics=metrics)
    assert found.metrics[0].is_share
    assert [each.method for each in effects.summary(found, found.metrics[0])] == ['wilson', 'wilson']
    only = findings_of(found)[0]
    assert only.verdict == 'better' and ': 90\N{NO-BREAK SPACE}percentage points (95' in only.text


def test_counts_that_happen_to_be_0_or_1_are_no_shares(tmp_path):
    metrics = {'lost': {'unit': '', 'title': 'Goals not reached', 'better': 'lower'}}
    found = experiment(tmp_path, {}, lambda c, k: {'lost': k % 2}, metrics=metrics)
    assert not found.metrics[0].is_share and effects.summary(found, found.metrics[0])[0].method == 't'


def test_means_of_shares_have_no_bounds_beyond_all(tmp_path):
    metrics = {'done': {'unit': 'yes/no', 'title': 'All done', 'better': 'higher'}}
    found = experiment(tmp_path, FACTORS, lambda c, k: {'done': int(k != 1 or c['robots'] == 2)}, metrics=metrics)
    levels, _ = effects.levels_of(found, found.metrics[0], 0)
    assert [each.estimate.value for each in levels] == pytest.approx([11.0 / 12.0] * 2)
    assert [each.estimate.high for each in levels] == [1.0, 1.0]


def test_of_several_levels_the_best_is_compared_with_each_other(tmp_path):
    found = findings_of(experiment(tmp_path, {'robots': [1, 2, 3, 4, 5]}, lambda c, k: {
        'makespan_s': 100.0 + 20.0 * (c['robots'] - 3) ** 2 + NOISE[k] + OWN[(k + c['robots']) % 6]}))
    only = [(each.verdict, each.text.partition(':')[0]) for each in found if each.metric == 'Makespan']
    assert sorted(only) == [('better', f'robots 3 − robots {other}') for other in (1, 2, 4, 5)]  # a U shape


def test_designs_with_gaps_compare_what_can_be_compared(tmp_path):
    rest = without(write(tmp_path, FACTORS, 6, two_by_two), {'method': 'auction', 'robots': 8})
    assert len(rest.configurations) == 3
    assert len(of(effects.main_effects(rest), 'makespan_s', 0).groups) == 1
    levels, is_like_for_like = effects.levels_of(rest, rest.metrics[0], 0)
    assert not is_like_for_like and levels[0].estimate.value == pytest.approx(600.0 + sum(NOISE) / 6 - sum(OWN) / 6)
    assert effects.interactions(rest) == []


def test_what_many_trials_share_takes_room_once(tmp_path):
    found = experiment(tmp_path, FACTORS, lambda c, k: {'status': 'complete', 'metrics': {'makespan_s': 1.0},
                                                        'ended_by': 'by itself', 'labels': ['one', 'an other']}, 9)
    assert len({id(each['configuration']) for each in found.plan['trials']}) == len(found.configurations) == 4
    assert len({id(word) for each in found.trials for word in (each.ended_by, *each.labels)}) == 3
    assert [each['configuration'] for each in found.plan['trials']] == [
        each['configuration'] for each in json.loads((tmp_path / 'plan.json').read_text())['trials']]


def test_configurations_without_a_common_factor_are_compared_as_wholes(tmp_path):
    rest = without(write(tmp_path, FACTORS, 6, two_by_two), {'method': 'greedy', 'robots': 8},
                   {'method': 'auction', 'robots': 2})
    assert effects.main_effects(rest) == []
    only = effects.single_differences(rest)[0]
    assert only.factor is None and only.estimate.value == pytest.approx(-218.0 + 3.0 * sum(OWN) / 6)
    assert findings_of(rest)[0].text.startswith('auction, robots 8 − greedy, robots 2: ')


def test_no_value_anywhere_is_no_comparison(tmp_path):
    found = effects.main_effects(experiment(tmp_path, FACTORS, lambda c, k: {'makespan_s': None}))
    assert all(each.estimate.n == 0 and math.isnan(each.p_holm) and not each.is_shown for each in found)
