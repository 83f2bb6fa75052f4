import math

import numpy as np
import pytest

from soil_mapping.interpolation import arithmetic, chebyshev
from soil_mapping.interpolation.kriging_system import KrigingSystem
from soil_mapping.interpolation.variogram import Variogram

X, Y = np.arange(324) + 0.5, np.arange(220) + 0.5


def gaussians(width, seed=0):
    """Return a function of (x, y): two sums of Gaussians at random places, some of them outside of the grid."""
    generator = np.random.default_rng(seed)
    middles, heights = generator.uniform(-100.0, 400.0, (30, 2)), generator.normal(size=(2, 30)) * [[1.0], [1e6]]

    def values(x, y):
        terms = (np.exp(-((x - mx) ** 2)[None, :] / width ** 2 - ((y - my) ** 2)[:, None] / width ** 2)
                 for mx, my in middles)
        return np.tensordot(heights, np.stack(list(terms)), axes=1)
    return values


@pytest.mark.parametrize('width', [1e4, 150.0, 60.0, 30.0])
def test_values_on_the_grid_follow_from_few_places(width):
    places, of_sums = [], gaussians(width)

    def counted(x, y):
        places.append(len(x) * len(y))
        return of_sums(x, y)
    values = chebyshev.on_grid(counted, X, Y, width)
    assert values.shape == (2, 220, 324) and places[0] < len(X) * len(Y) / 3
    for found, expected in zip(values, of_sums(X, Y)):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-11 * np.abs(expected).max())


@pytest.fixture
def change(monkeypatch):
    """Give change(name, value) of a constant of chebyshev, on which known nodes depend."""
    def change(name, value):
        monkeypatch.setattr(chebyshev, name, value)
        chebyshev._known_nodes.cache_clear()
    yield change
    chebyshev._known_nodes.cache_clear()


def test_too_few_nodes_would_be_noticed(change):
    change('NODES_PER_WIDTH', 2.0)
    values = gaussians(60.0)
    assert np.abs(chebyshev.on_grid(values, X, Y, 60.0) - values(X, Y))[0].max() > 1e-6


def test_a_grid_with_few_places_is_computed_itself():
    values = gaussians(30.0)
    np.testing.assert_array_equal(chebyshev.on_grid(values, X[:20], Y[:30], 30.0), values(X[:20], Y[:30]))
    for width in (5.0, 1e-300, 0.0, math.nan):
        narrow = gaussians(5.0)
        np.testing.assert_array_equal(chebyshev.on_grid(narrow, X, Y, width), narrow(X, Y))
    one = gaussians(5.0)
    np.testing.assert_array_equal(chebyshev.on_grid(one, X[:1], Y[:1], 1e9), one(X[:1], Y[:1]))


def test_one_direction_may_have_nodes_and_the_other_one_not():
    values = gaussians(60.0)
    for x, y in ((X, Y[:12]), (X[:12], Y)):
        found, expected = chebyshev.on_grid(values, x, y, 60.0), values(x, y)
        assert found.shape == expected.shape
        np.testing.assert_allclose(found[0], expected[0], rtol=0.0, atol=1e-11 * np.abs(expected[0]).max())


def test_a_place_on_a_node_has_its_value():
    line = np.linspace(-1.0, 1.0, 201)  # an odd number of nodes has one in the middle
    width = next(w for w in np.linspace(0.4, 0.6, 400) if len(chebyshev._nodes(line, w)[0]) % 2)
    nodes, (high, low) = chebyshev._nodes(line, width)
    middle = (high + low)[100]
    assert nodes[len(nodes) // 2] == 0.0 == line[100]
    assert middle[len(nodes) // 2] == 1.0 and np.count_nonzero(middle) == 1


@pytest.mark.parametrize('half_widths', [0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 18.0, 25.0])
def test_the_number_of_nodes_bounds_the_error(half_widths):
    """By theorem 8.2, on each ellipse rho = e^u, in which exp(-t^2 / w^2) is at most exp((sinh u / w)^2)."""
    needed = min((half_widths ** 2 * math.sinh(u) ** 2 + math.log(4.0 / (1e-16 * math.expm1(u)))) / u
                 for u in np.arange(0.01, 4.0, 0.01))
    assert len(chebyshev._nodes(np.linspace(-1.0, 1.0, 1000), 1.0 / half_widths)[0]) >= needed


@pytest.mark.parametrize('half_widths', [0.01, 1.0, 5.0, 25.0])
def test_products_never_round(half_widths):
    _, (high, _) = chebyshev._nodes(np.linspace(-1.0, 1.0, 1000), 1.0 / half_widths)
    assert np.abs(high).sum(axis=1).max() < 5.0


def test_sines_are_exact_enough():
    x = np.linspace(-np.pi / 2, np.pi / 2, 10001)
    np.testing.assert_allclose(arithmetic.sine(x), [math.sin(each) for each in x], rtol=5e-16, atol=0.0)


@pytest.mark.parametrize('count', [3, 20, 60])
@pytest.mark.parametrize('range_m, nugget', [(391.0, 0.001), (98.0, 0.2), (49.0, 0.01)])
def test_kriging_by_nodes_equals_kriging_at_each_cell(count, range_m, nugget, change):
    generator = np.random.default_rng([count, int(range_m)])
    points, values = generator.random((count, 2)) * [324.0, 220.0], 800.0 + 100.0 * generator.normal(size=count)
    points[0] = X[100], Y[50]  # a sample on a cell's middle
    system = KrigingSystem(points, values, Variogram(1000.0 * (1.0 - nugget), range_m, 1000.0 * nugget))
    found = system.mean_and_variance(X, Y)
    change('NODES', 10 ** 6)  # none
    expected = system.mean_and_variance(X, Y)
    assert found[0][50, 100] == values[0] and found[1][50, 100] == 0.0
    for ours, theirs in zip(found, expected):
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-6)
    assert found[1].min() >= 0.0
