"""Values that the limit of time cut off: what is said of their order, and what is not."""
import itertools

import numpy as np
import pytest

from move_base_abstract_experiments.report import effects, orders
from move_base_abstract_experiments.report.findings import turned
from test_report_words import BOUND, LEVELS, MAKESPAN, TWO, beside, noise, of_method, read, told

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
    found = read(tmp_path, TWO, 30, slower, metrics=BOUND, **LIMITED)
    assert told(found) == [('order', 'auction − greedy: the limit of time ended trials, so there is no mean; larger in '
                            '0, smaller in 30 of 30 pairs (Holm p < 0.001).')]
    assert beside(found) == {'ended by the limit': '15 of 30 and 0 of 30',
                             'by order': 'larger in 0, smaller in 30 of 30 pairs; 0 unknown'}


def test_a_metric_of_which_nobody_says_what_it_is_at_the_limit_has_no_order(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 30, slower, metrics={'makespan_s': {'unit': 's', 'better': 'lower'}},
                                 **LIMITED))
    assert verdict == 'cut' and 'larger' not in text


def test_pairs_whose_order_is_hidden_do_not_count_and_are_told(tmp_path):
    def measure(configuration, replication):
        if replication < 5:
            return trial(3600.0, is_cut=True)
        return slower(configuration, 1 if replication < 15 else 2)
    found = read(tmp_path, TWO, 25, measure, metrics=BOUND, **LIMITED)
    assert told(found)[0][0] == 'order'
    assert beside(found)['by order'] == 'larger in 0, smaller in 20 of 20 pairs; 5 unknown'


def test_too_few_pairs_show_no_order(tmp_path):
    (verdict, text), = told(read(tmp_path, TWO, 5, slower, metrics=BOUND, **LIMITED))
    assert verdict == 'cut' and text.endswith('; larger in 0, smaller in 5 of 5 pairs (Holm p = 0.062).')


def test_an_order_that_turns_with_another_factor_is_not_shown(tmp_path):
    """With 8 robots it is the other way round in each of few pairs, which the many of the others outweigh."""
    def measure(configuration, replication):
        method = 'auction' if configuration['method'] == 'greedy' else 'greedy'
        own = configuration if configuration['robots'] < 8 else {'method': method}
        return slower(own, 2 * replication + 1)
    found = read(tmp_path, LEVELS, lambda each: 6 if each['robots'] == 8 else 30, measure, metrics=BOUND, **LIMITED)
    difference = of_method(found)
    assert difference.order.p < 1e-4 and len(difference.order.against) == 1
    assert next(verdict for verdict, text in told(found) if text.startswith('auction − greedy')) == 'cut'
    assert beside(found)['by order'].endswith('; turned in robots 8')


@pytest.mark.parametrize(('limit', 'says'), [
    (600.0, ['b − a', 'c − a', 'c − b']),  # no mean can be compared
    (800.0, ['a − b', 'a − c'])])  # a is the best of those with a mean
def test_of_several_levels_each_order_that_is_shown_is_told(tmp_path, limit, says):
    base = {'a': 500.0, 'b': 700.0, 'c': 900.0}

    def measure(configuration, replication):
        value = base[configuration['method']] + noise(replication, configuration['method'])
        return trial(3600.0, is_cut=True) if replication % 5 == 0 and value > limit else trial(value)
    found = told(read(tmp_path, {'method': ['a', 'b', 'c']}, 30, measure, metrics=BOUND, **LIMITED))
    assert sorted(text.partition(': ')[0] for _, text in found) == says
    assert {verdict for verdict, _ in found} <= {'order', 'better'}


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
