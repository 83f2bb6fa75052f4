"""The report's statistics against scipy, published figures and what can be counted by hand."""

import math

import numpy as np
import pytest
from scipy import stats

from move_base_abstract_experiments.report import intervals
from move_base_abstract_experiments.report.intervals import (
    holm,
    is_skewed,
    mean_estimate,
    median_estimate,
    paired,
    paired_shares,
    share_estimate,
)

VALUES = [12.1, 9.8, 11.4, 10.0, 13.9, 8.7, 10.6]
NAN = math.nan


def test_mean_has_the_interval_of_scipy():
    low, high = stats.t.interval(0.95, len(VALUES) - 1, np.mean(VALUES), stats.sem(VALUES))
    found = mean_estimate([*VALUES, NAN])
    assert found.value == pytest.approx(np.mean(VALUES)) and found[3:] == (7, 't')
    assert (found.low, found.high) == pytest.approx((low, high), rel=1e-12)


def test_no_value_and_one_value_have_no_interval():
    assert mean_estimate([]).n == mean_estimate([NAN]).n == 0
    assert not mean_estimate([3.0]).has_interval and mean_estimate([3.0]).value == 3.0


def test_values_that_differ_by_rounding_only_are_the_same():
    found = mean_estimate([0.1 + 0.2, 0.3, 0.3])
    assert found.method == 'constant' and found.low == found.high == found.value


@pytest.mark.parametrize(('ones', 'n', 'low', 'high'), [
    (81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)])
def test_shares_have_the_score_intervals_of_newcombes_table(ones, n, low, high):
    # R. G. Newcombe, Statistics in Medicine 17 (1998) 857-872, table I, method 3
    found = share_estimate([1] * ones + [0] * (n - ones))
    assert (round(found.low, 4), round(found.high, 4)) == (low, high)


def test_all_of_all_is_bounded_by_one():
    assert share_estimate([1] * 18)[:3] == (1.0, pytest.approx(0.8241, abs=5e-5), 1.0)


@pytest.mark.parametrize(('n', 'low', 'high'), [(6, 1, 6), (10, 2, 9), (20, 6, 15), (30, 10, 21)])
def test_median_lies_between_tabulated_order_statistics(n, low, high):
    found = median_estimate(range(n, 0, -1))
    assert (found.low, found.high) == (low, high)
    outside = 2.0 * stats.binom.cdf(low - 1, n, 0.5)
    assert outside <= 0.05 < 2.0 * stats.binom.cdf(low, n, 0.5)


def test_median_of_five_has_no_interval():
    assert median_estimate([1, 2, 3, 4, 5])[:1] == (3.0,) and not median_estimate([1, 2, 3, 4, 5]).has_interval


def test_paired_differences_have_the_test_of_scipy():
    other = [10.0, 9.9, 10.1, 8.8, 12.0, 8.8, 9.1]
    found = paired(np.array(VALUES) - other)
    assert found.p == pytest.approx(stats.ttest_rel(VALUES, other).pvalue, rel=1e-9)


def test_differences_that_are_all_the_same_are_tested_by_their_signs():
    assert paired([0.0] * 5).p == 1.0
    assert paired([2.0] * 5).p == 2.0 / 2 ** 5
    assert math.isnan(paired([2.0]).p)


def test_paired_shares_have_newcombes_interval():
    # R. G. Newcombe, Statistics in Medicine 17 (1998) 2635-2650, method 10, the example 36, 12, 2, 0
    second, first = [1] * 36 + [1] * 12 + [0] * 2, [1] * 36 + [0] * 12 + [1] * 2
    found = paired_shares([*first, NAN, 1.0], [*second, 1.0, NAN])
    assert [round(each, 4) for each in found.estimate[:3]] == [0.2, 0.0569, 0.3404]
    assert found.estimate.n == 50
    assert found.p == pytest.approx(2.0 * sum(math.comb(14, each) for each in range(3)) / 2 ** 14)


@pytest.mark.parametrize(('table', 'value', 'low', 'high'), [
    ((59, 6, 16, 80), -0.0621, -0.1186, -0.0046),  # as by R's contingencytables: with a correlation above 0
    ((36, 12, 2, 0), 0.2, 0.0569, 0.3404)])
def test_paired_shares_are_corrected_for_continuity_where_they_go_together(table, value, low, high):
    both, second_only, first_only, neither = table
    second = [1] * (both + second_only) + [0] * (first_only + neither)
    first = [1] * both + [0] * second_only + [1] * first_only + [0] * neither
    assert [round(each, 4) for each in paired_shares(first, second).estimate[:3]] == [value, low, high]


def test_paired_shares_that_all_agree_show_no_difference():
    found = paired_shares([1.0] * 8, [1.0] * 8)
    assert found.p == 1.0 and found.estimate.low < 0.0 < found.estimate.high


