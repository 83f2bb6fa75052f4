import math

import numpy as np
import pytest
from pykrige.ok import OrdinaryKriging

from soil_mapping.ground_truth.grid import Grid
from soil_mapping.interpolation import kriging
from soil_mapping.interpolation.kriging import Kriging
from soil_mapping.interpolation.kriging_system import KrigingSystem
from soil_mapping.interpolation.variogram import NUGGETS, RANGES, Variogram, fit

GRID = Grid.of_field(1)
KRIGING = Kriging(GRID)
FLAT = np.zeros(GRID.shape)
EXTENT = math.hypot(GRID.width_m, GRID.height_m)


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


def test_the_published_study_has_the_variogram_that_pykrige_fits():
    pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
    from soil_mapping.mesa_models.mesa_published import fit_by_pykrige  # it imports Mesa
    points, values = scattered(20)
    ordinary = OrdinaryKriging(*points.T, values, variogram_model='gaussian')
    assert fit_by_pykrige(points, values, EXTENT) == tuple(ordinary.variogram_model_parameters)


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
        return KrigingSystem(near, *rest)
    monkeypatch.setattr(kriging, 'KrigingSystem', noted)
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
    expected = KrigingSystem(points, values, variogram).mean(grid.x_centres(), grid.y_centres())
    assert np.sqrt(np.mean((mean - expected) ** 2)) < 0.1 * expected.std()
    assert (variance >= 0.0).all()


def test_many_near_samples_without_a_nugget_make_no_variance_of_rounding_errors():
    grid = Grid.of_field(2)
    points, values = scattered(300)
    _, variance = Kriging(grid).evaluate(points, values, Variogram(250.0, 150.0, 0.0))
    assert (variance >= 0.0).all()
    assert variance.mean() < 1.0


def likelihood(points, values, range_m, nugget):
    """Return the restricted likelihood's logarithm, by a library's linear algebra; sill: the most likely one."""
    distance = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    matrix = (1.0 - nugget) * np.exp(-(distance / (4.0 / 7.0 * range_m)) ** 2) + nugget * np.eye(len(points))
    ones, solved = np.ones(len(points)), np.linalg.solve(matrix, np.column_stack((np.ones(len(points)), values)))
    mean = (ones @ solved[:, 1]) / (ones @ solved[:, 0])
    sill = (values - mean) @ (solved[:, 1] - mean * solved[:, 0]) / (len(points) - 1)
    return sill, -0.5 * ((len(points) - 1) * np.log(sill) + np.linalg.slogdet(matrix)[1]
                         + np.log(ones @ solved[:, 0]))


@pytest.mark.parametrize('count', [3, 12, 40])
def test_the_fit_is_the_most_likely_of_its_candidates(count):
    points, values = scattered(count)
    scores = {}
    for share in RANGES:
        for nugget in NUGGETS:
            _, score = likelihood(points, values, share * EXTENT, nugget)
            scores[share, nugget] = score + np.log(1.0 - nugget) - 0.5 * (np.log(share / 0.3) / 0.7) ** 2
    share, nugget = max(scores, key=scores.get)
    sill, _ = likelihood(points, values, share * EXTENT, nugget)
    assert fit(points, values, EXTENT) == pytest.approx(((1.0 - nugget) * sill, share * EXTENT, nugget * sill))


def test_a_fit_hardly_moves_with_its_samples():
    """PyKrige's does: of these samples it finds a range of 0.1 m or one of 240 m, by the last digit."""
    for seed in range(30):
        points, values = scattered(3, seed)
        found = fit(points, values, EXTENT)
        for shift in (1e-9, -1e-9):
            again = fit(points + shift * points, values * (1.0 + shift), EXTENT)
            assert again == pytest.approx(found, rel=1e-5), (seed, shift)


def test_fits_find_the_range_the_nugget_and_the_sill_of_many_samples():
    chance = np.random.default_rng(3)
    true = Variogram(240.0, 0.25 * EXTENT, 60.0)
    found = []
    for _ in range(9):
        points = chance.uniform(0.0, (324.0, 220.0), size=(150, 2))
        covariance = true.psill * true.decay(points[:, None, 0] - points[:, 0]) * true.decay(
            points[:, None, 1] - points[:, 1]) + true.nugget * np.eye(len(points))
        values = 800.0 + np.linalg.cholesky(covariance) @ chance.standard_normal(len(points))
        found.append(fit(points, values, EXTENT))
    assert np.median([each.range_m for each in found]) == true.range_m
    assert np.median([each.nugget / each.sill for each in found]) == pytest.approx(0.2)
    assert np.mean([each.sill for each in found]) == pytest.approx(300.0, rel=0.3)
