"""Values that the limit of time cut off: what is said of their order, and what is not."""
import itertools

import numpy as np
import pytest

from move_base_abstract_experiments.report import effects, orders
from move_base_abstract_experiments.report.ranking import turned
from test_report_words import BOUND, FAILED, LEVELS, MAKESPAN, TWO, noise, of_method, read, told

LIMITED = {'until': {'seconds': 3600, 'idle': True}}
GOALS = {'goals': {'unit': 'goals', 'better': 'higher', 'at_limit': 'lower_bound'}}
INF = float('inf')


def trial(value, is_cut=False, name='makespan_s'):
    return {'status': 'complete', 'ended_by': 'seconds' if is_cut else 'idle', 'metrics': {name: value}}


def slower(configuration, replication):
    """Return a trial that takes longer with greedy: so long that the limit cuts off every second one."""
    if configuration['method'] == 'auction':
        return trial(600.0 + noise(replication))
    return trial(3600.0, is_cut=True) if replication % 2 else trial(900.0 + noise(replication))


def test_an_order_is_shown_where_no_mean_is_and_no_amount_is_said(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 30, slower, metrics=BOUND, **LIMITED))
    assert verdict == 'order'
    assert text == ('Lower with auction than with greedy, by order alone: in all 30 pairs (test of signs, Holm p < '
                    '0.001). The size of the difference is not known: the limit of time ended 0 of 30 trials with '
                    'auction and 15 of 30 trials with greedy; their values are lower bounds.')


def test_a_metric_of_which_nobody_says_what_it_is_at_the_limit_has_no_order(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 30, slower, metrics={'makespan_s': {'unit': 's', 'better': 'lower'}},
                                 **LIMITED))
    assert verdict == 'cut' and 'order' not in text


def test_what_is_counted_is_more_or_fewer(tmp_path):
    def measure(configuration, replication):
        is_auction = configuration['method'] == 'auction'
        return trial(40.0 + 10.0 * is_auction + replication % 3, is_cut=is_auction, name='goals')
    (verdict, text), = told(read(tmp_path, TWO, 12, measure, metrics=GOALS, **LIMITED))
    assert verdict == 'order' and text.startswith('More goals with auction than with greedy, by order alone: in all 12')


def test_pairs_whose_order_is_hidden_do_not_count_and_are_told(tmp_path):
    def measure(configuration, replication):
        if replication < 5:
            return trial(3600.0, is_cut=True)
        return slower(configuration, 1 if replication < 15 else 2)
    (verdict, text), = told(read(tmp_path, TWO, 25, measure, metrics=BOUND, **LIMITED))
    assert verdict == 'order' and 'in all 20 pairs' in text and ' The order of 5 more pairs is not known.' in text


def test_too_few_pairs_show_no_order(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 5, slower, metrics=BOUND, **LIMITED))
    assert verdict == 'cut' and text.endswith('Their order is known in 5 pairs, which do not tell them apart (0 to 5; '
                                              'Holm p = 0.062).')


def test_failures_are_told_beside_an_order(tmp_path):
    found = read(tmp_path, TWO, 30, lambda configuration, replication: FAILED if replication == 3 and configuration[
        'method'] == 'auction' else slower(configuration, replication), metrics=BOUND, **LIMITED)
    (verdict, text), = told(found)
    assert verdict == 'order' and 'in all 29 pairs' in text
    assert text.endswith('Only pairs of complete trials count: 1 of 30 with auction and 0 of 30 with greedy failed.')


def test_an_order_that_turns_with_another_factor_is_not_shown(tmp_path):
    """With 8 robots it is the other way round in each of few pairs, which the many of the others outweigh."""
    def measure(configuration, replication):
        method = 'auction' if configuration['method'] == 'greedy' else 'greedy'
        own = configuration if configuration['robots'] < 8 else {'method': method}
        return slower(own, 2 * replication + 1)
    found = read(tmp_path, LEVELS, lambda each: 6 if each['robots'] == 8 else 30, measure, metrics=BOUND, **LIMITED)
    difference = of_method(found)
    assert difference.order.p < 1e-4 and len(difference.order.against) == 1
    verdict, text = next(each for each in told(found) if 'auction and greedy' in each[1].lower())
    assert verdict == 'cut' and text.endswith('Their order is not the same in all combinations of the other factors.')