def test_holm_by_hand():
    assert holm([0.01, 0.04, NAN, 0.03, 0.005])[:2] == pytest.approx([0.03, 0.06])
    assert holm([0.01, 0.04, NAN, 0.03, 0.005])[3:] == pytest.approx([0.06, 0.02])
    assert holm([0.5, 0.9]) == [1.0, 1.0] and math.isnan(holm([NAN])[0]) and holm([]) == []


def test_skewed_is_what_has_a_long_tail_for_so_few_values():
    tail = [1.0] * 9 + [1.1] * 9 + [0.9] * 9 + [40.0, 55.0, 90.0]
    assert is_skewed(tail) and not is_skewed([*range(30)]) and not is_skewed([1.0] * 30)
    assert not is_skewed(tail[-5:])


def test_students_interval_holds_its_level():
    draws = np.random.default_rng(1).normal(5.0, 2.0, size=(1000, 8))
    hits = sum(each.low <= 5.0 <= each.high for each in map(mean_estimate, draws))
    low, high = stats.binom.ppf([0.0005, 0.9995], 1000, intervals.LEVEL)
    assert low <= hits <= high


def test_combinations_count_alike_however_many_values_they_have():
    rows = [[1.0, 2.0, 3.0, 2.0, 1.0, 3.0], [11.0, 13.0, NAN, NAN, NAN, NAN]]
    found = intervals.clustered(rows)
    assert found.estimate.value == 7.0 and found.estimate.n == 6
    balanced = intervals.clustered([[1.0, 5.0, 3.0], [2.0, 9.0, 4.0]])
    assert balanced.estimate.low == pytest.approx(stats.t.interval(0.95, 2, 4.0, stats.sem([1.5, 7.0, 3.5]))[0])
    assert balanced.p == pytest.approx(stats.ttest_1samp([1.5, 7.0, 3.5], 0.0).pvalue)


@pytest.mark.parametrize('counts', [(30, 30, 5), (8, 8, 3), (10, 2), (12, 12, 12)])
def test_no_difference_is_found_in_at_most_the_share_that_the_level_allows(counts):
    generator, hits = np.random.default_rng(2), 0
    for _ in range(400):
        rows = generator.normal(size=(len(counts), max(counts))) + generator.normal(size=max(counts))
        for row, count in zip(rows, counts):
            row[count:] = NAN
        hits += intervals.clustered(rows).p < intervals.ALPHA
    assert hits <= stats.binom.ppf(0.9995, 400, intervals.ALPHA)


def test_cells_that_are_each_the_same_are_not_all_the_same():
    assert intervals.clustered([[8.0, 8.0], [-8.0, -8.0]]).estimate[:5] == (0.0, 0.0, 0.0, 2, 'fixed')
    assert intervals.clustered([[8.0, 8.0], [8.0, 8.0]]).estimate.method == 'constant'
    assert intervals.clustered([[8.0, 8.0], [8.0, NAN]]).estimate.method == 'none'


def test_chance_signs_are_counted_exactly():
    assert intervals.flip_test([1] * 14 + [0] * 6) == pytest.approx(2.0 / 2 ** 14)
    assert intervals.flip_test([1] * 12 + [-1] * 2) == pytest.approx(paired_shares([0] * 12 + [1] * 2,
                                                                                   [1] * 12 + [0] * 2).p)
    sums = [3, -1, 2, 2]
    totals = [abs(sum(each * sign for each, sign in zip(sums, signs)))
              for signs in np.array(np.meshgrid(*[(-1, 1)] * 4)).reshape(4, -1).T]
    assert intervals.flip_test(sums) == pytest.approx(np.mean([total >= 6 for total in totals]))
    assert intervals.flip_test([0, 0]) == 1.0
    assert intervals.flip_test([1] * 600 + [-1] * 400) == pytest.approx(2.0 * stats.norm.sf(200.0 / 1000 ** 0.5))


def test_shares_over_combinations_are_no_surer_than_each_is():
    first, second = np.zeros((3, 30)), np.zeros((3, 30))
    second[0, :4] = 1.0
    found = intervals.share_differences(first, second)
    assert found.p == pytest.approx(0.125) and found.estimate.low < 0.0 < found.estimate.value
    second[0, :15] = 1.0
    assert intervals.share_differences(first, second).estimate.low > 0.0


def test_differences_within_rounding_are_none_and_those_of_whole_numbers_are_kept():
    found, left = intervals.contrast((-1, 1), [[0.3, 1e15, 5.0, NAN], [0.1 + 0.2, 1e15 + 2.0, 5.1, 1.0]])
    assert list(found[:2]) == [0.0, 2.0] and found[2] == pytest.approx(0.1) and math.isnan(found[3])
    assert left[1] == 0.0 and 0.0 < left[0] < 1e-10
