import math
from pathlib import Path

import numpy as np
import pytest

from soil_mapping.results.comparison import (
    METRICS,
    PUBLISHED_TABLE,
    bootstrap_interval,
    cosine_similarity,
    differences,
    metric_cosines,
    noise_floor,
    similarity_interval,
    trial_row,
)
from soil_mapping.results.result import Metrics

WIDTH = len(METRICS)


def study(*means, trials=10, spread=0.1, seed=1):
    """Return a study whose configurations have these means on every metric, with normal scatter of that share."""
    chance = np.random.default_rng(seed)
    return {f'c{i}': mean * (1.0 + spread * chance.standard_normal((trials, WIDTH))) for i, mean in enumerate(means)}


def test_a_study_is_like_itself_and_like_itself_in_other_units():
    one = study(1.0, 2.0, 3.0, 4.0)
    assert cosine_similarity(one, one) == pytest.approx(1.0)
    assert cosine_similarity(one, {name: 7.0 * rows for name, rows in one.items()}) == pytest.approx(1.0)


def test_the_cosine_is_that_of_the_configuration_means_averaged_over_the_metrics():
    first = {'a': [[3.0, 1.0, 0.0, 1.0, 0.0, 1.0]] * 2, 'b': [[4.0, 1.0, 0.0, 1.0, 0.0, 1.0]] * 2}
    second = {'b': [[3.0, 1.0, 0.0, 1.0, 2.0, 1.0]] * 2, 'a': [[4.0, 1.0, 0.0, 1.0, 0.0, 1.0]] * 2}
    assert metric_cosines(first, second).tolist() == pytest.approx([24.0 / 25.0, 1.0, 1.0, 1.0, 0.0, 1.0])
    assert cosine_similarity(first, second) == pytest.approx((0.96 + 4.0) / 6.0)


def test_studies_of_other_configurations_are_refused():
    with pytest.raises(ValueError, match='same configurations'):
        cosine_similarity(study(1.0), study(1.0, 2.0))


def test_the_noise_floor_widens_with_the_scatter_and_is_repeatable():
    quiet, loud = (noise_floor(study(1.0, 2.0, 3.0, 4.0, spread=spread), resamples=300) for spread in (0.01, 0.5))
    assert loud[0] < quiet[0] <= quiet[1] <= 1.0
    assert noise_floor(study(1.0, 2.0), resamples=50) == noise_floor(study(1.0, 2.0), resamples=50)


def test_trials_without_a_value_are_left_out_of_the_bootstrap():
    gappy = study(1.0, 2.0, trials=4)
    for rows in gappy.values():
        rows[1:, 5] = np.nan
    for low, high in (noise_floor(gappy, 3), similarity_interval(gappy, gappy)):
        assert 0.9 < low <= high <= 1.0 + 1e-12


def test_the_interval_of_a_similarity_holds_it_and_widens_with_the_scatter():
    narrow, wide = (study(1.0, 2.0, spread=spread) for spread in (0.01, 0.3))
    other = study(2.0, 1.0, spread=0.01, seed=2)
    low, high = similarity_interval(narrow, other)
    assert low <= cosine_similarity(narrow, other) <= high
    assert high - low < np.ptp(similarity_interval(wide, other))
    assert similarity_interval(wide, wide) == pytest.approx((1.0, 1.0))  # pairs are drawn, not trials


def test_differences_feel_scale():
    first = {'a': np.array([[1.0] * WIDTH, [3.0] * WIDTH])}
    found = differences(first, {'a': 2.0 * first['a']})
    assert [d.metric for d in found] == list(METRICS)
    assert found[0].relative == pytest.approx(1.0)
    assert found[0].standardised == pytest.approx(2.0 / math.sqrt((2.0 + 8.0) / 2.0))
    zero = {'a': np.zeros((2, WIDTH))}
    assert (differences(zero, zero)[0].relative, differences(zero, zero)[0].standardised) == (0.0, 0.0)
    risen = differences(zero, {'a': np.ones((2, WIDTH))})[0]
    assert math.isnan(risen.relative)
    assert risen.standardised == math.inf


def test_the_bootstrap_interval_holds_zero_for_equal_means_and_not_for_others():
    chance = np.random.default_rng(2)
    a, b = chance.normal(5.0, 1.0, 20), chance.normal(5.0, 1.0, 20)
    low, high = bootstrap_interval(a, b, comparisons=10, resamples=4000)
    assert low < 0.0 < high
    low, high = bootstrap_interval(a, b + 3.0, comparisons=10, resamples=4000)
    assert 0.0 < low < 3.0 < high
    one = bootstrap_interval(a, b, comparisons=1, resamples=4000)
    many = bootstrap_interval(a, b, comparisons=10, resamples=4000)
    assert many[0] < one[0] < one[1] < many[1]


def test_a_trials_row_leaves_waiting_out():
    assert trial_row(Metrics(1.0, 2.0, 3, 4.0, 5.0, 6.0, 7.0)) == [1.0, 2.0, 3.0, 4.0, 5.0, 7.0]


def test_the_published_table_is_that_of_the_file(data_folder):
    lines = Path(data_folder, 'table1.csv').read_text(encoding='utf-8').splitlines()[1:]
    assert [f'{first},{second},{value}' for first, second, value in PUBLISHED_TABLE] == lines