def test_of_several_levels_each_order_that_is_shown_is_told(tmp_path):
    base = {'a': 500.0, 'b': 700.0, 'c': 900.0}

    def measure(configuration, replication):
        value = base[configuration['method']] + noise(replication, configuration['method'])
        return trial(3600.0, is_cut=True) if replication % 5 == 0 and value > 600.0 else trial(value)
    found = read(tmp_path, {'method': ['a', 'b', 'c']}, 30, measure, metrics=BOUND, **LIMITED)
    (verdict, text), = told(found)
    assert verdict == 'order' and text.count('by order alone') == 3
    assert 'Higher with c than with b, by order alone: in all 24 pairs' in text
    assert 'The order of 6 more pairs is not known.' in text


def test_a_level_that_is_cut_off_is_told_apart_from_the_best_by_order(tmp_path):
    base = {'a': 500.0, 'b': 700.0, 'c': 900.0}

    def measure(configuration, replication):
        value = base[configuration['method']] + noise(replication, configuration['method'])
        return trial(3600.0, is_cut=True) if replication % 5 == 0 and value > 800.0 else trial(value)
    (_, text), = told(read(tmp_path, {'method': ['a', 'b', 'c']}, 30, measure, metrics=BOUND, **LIMITED))
    assert 'Its mean could not be compared with c: the limit of time ended trials. ' \
           'Higher with c than with a, by order alone: in all 30 pairs' in text


def test_the_table_has_the_counts(tmp_path):
    difference = of_method(read(tmp_path, TWO, 30, slower, metrics=BOUND, **LIMITED))
    order, other = difference.order, turned(difference).order
    assert (order.larger, order.smaller, order.same, order.unknown) == (0, 30, 0, 0)
    assert (other.larger, other.smaller) == (30, 0) and turned(turned(difference)).order == order


def test_interactions_and_whole_values_have_no_order(tmp_path):
    found = read(tmp_path, LEVELS, 12, slower, metrics=BOUND, **LIMITED)
    assert all(each.order is None for each in effects.interactions(found))
    whole = read(tmp_path / 'whole', TWO, 12, lambda c, k: trial(noise(k, c)), metrics=MAKESPAN, **LIMITED)
    assert of_method(whole).order is None


@pytest.mark.parametrize(('first', 'second', 'first_cut', 'second_cut', 'sign'), [
    (1.0, 2.0, False, False, 1.0), (2.0, 2.0, False, False, 0.0), (2.0, 1.0, False, False, -1.0),
    (1.0, 2.0, True, False, None), (2.0, 2.0, True, False, None), (2.0, 1.0, True, False, -1.0),
    (1.0, 2.0, False, True, 1.0), (2.0, 2.0, False, True, None), (2.0, 1.0, False, True, None),
    (1.0, 2.0, True, True, None), (2.0, 2.0, True, True, None), (2.0, 1.0, True, True, None)])
def test_an_order_is_known_only_where_no_true_value_could_turn_it(first, second, first_cut, second_cut, sign):
    one, _ = orders.signs(*(np.array([[each]]) for each in (first, second, first_cut, second_cut)))
    assert np.array_equal(one, [[np.nan if sign is None else sign]], equal_nan=True)
    true = itertools.product(*([value, value + 0.5, value + 9.0] if is_cut else [value]
                               for value, is_cut in ((first, first_cut), (second, second_cut))))
    seen = {float(np.sign(b - a)) for a, b in true}
    assert (seen == {sign}) if sign is not None else len(seen) > 1


def test_where_nothing_differs_an_order_is_seen_in_one_of_twenty_at_most():
    """Both sides have the same distribution within a seed, hard and easy seeds, and a limit that cuts many off."""
    chance, wrong, runs = np.random.default_rng(7), 0, 1500
    for _ in range(runs):
        hard = chance.exponential(1.0, 15)
        values = hard + chance.exponential(1.0, (2, 15))
        cut = values > 2.0
        tables = np.minimum(values, 2.0)[:, None, :]
        order = orders.order_of(list(tables), list(cut[:, None, :]), [(0, 1)])
        wrong += order is not None and order.p < 0.05
    assert 0 < wrong / runs < 0.05
