import math

import numpy as np
import pytest
from pykrige.ok import OrdinaryKriging

from soil_mapping import kriging
from soil_mapping.grid import Grid
from soil_mapping.kriging import Kriging
from soil_mapping.variogram import Variogram, evaluate_mean, fit

GRID = Grid.of_field(1)
KRIGING = Kriging(GRID)
FLAT = np.zeros(GRID.shape)


def scattered(count, seed=0):
    """Return places away from the cells' middles, and values of a smooth function there."""
    points = np.random.default_rng([seed, count]).uniform(5.0, (319.0, 215.0), size=(count, 2))
    return points, 800.0 + 20.0 * np.sin(points[:, 0] / 60.0) + 0.1 * points[:, 1]


def by_pykrige(points, values, variogram):
    ordinary = OrdinaryKriging(*points.T, values, variogram_model='gaussian', variogram_parameters={
        'psill': variogram.psill, 'range': variogram.range_m, 'nugget': variogram.nugget})
    mean, variance = ordinary.execute('grid', GRID.x_centres(), GRID.y_centres())
    return np.asarray(mean), np.asarray(variance)


@pytest.mark.parametrize('count', [3, 8, 20])
def test_mean_and_variance_equal_pykrige_with_the_same_variogram(count):
    points, values = scattered(count)
    variogram = Variogram(300.0, 150.0, 20.0)
    mean, variance = KRIGING.evaluate(points, values, variogram)
    expected_mean, expected_variance = by_pykrige(points, values, variogram)
    assert mean.shape == variance.shape == (220, 324)
    np.testing.assert_allclose(mean, expected_mean, rtol=1e-6)
    np.testing.assert_allclose(variance, expected_variance, rtol=1e-6)


def test_without_a_nugget_the_variance_equals_pykrige_within_a_millionth_of_the_sill():
    points, values = scattered(12)
    variogram = Variogram(300.0, 150.0, 0.0)
    mean, variance = KRIGING.evaluate(points, values, variogram)
    expected_mean, expected_variance = by_pykrige(points, values, variogram)
    np.testing.assert_allclose(mean, expected_mean, rtol=1e-6)
    np.testing.assert_allclose(variance, expected_variance, rtol=1e-6, atol=1e-6 * variogram.sill)


def test_the_variogram_is_the_one_that_pykrige_fits():
    points, values = scattered(20)
    ordinary = OrdinaryKriging(*points.T, values, variogram_model='gaussian')
    assert fit(points, values) == tuple(ordinary.variogram_model_parameters)


def test_at_a_sample_the_mean_is_its_value_and_the_variance_zero_whatever_the_nugget():
    points = np.array([GRID.centre(10, 20), GRID.centre(200, 300), GRID.centre(100, 50)])
    mean, variance = KRIGING.evaluate(points, np.array([1.0, 2.0, 4.0]), Variogram(5.0, 100.0, 3.0))
    assert [mean[10, 20], mean[200, 300], mean[100, 50]] == [1.0, 2.0, 4.0]
    assert [variance[10, 20], variance[200, 300], variance[100, 50]] == [0.0, 0.0, 0.0]
    assert variance[10, 21] > 3.0  # the nugget


def test_fewer_than_three_samples_make_no_map():
    with pytest.raises(ValueError, match='at least 3 samples, got 2'):
        KRIGING.estimate([(1.0, 2.0), (3.0, 4.0)], [1.0, 2.0], FLAT)


def test_equal_values_make_a_map_of_that_value_without_variance():
    estimate = KRIGING.estimate(scattered(5)[0], [7.0] * 5, FLAT)
    assert (estimate.mean == 7.0).all()
    assert (estimate.variance == 0.0).all()
    assert (estimate.rmse, estimate.mean_variance) == (7.0, 0.0)


def test_samples_in_a_line_make_a_map_that_is_alike_on_both_sides_of_it():
    points = np.array([(x, 110.0) for x in (20.0, 90.0, 170.0, 300.0)])
    estimate = KRIGING.estimate(points, [780.0, 790.0, 810.0, 800.0], FLAT)
    assert np.isfinite(estimate.mean).all()
    assert estimate.mean == pytest.approx(estimate.mean[::-1])
    assert estimate.variance[0, 0] > estimate.variance[109, 0]


def test_samples_of_one_cell_count_as_one_at_their_mean():
    points, values = KRIGING.merge(np.array([(10.25, 5.0), (50.0, 5.0), (10.75, 5.5)]), np.array([1.0, 2.0, 4.0]))
    assert points.tolist() == [[10.5, 5.25], [50.0, 5.0]]
    assert values.tolist() == [2.5, 2.0]


def test_three_samples_of_one_cell_make_a_constant_map():
    estimate = KRIGING.estimate([(5.2, 5.2), (5.4, 5.4), (5.6, 5.6)], [1.0, 2.0, 3.0], FLAT)
    assert (estimate.mean == 2.0).all()


def test_the_rmse_is_against_the_truth_over_all_cells():
    points, values = scattered(6)
    truth = KRIGING.estimate(points, values, FLAT).mean
    assert KRIGING.estimate(points, values, truth + 3.0).rmse == pytest.approx(3.0)


def test_up_to_64_samples_decide_every_cell_and_more_only_the_near_ones(monkeypatch):
    grid = Grid.of_field(2)
    variogram = Variogram(250.0, 60.0, 50.0)
    points, values = scattered(65)
    asked = []

    def noted(near, *rest):
        asked.append(len(near))
        return evaluate_mean(near, *rest)
    monkeypatch.setattr(kriging, 'evaluate_mean', noted)
    Kriging(grid).evaluate(points[:64], values[:64], variogram)
    assert asked == [64]  # once, for the whole grid
    Kriging(grid).evaluate(points, values, variogram)
    tiles = math.ceil(grid.rows / kriging.TILE_CELLS) * math.ceil(grid.columns / kriging.TILE_CELLS)
    assert asked[1:] == [64] * tiles


def test_the_near_samples_make_the_map_that_all_of_them_make():
    grid = Grid.of_field(2)
    points, values = scattered(400)
    variogram = Variogram(250.0, 60.0, 50.0)
    mean, variance = Kriging(grid).evaluate(points, values, variogram)
    expected = evaluate_mean(points, values, variogram, grid.x_centres(), grid.y_centres())
    assert np.sqrt(np.mean((mean - expected) ** 2)) < 0.1 * expected.std()
    assert (variance >= 0.0).all()


def test_many_near_samples_without_a_nugget_make_no_variance_of_rounding_errors():
    grid = Grid.of_field(2)
    points, values = scattered(300)
    _, variance = Kriging(grid).evaluate(points, values, Variogram(250.0, 150.0, 0.0))
    assert (variance >= 0.0).all()
    assert variance.mean() < 1.0
